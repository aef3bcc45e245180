#include "transfer/vote/wide/wide_vote.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <vector>

namespace scumble::internal {

void WideVotes::Vote(const VoteInput& input, WideScratch& scratch, Picture& out) const {
  const Region& region = input.region;
  for (int y0 = region.y0; y0 < region.y1; y0 += kTileSide) {
    for (int x0 = region.x0; x0 < region.x1; x0 += kTileSide) {
      const Region area{x0, y0, std::min(region.x1, x0 + kTileSide), std::min(region.y1, y0 + kTileSide)};
      if (!scratch.tile.Read(input, area)) continue;
      if (input.edges) {
        scratch.arms.Read(input, area);
      } else {
        scratch.arms.SetWhole(input.radius);
      }
      scratch.sums.Sum(scratch.tile, scratch.arms, exemplar_, usable_);
      scratch.sums.Write(scratch.tile, out);
      for (int y = area.y0; input.finished && y < area.y1; ++y) input.finished(y, area.x0, area.x1);
    }
  }
}

bool WideVote(const VoteInput& input, Picture& out, RowProgress& progress) {
  const Region& region = input.region;
  if (region.empty()) return !progress.cancelled();
  const WideVotes votes(input.exemplar);
  const int columns = (region.x1 - region.x0 + kTileSide - 1) / kTileSide;
  const int rows = (region.y1 - region.y0 + kTileSide - 1) / kTileSide;
  tbb::enumerable_thread_specific<WideScratch> scratch;
  std::vector<std::atomic<int>> left(static_cast<std::size_t>(rows));  // tiles that are still to be done
  for (auto& count : left) count = columns;
  tbb::parallel_for(0, rows * columns, [&](int index) {
    if (progress.cancelled()) return;
    const int row = index / columns, x0 = region.x0 + index % columns * kTileSide, y0 = region.y0 + row * kTileSide;
    VoteInput tile = input;
    tile.region = {x0, y0, std::min(region.x1, x0 + kTileSide), std::min(region.y1, y0 + kTileSide)};
    votes.Vote(tile, scratch.local(), out);
    if (--left[std::size_t(row)] == 0) progress.Finished(tile.region.y1 - tile.region.y0);
  });
  return !progress.cancelled();
}

}  // namespace scumble::internal
