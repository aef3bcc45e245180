// The candidate of a StyleBlit seed for the pixels around it, and its acceptance. Shared by seeds on the screen and on
// the surface.
#pragma once

#include <cstdint>
#include <optional>

#include "transfer/match/match.h"

namespace scumble::internal {

struct SeedCandidate {
  Candidate candidate;
  // The guide offset of `variety`: a pixel's own guide is shifted equally before it is compared.
  glm::vec3 guide_offset{0.0f};
  bool off = false;  // MatchInput::IsOff, by `best`
  Source best{};     // the nearest neighbour, whatever source `variety` took
};

// The seed at a pixel whose guide has been read, before `variety`.
SeedCandidate SeedOf(const MatchInput& input, const PixelGuide& guide, const Candidate& candidate);

// If the surface around q is flat, `variety` may choose another source by the hash. Returns whether it is flat.
bool VarySource(const MatchInput& input, int level, PixelPosition q, std::uint64_t hash, SeedCandidate& made);

// The candidate of the seed at q for p: u + (p - q), if that is usable and its guide is like p's, light included;
// otherwise empty.
std::optional<Candidate> TryCandidate(const MatchInput& input, const SeedCandidate& seed, PixelPosition q,
                                      PixelPosition p, const PixelGuide& guide);

}  // namespace scumble::internal
