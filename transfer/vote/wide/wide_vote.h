// Voting in large windows (Sýkora et al. 2019, section 3.3): not pixel by pixel, but chunk by chunk.
#pragma once

#include "core/filter/parallel.h"
#include "scumble/picture.h"
#include "transfer/exemplar/usable_rows.h"
#include "transfer/vote/vote.h"
#include "transfer/vote/wide/chunk_runs.h"
#include "transfer/vote/wide/run_sums.h"
#include "transfer/vote/wide/wide_arms.h"

namespace scumble::internal {

// One thread's working memory; kept from call to call.
struct WideScratch {
  WideTile tile;
  WideArms arms;
  WideSums sums;
};

// Data shared by all threads that vote with one exemplar, which must outlive it.
class WideVotes {
 public:
  explicit WideVotes(const PreparedExemplar& exemplar) : exemplar_(exemplar), usable_(exemplar) {}
  // Votes on the input's region in this thread. The input's exemplar is this one, its radius at most kWidestRadius; its
  // field and `active` need only hold the rows of the region and those up to the radius above and below.
  void Vote(const VoteInput& input, WideScratch& scratch, Picture& out) const;

 private:
  const PreparedExemplar& exemplar_;
  UsableRows usable_;
};

// The picture of VotePlainly (vote.h), to the bit, for radii of 0 … kWidestRadius; Vote takes it from 2 on.
bool WideVote(const VoteInput& input, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
