// A progress bar with the time left, on terminals, for what takes more than two seconds.
#pragma once

#include <chrono>
#include <string>

#include "core/image/progress.h"

namespace scumble {

// "  1:05 left", or nothing in the first second and before 2%, when it would be a guess. `share` in [0, 1].
std::string TimeLeft(double elapsed_seconds, double share);

class ProgressBar {
 public:
  // Draws nothing when stderr is no terminal or `quiet`.
  ProgressBar(std::string label, bool quiet);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // A callback that reports [from, to] of the bar; valid while the bar lives.
  Progress Part(double from, double to);

  // Takes the bar off the terminal, so that a line can be printed; it comes back with the next report.
  void Clear();

 private:
  void Update(double share);

  std::string label_;
  bool enabled_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_, last_draw_;
};

}  // namespace scumble
