// Paint times albedo, many pixels at once: what Tint::Apply does for ColorizeMode::kMultiply, bit for bit.
//
// Paint that is encoded as v, times f in linear light, is encoded as (v + o) · f^(5/12) - o, o = 0.055 · 65535, wherever
// paint and result lie in the curved part of sRGB: no decoding, one power for each channel. That power is approximated;
// the few results that are near the border of two codes are made anew by the tables, so that instruction sets do not
// matter.
#pragma once

#include <cstddef>
#include <cstdint>

namespace scumble::internal {

// Changes `count` texels of RGBA in place; albedo[c] holds as many floats each. `weight` is the tint's.
void MultiplyTint(const float* const albedo[3], std::size_t count, float weight, std::uint16_t* texels);

}  // namespace scumble::internal
