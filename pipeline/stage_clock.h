// The stages of a run, from the start of the process to its report: wall and processor time of each.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scumble {

struct Stage {
  std::string name;
  double wall_ms = 0;            // summed over frames
  std::optional<double> cpu_ms;  // of all threads of the process; empty where only the wall clock was read
};

// Collects the time of each stage. Not thread-safe: the thread that runs the request calls it.
class StageClock {
 public:
  // The first stage, "start", covers the time up to here: loading the program and its libraries. Its wall time is known
  // to a tick of the kernel, 10 ms; 0 where the system does not count it.
  StageClock();

  // Ends what has run since the last call. The stages of `inside` took that many milliseconds of wall time; the rest is
  // added to `name`, with the processor time of all of it.
  void End(const std::string& name, const std::vector<std::pair<std::string, double>>& inside = {});
  // Adds a stage that ran beside the others, on another thread.
  void Add(const std::string& name, double wall_ms);

  // The stages in order of first use, then "total": from the start of the process until now.
  std::vector<Stage> Stages() const;

 private:
  Stage& At(const std::string& name);

  std::vector<Stage> stages_;
  double begun_wall_ms_ = 0;  // the process, on the wall clock
  double last_wall_ms_ = 0, last_cpu_ms_ = 0;
};

}  // namespace scumble
