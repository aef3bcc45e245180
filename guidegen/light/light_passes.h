// How many samples the light paths of a picture get, and how they are averaged into its layers.
#pragma once

#include <vector>

#include "guidegen/light/path_tracer.h"

namespace scumble {

// What the light paths took.
struct LightPassResult {
  RayCounts rays;
  WorkCounts work;
  int samples = 0;     // of each pixel; 0 where the light needs no chance
  double noise = 0.0;  // estimated, as GuidegenOptions::noise; 0 where it was not asked for
  bool cancelled = false;
};

// Fills the follower's layers of `guides`; the others keep their zeros. `pixels` are the covered ones, in lists that
// are worked on one at a time. The picture does not depend on how the lists are cut, nor on the threads.
LightPassResult TraceLightPaths(const LightPathTracer& tracer, const PathFollower& follower,
                                const std::vector<std::vector<PathPixel>>& pixels, const GuidegenOptions& options,
                                double progress_begin, GuideSet& guides);

}  // namespace scumble
