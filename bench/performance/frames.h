// The frames that the transfer's bench paints: guides in memory, and the styles that paint them.
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
  // The same, left and right exchanged. Runs alternate between the two, so nothing that was derived from one frame's
  // guides could serve the next. Empty where there is none: one frame may be all that memory allows.
  GuideSet mirrored;
  std::size_t covered = 0;  // pixels; the same in both

  double CoveredPercent() const { return 100.0 * double(covered) / double(guides.pixel_count()); }
};

// The frame with its mirror image.
Frame WithMirrorImage(Frame frame);

// A bundled scene through its own camera, cast by guidegen. `layers` come on top of those that are always written;
// lamps count as having no extent. `samples` are those of light-path layers.
Frame SceneFrame(const std::string& scene, int width, int height, const LayerSet& layers = {}, int samples = 1);

// Suzanne's head from so near that every pixel shows it: guides of a real close-up, normals and depth as they are.
Frame CloseUp(int width, int height, const LayerSet& layers = {});

// The Suzanne scene from so far that it covers an eighth of the picture.
Frame EighthFrame(int width, int height);

// Bumpy hills that cover everything, by a formula. Bumps are of the same size in pixels in pictures of any size, so
// that a pixel asks for the same work: about that of the authors' golem at 1024², whose pixels settle to 20, 27, 25,
// 16, 7, 3 and 1% on the levels from the coarsest down. Layers as guidegen always writes them, or only coverage and
// normal. Without a mirror image.
Frame HillsFrame(int width, int height, bool all_layers);

// Oil, a bundled style: an opaque sphere of 1024² texels, with the settings that the paper has: threshold 0.125, 7
// levels, jitter 1, radius 1, no edge test. Lengths are pixels whatever the height.
Style PlainStyle();

// Ten bundled paintings, each a style as above.
std::vector<Style> TenStyles();

}  // namespace scumble::bench
