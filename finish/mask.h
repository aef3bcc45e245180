// Masks as shares by pixel.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/image/guides.h"

namespace scumble {

// How much of an effect each pixel gets, 0 … 65535 for 0 … 1; nothing for a mask that is empty.
//
// Depth: clamp((depth - near) / soft + 1/2, 0, 1) · clamp((far - depth) / soft + 1/2, 0, 1), an open end 1; without
// `soft` a step. Background is infinitely far. A depth that is no number has share 0.
// Radial: u²(3 - 2u) with u = min(1, (2x/width - 1)² + (2y/height - 1)²) at the pixel's centre.
// A picture: its red channel, brought to width × height by Lanczos-3.
//
// `guides`: of that size, with depth where the mask looks at it. On the caller's arena of threads; the
// result does not depend on them.
std::vector<std::uint16_t> MaskShares(const FinishMask& mask, const GuideSet* guides, int width, int height);

}  // namespace scumble
