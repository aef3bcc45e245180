// The frames of the transfer's bench: guides in memory, and their styles.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/style.h"

namespace scumble::bench {

struct Frame {
  std::string name;  // "suzanne 1920×1080"
  GuideSet guides;
  // The frame mirrored left to right. Runs alternate between the two, so that no data derived from one frame's guides
  // serves the next. Empty where there is none: memory may only allow one frame.
  GuideSet mirrored;
  std::size_t covered = 0;  // pixels; the same in both

  double CoveredPercent() const { return 100.0 * double(covered) / double(guides.pixel_count()); }
};

// The frame with its mirror image.
Frame WithMirrorImage(Frame frame);

// A bundled scene through its own camera, cast by guidegen. `layers` are added to those that are always written; lights
// have no extent. `samples` are those of light-path layers.
Frame SceneFrame(const std::string& scene, int width, int height, const LayerSet& layers = {}, int samples = 1);

// A close-up of Suzanne's head that covers every pixel: real guides, with their normals and depth.
Frame CloseUp(int width, int height, const LayerSet& layers = {});

// A distant view of the Suzanne scene that covers an eighth of the picture.
Frame EighthFrame(int width, int height);

// Bumpy hills that cover everything, by a formula. Bumps have one size in pixels in pictures of any size, so that each
// pixel takes equal work: about that of the authors' golem at 1024², whose pixels settle to 20, 27, 25, 16, 7, 3 and 1%
// on the levels from the coarsest down. Layers as guidegen always writes them, or only coverage and normal. Without a
// mirror image.
Frame HillsFrame(int width, int height, bool all_layers);

// Oil, a bundled style: an opaque sphere of 1024² texels, with the paper's settings: threshold 0.125, 7 levels, jitter
// 1, radius 1, no edge test. Lengths are pixels at any height.
Style PlainStyle();

// Ten bundled exemplars, each as a style like the one above.
std::vector<Style> TenStyles();

}  // namespace scumble::bench
