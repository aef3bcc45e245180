// Ink lines over a picture.
#pragma once

#include <cstdint>
#include <span>

#include "finish/finish.h"

namespace scumble::internal {

// Draws the pass's lines over the picture. `only` and `strength` as FinishStep and FinishPass have them, `shares` by
// the pixel that a line belongs to. The frame's guides must hold the pass's layers.
void DrawOutline(const OutlinePass& pass, double strength, std::span<const std::uint8_t> only,
                 std::span<const std::uint16_t> shares, const FinishFrame& frame, Picture& picture);

}  // namespace scumble::internal
