#include "apps/cli/app/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace scumble {

ProgressBar::ProgressBar(std::string label, bool quiet)
    : label_(std::move(label)),
      enabled_(!quiet && ::isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      last_draw_(start_) {}

ProgressBar::~ProgressBar() { Clear(); }

void ProgressBar::Clear() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

Progress ProgressBar::Part(double from, double to) {
  if (!enabled_) return {};
  return [this, from, to](double share) {
    Update(from + (to - from) * share);
    return true;
  };
}

std::string TimeLeft(double elapsed_seconds, double share) {
  constexpr double kEnoughSeconds = 1.0, kEnoughShare = 0.02;
  if (elapsed_seconds < kEnoughSeconds || share < kEnoughShare) return "";
  const int left = static_cast<int>(std::ceil(elapsed_seconds / share - elapsed_seconds));
  char text[32];
  std::snprintf(text, sizeof text, "  %d:%02d left", left / 60, left % 60);
  return text;
}

void ProgressBar::Update(double share) {
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

}  // namespace scumble
