#include "transfer/vote/vote.h"

#include "transfer/vote/vote_sum.h"
#include "transfer/vote/chunk_interiors.h"
#include "transfer/vote/small_vote.h"
#include "transfer/vote/wide/wide_vote.h"

namespace scumble::internal {

bool VotePlainly(const VoteInput& input, Picture& out, RowProgress& progress) {
  const SourceField& field = input.field;
  const Region& region = input.region;
  std::optional<EdgeWindows> edges;
  if (input.edges) edges.emplace(*input.edges, input.radius, region);
  const JoinedWindow* joined = edges ? &edges->joined : nullptr;
  const std::vector<std::uint8_t> inside = ChunkInteriors(field, input.active, input.radius, region);
  return ForEachRow(region, progress, [&](int y) {
    const std::uint8_t* copied = inside.data() + std::size_t(y - region.y0) * (region.x1 - region.x0);
    for (int x = region.x0; x < region.x1; ++x) {
      const std::size_t p = field.Index(x, y);
      if (!input.active[p]) continue;
      Ballot ballot;
      const auto add = [&](int exemplar, Source source) {
        ballot.Add(input.exemplar.picture(exemplar).At(source.x, source.y));
      };
      if (copied[x - region.x0]) add(field.exemplar[p], {field.x[p], field.y[p]});  // all votes would be this one
      else ForEachVote(input, joined, x, y, add);
      ballot.Count(out.At(x, y));
    }
    if (input.finished) input.finished(y, region.x0, region.x1);
  });
}

bool Vote(const VoteInput& input, Picture& out, RowProgress& progress) {
  if (input.radius >= kWideRadius && input.radius <= kWidestRadius) return WideVote(input, out, progress);
  return input.radius <= kSmallRadius ? VoteSmall(input, out, progress) : VotePlainly(input, out, progress);
}

}  // namespace scumble::internal
