// Votes in small windows, most of which are of one chunk or whole.
#pragma once

#include "transfer/vote.h"

namespace scumble::internal {

constexpr int kSmallRadius = 3;

// Vote of vote.h, to the bit, for radii 0 … kSmallRadius.
bool VoteSmall(const VoteInput& input, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
