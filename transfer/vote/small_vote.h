// Votes in small windows, most of which are of one chunk or whole.
#pragma once

#include "transfer/vote/edge/edge_masks.h"
#include "transfer/vote/edge/window_paths.h"
#include "transfer/vote/vote.h"
#include "transfer/vote/vote_kernels.h"

namespace scumble::internal {

constexpr int kSmallRadius = 3;

// What all threads share that vote with one exemplar and radius, which must outlive it.
class SmallVotes {
 public:
  SmallVotes(const PreparedExemplar& exemplar, int radius) : texels_(exemplar), ways_(radius) {}
  // Votes on the input's region in this thread. The input's exemplar and radius are these; its field and `active` need only
  // hold the rows of the region and those up to the radius above and below.
  void Vote(const VoteInput& input, Picture& out) const;

 private:
  TexelPlanes texels_;
  JoinedWays ways_;
};

// Vote of vote.h, to the bit, for radii 0 … kSmallRadius.
bool VoteSmall(const VoteInput& input, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
