// The effect `smooth`.
#pragma once

#include <cstdint>
#include <span>

#include "finish/finish.h"

namespace scumble::internal {

// Applies the pass's filter of Oklab colours (finish/smooth/smooth_filters.h) several times. Before filters that weigh
// by difference it removes pixels that differ from all of their neighbours. `strength` and `only` as FinishPass and
// FinishStep have them. The frame's guides must hold the pass's layers.
void Smooth(const SmoothPass& pass, double strength, std::span<const std::uint8_t> only, const FinishFrame& frame,
            Picture& picture);

}  // namespace scumble::internal
