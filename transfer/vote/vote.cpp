#include "transfer/vote/vote.h"

#include <optional>

#include "transfer/vote/small_vote.h"
#include "transfer/vote/vote_sum.h"
#include "transfer/vote/wide/wide_vote.h"

namespace scumble::internal {

bool VotePlainly(const VoteInput& input, Picture& out, RowProgress& progress) {
  const SourceField& field = input.field;
  const Region& region = input.region;
  std::optional<SupportRegions> regions;
  if (input.edges) regions.emplace(*input.edges, input.active, input.radius, region);
  return ForEachRow(region, progress, [&](int y) {
    for (int x = region.x0; x < region.x1; ++x) {
      if (!input.active[field.Index(x, y)]) continue;
      VoteSum sum;
      ForEachVote(input, regions ? &*regions : nullptr, x, y, [&](int exemplar, Source source) {
        sum.Add(input.exemplar.picture(exemplar).At(source.x, source.y));
      });
      sum.Count(out.At(x, y));
    }
    if (input.finished) input.finished(y, region.x0, region.x1);
  });
}

bool Vote(const VoteInput& input, Picture& out, RowProgress& progress) {
  if (input.radius <= kSmallRadius) return VoteSmall(input, out, progress);
  return input.radius <= kWidestRadius ? WideVote(input, out, progress) : VotePlainly(input, out, progress);
}

}  // namespace scumble::internal
