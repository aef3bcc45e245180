// How far a picture is off along the outlines of things, where texture is not measured (guided_texture.h).
#pragma once

#include <cstddef>

#include "core/image/guides.h"
#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

struct OutlineReport {
  double error = 0.0;      // 0: as smooth and as sharp as the guides are; 1: everywhere the other side's colour
  std::size_t pixels = 0;  // that were measured
};

// A pixel at an outline should have the colours of its surfaces, each by the share of the pixel that it fills: the
// whole of one, or a mixture where the guides have fragments or a coverage below 1. Its error is by how much of the way
// from one colour to the other it is off. `error` is the root of the mean of its square, weighed by the squared
// contrast, less what the colours on both sides vary by. So it sees steps, blur, halos and colours that leak.
//
// A surface is an object with a material, or the background; pictures are seen on white. The inside of a surface are
// its pixels that have no other within three. A pixel at an outline is not inside, and has four pixels of the inside of
// either surface within five: their means are the two colours. So an outline is about three pixels wide. Pixels of more
// than two surfaces are left out. Guides without ids are one surface.
// Errors (kInput): sizes that differ. O(pixels). `threads` 0: all; no figure depends on them.
Expected<OutlineReport> MeasureOutlines(const Picture& picture, const GuideSet& guides, int threads = 0);

}  // namespace scumble
