// Paint with the scene's hue and chroma, many pixels at once: what Tint::Apply does for ColorizeMode::kOklab, bit for bit.
//
// The same sums and products in the same order, sixteen pixels at a time where the machine can. Only roots are taken in
// another way: cube roots, and the power that encodes the result, are approximated so well that it is known where the
// exact ones round to. The few pixels of which it is not are made by the plain formula.
#pragma once

#include <cstddef>
#include <cstdint>

#include "transfer/tint/colorize.h"

namespace scumble::internal {

// Changes `count` texels of RGBA in place; albedo[c] holds as many floats each. `tint` is one of kOklab.
void OklabTint(const float* const albedo[3], std::size_t count, const Tint& tint, std::uint16_t* texels);

}  // namespace scumble::internal
