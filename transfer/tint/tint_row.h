// Tints many pixels at once: Tint::Apply, bit for bit, as both use transfer/tint/tint-inl.h.
#pragma once

#include <cstddef>
#include <cstdint>

#include "transfer/tint/colorize.h"

namespace scumble::internal {

// Changes `count` texels of RGBA in place; albedo[c] holds as many floats each.
void TintRow(const Tint& tint, const float* const albedo[3], std::size_t count, std::uint16_t* texels);

}  // namespace scumble::internal
