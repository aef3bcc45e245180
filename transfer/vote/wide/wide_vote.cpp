#include "transfer/vote/wide/wide_vote.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <vector>

#include "transfer/exemplar/usable_rows.h"
#include "transfer/vote/wide/edge_culling.h"
#include "transfer/vote/wide/run_sums.h"
#include "transfer/vote/wide/guide_tile.h"
#include "transfer/vote/wide/chunk_runs.h"

namespace scumble::internal {
namespace {

struct Scratch {
  WideTile tile;
  WideSums sums;
  WideSurface surface;
  WideJoined joined;
};

}  // namespace

bool WideVote(const VoteInput& input, Picture& out, RowProgress& progress) {
  const Region& region = input.region;
  if (region.empty()) return !progress.cancelled();
  const UsableRows usable(input.exemplar);
  std::optional<WideWays> ways;
  std::optional<EdgeLimits> limits;
  if (input.edges) {
    ways.emplace(input.radius);
    limits.emplace(EdgeLimits{input.edges->CreaseCosine(), input.edges->Give()});
  }
  const int columns = (region.x1 - region.x0 + kTileSide - 1) / kTileSide;
  const int rows = (region.y1 - region.y0 + kTileSide - 1) / kTileSide;
  tbb::enumerable_thread_specific<Scratch> scratch;
  std::vector<std::atomic<int>> left(static_cast<std::size_t>(rows));  // tiles that are still to be done
  for (auto& count : left) count = columns;
  tbb::parallel_for(0, rows * columns, [&](int index) {
    if (progress.cancelled()) return;
    const int row = index / columns, x0 = region.x0 + index % columns * kTileSide, y0 = region.y0 + row * kTileSide;
    const Region area{x0, y0, std::min(region.x1, x0 + kTileSide), std::min(region.y1, y0 + kTileSide)};
    Scratch& mine = scratch.local();
    if (mine.tile.Read(input, area)) {
      mine.sums.Sum(mine.tile, input.exemplar, usable);
      if (input.edges) {
        mine.surface.Read(input.edges->guides, area, input.radius);
        mine.joined.Withdraw(input, *ways, mine.tile, mine.surface, *limits, mine.sums);
      }
      mine.sums.Write(mine.tile, out);
      for (int y = area.y0; input.finished && y < area.y1; ++y) input.finished(y, area.x0, area.x1);
    }
    if (--left[std::size_t(row)] == 0) progress.Finished(area.y1 - area.y0);
  });
  return !progress.cancelled();
}

}  // namespace scumble::internal
