// Guides of a small picture made into those of a larger one, so that the paint has its full size where the guides have
// not.
#pragma once

#include "core/image/guides.h"

namespace scumble {

inline constexpr int kMaxUpsampling = 8;

// Every pixel becomes a block of factor × factor, 1 … kMaxUpsampling; 1 is a copy. In a block of a covered pixel
//   - ids are the pixel's own;
//   - all else is bilinear between the centres of the pixels around that are covered and show the same surface as this
//     one: its object, no crease of 60 degrees or more between, no step in depth (by the edge test's tolerance of 0.002
//     of the distance). What the guides do not hold is not asked. Normals are unit vectors again; `motion` is in the
//     larger picture's pixels;
//   - coverage is the share of the block that it was of the pixel: its mean over the block is the pixel's own. Which
//   part
//     of the block is covered follows the bilinear coverage, along its contours and as sharply as `factor` allows. A
//     silhouette that is antialiased comes out smooth and no wider than one pixel or so; one that is not keeps its
//     steps.
// Blocks of background are background. Names, camera and attributes are kept.
// A kUsage error where a side would have more than kMaxImageSide pixels, or all more than 2^28. `threads` 0: all; the
// bytes do not depend on it.
Expected<GuideSet> UpsampleGuides(const GuideSet& guides, int factor, int threads = 0);

}  // namespace scumble
