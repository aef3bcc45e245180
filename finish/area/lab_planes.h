// A picture as planes of Oklab.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "finish/area/float_plane.h"
#include "scumble/picture.h"

namespace scumble::internal {

struct LabPlanes {
  FloatPlane lightness, a, b;
};

LabPlanes PlanesOf(const Picture& picture);

// Puts the colours into the picture, as far as `strength` says. Pixels of alpha 0, those outside `only`, and those
// whose colour is that of `before` keep their bits.
void PutPlanes(const LabPlanes& planes, const LabPlanes& before, double strength, std::span<const std::uint8_t> only,
               Picture& picture);

}  // namespace scumble::internal
