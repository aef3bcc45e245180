// Voting in large windows (Sýkora et al. 2019, section 3.3): not pixel by pixel, but chunk by chunk.
#pragma once

#include "scumble/picture.h"
#include "core/filter/parallel.h"
#include "transfer/vote/vote.h"

namespace scumble::internal {

// From this radius on it is quicker than visiting every pixel of the window; up to kWidestRadius the sums fit.
inline constexpr int kWideRadius = 4, kWidestRadius = 127;

// The same picture as Vote's to the bit, for radii of kWideRadius … kWidestRadius.
bool WideVote(const VoteInput& input, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
