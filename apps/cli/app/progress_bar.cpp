#include "apps/cli/app/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>
#include <utility>

namespace scumble {

namespace {

class Bar {
 public:
  explicit Bar(std::string label) : label_(std::move(label)), start_(std::chrono::steady_clock::now()) {}
  ~Bar();

  void Update(double share);
  // The caller holds `mutex`.
  void Clear() {
    if (drawn_) std::fputs("\r\033[K", stderr);
  }

 private:
  std::string label_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_, last_draw_ = start_;
};

std::mutex mutex;        // of the following members, and of the terminal's line
Bar* current = nullptr;  // the bar that was begun last

Bar::~Bar() {
  const std::lock_guard lock(mutex);
  Clear();
  if (current == this) current = nullptr;
}

void Bar::Update(double share) {
  const std::lock_guard lock(mutex);
  constexpr double kWorthShowingSeconds = 2.0;
  constexpr int kWidth = 30;
  const auto now = std::chrono::steady_clock::now();
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double total = share > 0.0 ? elapsed / share : 0.0;
  const bool worth_showing = elapsed > 0.3 && total > kWorthShowingSeconds;
  if (!drawn_ && !worth_showing) return;
  if (drawn_ && std::chrono::duration<double>(now - last_draw_).count() < 0.1) return;
  last_draw_ = now, drawn_ = true;
  const int filled = std::clamp(static_cast<int>(std::lround(share * kWidth)), 0, kWidth);
  std::fprintf(stderr, "\r\033[K%s [%s%s] %3.0f%%%s", label_.c_str(), std::string(filled, '#').c_str(),
               std::string(kWidth - filled, '.').c_str(), share * 100.0, TimeLeft(elapsed, share).c_str());
  std::fflush(stderr);
}

}  // namespace

std::string TimeLeft(double elapsed_seconds, double share) {
  constexpr double kEnoughSeconds = 1.0, kEnoughShare = 0.02;
  if (elapsed_seconds < kEnoughSeconds || share < kEnoughShare) return "";
  const int left = static_cast<int>(std::ceil(elapsed_seconds / share - elapsed_seconds));
  char text[32];
  std::snprintf(text, sizeof text, "  %d:%02d left", left / 60, left % 60);
  return text;
}

Progress ShowProgress(const std::string& label, bool quiet) {
  if (quiet || ::isatty(STDERR_FILENO) != 1) return {};
  const auto bar = std::make_shared<Bar>(label);
  {
    const std::lock_guard lock(mutex);
    current = bar.get();
  }
  return [bar](double share) {
    bar->Update(share);
    return true;
  };
}

void ClearProgress() {
  const std::lock_guard lock(mutex);
  if (current) current->Clear();
}

}  // namespace scumble
