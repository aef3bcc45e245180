// What a seed of StyleBlit offers to the pixels around it, and who takes it: the part that is the same wherever seeds
// live, on the screen or on the surface.
#pragma once

#include <cstdint>
#include <optional>

#include "transfer/match/match.h"

namespace scumble::internal {

struct SeedCandidate {
  Candidate offer;
  // What `variety` moved the source's guide by: a pixel is compared as if its own guide were moved by the same.
  glm::vec3 moved{0.0f};
  bool off = false;  // MatchInput::IsOff, by `best`
  Source best{};     // the nearest neighbour, whatever `variety` took instead
};

// The seed of a pixel whose guide was read, before `variety`.
SeedCandidate SeedOf(const MatchInput& input, const PixelGuide& guide, const Candidate& offer);

// `variety` may choose another source by the hash, where the surface around q is flat; whether it is.
bool VarySource(const MatchInput& input, int level, PixelPosition q, std::uint64_t hash, SeedCandidate& made);

// What p may take of the seed at q, if anything: u + (p - q), where that is usable and its guide like p's, light
// included.
std::optional<Candidate> TryCandidate(const MatchInput& input, const SeedCandidate& seed, PixelPosition q,
                                      PixelPosition p, const PixelGuide& guide);

}  // namespace scumble::internal
