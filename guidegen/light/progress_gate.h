// Progress and cancellation for work that is split into tiles.
#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>

#include "core/image/progress.h"

namespace scumble {

// Counts tiles and passes the share on, one caller at a time; a thread that finds the line busy works on instead.
class ProgressGate {
 public:
  // This work is the stretch from `begin` to `end` of the whole, which is 1.
  ProgressGate(const Progress& progress, std::size_t total, double begin, double end)
      : progress_(progress), total_(total), begin_(begin), end_(end) {}

  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

  void TileDone() {
    const std::size_t done = done_.fetch_add(1, std::memory_order_relaxed) + 1;
    if (!progress_) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || done <= reported_ || cancelled()) return;
    reported_ = done;
    // The end is told once, by whoever started the work.
    const double share = begin_ + (end_ - begin_) * double(done) / double(total_);
    if (done < total_ && !progress_(share)) cancelled_ = true;
  }

 private:
  const Progress& progress_;
  const std::size_t total_;
  const double begin_;
  const double end_;
  std::atomic<std::size_t> done_{0};
  std::atomic<bool> cancelled_{false};
  std::mutex mutex_;
  std::size_t reported_ = 0;
};

}  // namespace scumble
