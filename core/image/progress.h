// Progress of a step within a whole.
#pragma once

#include "scumble/progress.h"

namespace scumble {

// The part [from, to] of a progress, for one step of several.
inline Progress Within(const Progress& progress, double from, double to) {
  if (!progress) return {};
  return [progress, from, to](double share) { return progress(from + (to - from) * share); };
}

}  // namespace scumble
