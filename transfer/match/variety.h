// Source variation on flat surfaces: a wall has one normal, so all of its seeds would take the same source.
#pragma once

#include "transfer/exemplar/paint_by_normal.h"
#include "transfer/match/match.h"

namespace scumble::internal {

// Whether the surface around an active pixel is flat: four active pixels `reach` away show the same object, with
// normals equal to within half a degree. A neighbour outside the picture is ignored; an inactive one makes the result
// false.
bool IsFlat(const MatchInput& input, PixelPosition at, int reach);

// Whether a seed may take another source than its own: variety is not 0, the level is coarse enough to matter, and the
// surface is flat over the reach of the seed's chunk.
bool CanVary(const MatchInput& input, int level, PixelPosition seed);

// Another source for such a seed, within input.variety_degrees of its own one and of like tone (see SourceVariation).
Source ChooseAlike(const MatchInput& input, const Candidate& own, int level, std::uint64_t hash);

// The tone of the seed's best-fitting paint, which all paint around it should have.
SourceVariation::Tone WantedTone(const MatchInput& input, const Candidate& own, int level);

// Chunk borders that follow the paint. Between two seeds of a flat surface a straight border would cut strokes at an
// arbitrary place. Near it each pixel weighs distance against tone: it takes the seed whose paint, there, is nearer to
// the wanted tone. So the border runs where both agree, and strokes that differ from either are cut off. Each pixel
// decides by itself, so the order of work does not matter. `excess`: of the second nearest seed's squared distance.
bool InBorderBand(int level, std::int64_t excess);
int ToneError(const MatchInput& input, const Candidate& candidate, const SourceVariation::Tone& wanted);
bool SecondWins(int level, std::int64_t excess, int gain_of_tone);

}  // namespace scumble::internal
