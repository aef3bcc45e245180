// Counters that the innermost loops of the ray caster add to. Each thread has its own, so that nothing is locked and
// nothing is handed down to them; whoever splits the work takes the differences and adds them up. Sums of whole numbers
// do not depend on how the work was split.
#pragma once

#include <cstddef>

#include "guidegen/guidegen.h"

namespace scumble {

// Of this thread, since it began.
inline constinit thread_local WorkCounts thread_counters;

inline constexpr std::size_t WorkCounts::* kWorkCounts[] = {
    &WorkCounts::light_samples, &WorkCounts::materials,     &WorkCounts::texture_lookups,
    &WorkCounts::texels,        &WorkCounts::filtered_hits, &WorkCounts::plane_bytes};

inline void AddWork(const WorkCounts& from, WorkCounts& to) {
  for (const auto count : kWorkCounts) to.*count += from.*count;
}

// What this thread does while it stands. Work that is handed to other threads meanwhile is theirs to count.
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
