// Counters that the innermost loops of the ray caster add to. Each thread has its own, so that there are no locks and
// no arguments in the loops. The function that splits the work adds up the differences. Sums of integers do not depend
// on the split.
#pragma once

#include <cstddef>

#include "guidegen/guidegen.h"

namespace scumble {

// This thread's counters, since its start.
inline constinit thread_local WorkCounts thread_counters;

inline constexpr std::size_t WorkCounts::*kWorkCounts[] = {&WorkCounts::light_samples,   &WorkCounts::materials,
                                                           &WorkCounts::texture_lookups, &WorkCounts::texels,
                                                           &WorkCounts::filtered_hits,   &WorkCounts::plane_bytes};

inline void AddWork(const WorkCounts& from, WorkCounts& to) {
  for (const auto count : kWorkCounts) to.*count += from.*count;
}

// The counts of this thread since the meter was made. Work that other threads do for it is counted there.
class WorkMeter {
 public:
  WorkCounts Since() const {
    WorkCounts done;
    for (const auto count : kWorkCounts) done.*count = thread_counters.*count - begin_.*count;
    return done;
  }

 private:
  const WorkCounts begin_ = thread_counters;
};

}  // namespace scumble
