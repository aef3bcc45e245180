// Progress and cancellation for work that is split into tiles.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>

#include "core/image/progress.h"

namespace scumble {

// Counts tiles and passes the share on, one caller at a time. A thread that finds another one in the callback continues
// its work.
class ProgressGate {
 public:
  // This work is the part from `begin` to `end` of the whole, which is 1. `progress` is borrowed.
  ProgressGate(const Progress& progress, std::size_t total, double begin, double end)
      : progress_(progress), total_(total), begin_(begin), end_(end) {}

  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

  void TileDone() {
    const std::size_t done = done_.fetch_add(1, std::memory_order_relaxed) + 1;
    if (!progress_) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || done <= reported_ || cancelled()) return;
    reported_ = done;
    // The end is reported once, by the function that started the work.
    if (done < total_) Report();
  }

  // For long tiles: whether to go on. Calls the caller back at most every kPollInterval.
  bool Continue() {
    if (!progress_) return true;
    if (cancelled()) return false;
    if (Now() < next_poll_.load(std::memory_order_relaxed)) return true;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (lock && !cancelled()) Report();
    return !cancelled();
  }

 private:
  using Ticks = std::chrono::steady_clock::rep;
  static constexpr std::chrono::milliseconds kPollInterval{10};
  static Ticks Now() { return std::chrono::steady_clock::now().time_since_epoch().count(); }

  void Report() {
    if (!progress_(begin_ + (end_ - begin_) * double(reported_) / double(total_))) cancelled_ = true;
    next_poll_ = Now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(kPollInterval).count();
  }

  const Progress& progress_;
  const std::size_t total_;
  const double begin_;
  const double end_;
  std::atomic<std::size_t> done_{0};
  std::atomic<bool> cancelled_{false};
  std::atomic<Ticks> next_poll_{0};
  std::mutex mutex_;
  std::size_t reported_ = 0;
};

}  // namespace scumble
