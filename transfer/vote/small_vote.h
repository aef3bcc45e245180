// Votes in windows of 3 × 3 pixels, most of which are of one chunk or whole.
#pragma once

#include "transfer/vote/vote.h"
#include "transfer/vote/vote_kernels.h"

namespace scumble::internal {

// For larger windows, votes chunk by chunk take less time (wide_vote.h).
inline constexpr int kSmallRadius = 1;

// Data shared by all threads that vote with one exemplar, which must outlive it.
class SmallVotes {
 public:
  explicit SmallVotes(const PreparedExemplar& exemplar) : texels_(exemplar) {}
  // Votes on the input's region in this thread. The input's exemplar is this one, its radius 0 or 1; its field and
  // `active` need only hold the rows of the region and those up to the radius above and below.
  void Vote(const VoteInput& input, Picture& out) const;

 private:
  TexelPlanes texels_;
};

// The picture of VotePlainly (vote.h), to the bit, for the radii 0 and 1.
bool VoteSmall(const VoteInput& input, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
