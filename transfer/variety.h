// Freedom of choice on flat surfaces: a wall has one normal, so each of its seeds would offer the same piece of paint.
#pragma once

#include "transfer/match.h"

namespace scumble::internal {

// Whether the surface around an active pixel is flat: four active pixels `reach` away show the same object and normals
// that are equal to within half a degree. A neighbour outside the picture does not count against it; one that is not
// active does.
bool IsFlat(const MatchInput& input, PixelPosition at, int reach);

// A source whose normal is within input.variety_degrees of that of `own`, chosen evenly among the exemplar's pixels by the
// hash; `own` where variety is 0 or chance finds none.
Source ChooseAlike(const MatchInput& input, Source own, std::uint64_t hash);

}  // namespace scumble::internal
