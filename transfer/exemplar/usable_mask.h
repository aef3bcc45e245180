// The usable pixels of an exemplar whose guides, and not a circle, mark the painted part.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image/guides.h"
#include "scumble/picture.h"

namespace scumble::internal {

// 1 on covered pixels whose centre is at least `rim` pixels from the centre of every uncovered one. The picture's own
// edge is no painted edge: where the scene continues beyond it, pixels are usable up to it. O(pixels).
std::vector<std::uint8_t> UsableMask(const GuideSet& guides, double rim);

// Replaces the paint of every pixel outside the mask by that of the nearest one inside. So a filter across the rim
// reads paint, and not the surroundings of the object. The mask holds at least one pixel.
Picture ExtendPaint(const Picture& picture, std::span<const std::uint8_t> mask);

}  // namespace scumble::internal
