// Two thresholds for borders, as Canny's edges have them (1986, section VIII): borders beyond the lower one are lines
// where they join some beyond the full one.
#pragma once

#include <cstdint>
#include <span>

#include "core/filter/edge_test.h"
#include "core/image/finish_pass.h"
#include "core/image/guides.h"
#include "finish/outline/border_map.h"

namespace scumble::internal {

constexpr std::uint8_t CodeOf(LineClass line) { return static_cast<std::uint8_t>(1 + int(line)); }

// In a map that is not finished: an angle that is enough for a crease to go on, not for one to begin.
constexpr std::uint8_t kWeakCrease = 0x3f;
// The same, where one may go on from a step in depth.
constexpr std::uint8_t kFullCrease = 0x3e;
// Added to what else the border is: a step in depth that is enough for one to go on.
constexpr std::uint8_t kWeakStep = 0x40;

// Makes creases of the weak ones that lie end to end with one of the same object, of full ones also beside a step in
// depth there, and drops the others.
void JoinCreases(std::span<const float> object, BorderMap& map);

// To be called last. Makes steps of the weak ones on which a line goes on that has at least `shortest` steps; the
// others are what they were. Along a fold that fades a pixel may lie so near the rim that neither of its borders is a
// step. The line goes on over up to two borders to the next one, if depth changes there by more than `least`. `only`:
// as FindBorders has it.
void JoinSteps(const GuideSet& guides, std::span<const std::uint8_t> only, double shortest, const DepthTolerance& least,
               BorderMap& map);

}  // namespace scumble::internal
