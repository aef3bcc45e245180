// Decides the number of samples of a picture's light paths, and averages them into its layers.
#pragma once

#include <vector>

#include "guidegen/light/path_tracer.h"

namespace scumble {

// The cost of the light paths.
struct LightPassResult {
  RayCounts rays;
  WorkCounts work;
  int samples = 0;     // of each pixel; 0 where the light needs no random numbers
  double noise = 0.0;  // estimated, as GuidegenOptions::noise; 0 where it was not requested
  bool cancelled = false;
};

// Fills the follower's layers of `guides`; the other layers keep their zeros. `pixels` are the covered ones, in lists
// that are processed one at a time. The picture depends neither on how the lists are cut nor on the threads.
LightPassResult TraceLightPaths(const LightPathTracer& tracer, const PathFollower& follower,
                                const std::vector<std::vector<PathPixel>>& pixels, const GuidegenOptions& options,
                                double progress_begin, GuideSet& guides);

}  // namespace scumble
