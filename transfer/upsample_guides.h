// Larger pictures from small guides, in two ways. Guides are upsampled, so that the paint has full resolution where
// they have not. Or the picture that was painted at their size is scaled up, which is quicker and softer.
#pragma once

#include "core/image/guides.h"
#include "scumble/picture.h"

namespace scumble {

inline constexpr int kMaxUpsampling = 8;

// Every pixel becomes a block of factor × factor, 1 … kMaxUpsampling; 1 is a copy. In a block of a covered pixel
//   - ids are the pixel's own;
//   - all other layers are bilinear between the centres of the pixels around that are covered and show the same surface
//     as this one: its object, no crease of 60 degrees or more between, no step in depth (by the edge test's tolerance
//     of 0.002 of the distance). Layers that the guides lack are not tested. Normals are unit vectors again; `motion`
//     is in the larger picture's pixels;
//   - coverage is the share of the block that it was of the pixel: its mean over the block is the pixel's own. The
//     covered part of the block follows the bilinear coverage, along its contours and as sharply as `factor` allows. An
//     antialiased silhouette becomes smooth and about one pixel wide at most; one that is not antialiased keeps its
//     steps.
// Blocks of background are background. Names, camera and attributes are kept.
//
// Fragments (core/image/fragments.h) stay smooth borders. In the block of a pixel that has some, each covers the part
// that follows the bilinear coverage of its surface, as the silhouette does. So its mean over the block is its
// coverage. Where several surfaces would cover more than a sample, all take less. Their values are the same on the
// whole block, but for `motion`, as above. A kUsage error where a side would have more than kMaxImageSide pixels, or
// all more than 2^28. `threads` 0: all; the bytes do not depend on it.
Expected<GuideSet> UpsampleGuides(const GuideSet& guides, int factor, int threads = 0);

// A kUsage error where a picture `factor` times as wide and high would be too large, as above.
Status CheckLargerSize(int width, int height, int factor);

// Every side `factor` times as long, by Lanczos-3 (core/filter/resample.h). `threads` 0: all. The size is checked by
// the caller.
Picture UpscalePicture(const Picture& picture, int factor, int threads = 0);

}  // namespace scumble
