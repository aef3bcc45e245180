// Rows over threads, with progress and cancellation.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <mutex>

#include "core/filter/region.h"
#include "core/image/progress.h"

namespace scumble::internal {

// Reports a part [from, to] of the whole as rows finish, and stops when the caller cancels.
class RowProgress {
 public:
  RowProgress(const Progress& progress, double from, double to, int rows)
      : progress_(progress), from_(from), to_(to), rows_(rows) {}

  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }
  void Finished(int rows) {
    if (!progress_) return;
    const std::lock_guard lock(mutex_);
    done_ += rows;
    if (!progress_(from_ + (to_ - from_) * done_ / rows_)) cancelled_ = true;
  }

 private:
  const Progress& progress_;
  double from_, to_;
  int rows_;
  std::atomic<bool> cancelled_ = false;
  std::mutex mutex_;
  int done_ = 0;
};

// Calls row(y) for every row of the region, from several threads. Rows are independent, so the result does not depend
// on how they are distributed. False if it was cancelled.
template <class RowFunction>
bool ForEachRow(const Region& region, RowProgress& progress, RowFunction row) {
  constexpr int kRowsPerTask = 8;
  tbb::parallel_for(tbb::blocked_range<int>(region.y0, region.y1, kRowsPerTask), [&](const auto& range) {
    if (progress.cancelled()) return;
    for (int y = range.begin(); y != range.end(); ++y) row(y);
    progress.Finished(static_cast<int>(range.size()));
  });
  return !progress.cancelled();
}

}  // namespace scumble::internal
