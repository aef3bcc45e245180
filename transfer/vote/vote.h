// From sources to colours: neighbouring chunks vote (Sýkora et al. 2019, section 3.3).
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <span>

#include "core/filter/edge_test.h"
#include "core/filter/parallel.h"
#include "core/image/guides.h"
#include "scumble/picture.h"
#include "transfer/prepared_exemplar.h"
#include "transfer/source_field.h"
#include "transfer/vote/edge/support_regions.h"

namespace scumble::internal {

struct VoteInput {
  const SourceField& field;
  std::span<const std::uint8_t> active;  // 1: a pixel that this style paints; others neither vote nor are painted
  const PreparedExemplar& exemplar;
  int radius = 0;
  const EdgeRules* edges = nullptr;  // null: windows are not cut at edges
  Region region;
  // Called from any thread for parts x0 … x1 - 1 of rows whose votes are counted, while they are in the caches: once
  // for each active pixel of the region, and maybe for others. It may change those pixels of the picture.
  std::function<void(int y, int x0, int x1)> finished = {};
};

// How far a pixel votes: at most over one cell of the seed grid that settled it, so that chunks of a few pixels do not
// blur what lies around them, and cost no more votes than large ones.
inline int VoteReach(int level, int radius) { return std::min(radius, 1 << std::max(0, level)); }

// Calls visit(exemplar, source) for each vote on the colour of an active pixel (x, y). Each active pixel q of the
// (2·radius + 1)² window, or of its support region if `regions` is given, votes for the texel S(q) + (p - q) if that is
// usable and p is within the reach of q. `regions` must be of the input's radius and hold (x, y). The pixel's own vote
// is always among them.
template <class Visit>
void ForEachVote(const VoteInput& input, const SupportRegions* regions, int x, int y, const Visit& visit) {
  const SourceField& field = input.field;
  const auto offer = [&](std::size_t q, int dx, int dy) {
    if (!input.active[q] || std::max(std::abs(dx), std::abs(dy)) > VoteReach(field.level[q], input.radius)) return;
    const Source source{field.x[q] - dx, field.y[q] - dy};
    if (input.exemplar.Usable(source.x, source.y)) visit(int(field.exemplar[q]), source);
  };
  if (regions) {
    regions->ForEach(x, y, offer);
    return;
  }
  const int x0 = std::max(0, x - input.radius), x1 = std::min(field.width - 1, x + input.radius);
  const int y0 = std::max(0, y - input.radius), y1 = std::min(field.height - 1, y + input.radius);
  for (int v = y0; v <= y1; ++v) {
    for (int u = x0; u <= x1; ++u) offer(field.Index(u, v), u - x, v - y);
  }
}

// Every active pixel of the region becomes the mean of its votes: of the texels that the chunks around it would put
// there. Inside a chunk all votes agree, so the result is a plain copy. Sums are integers, weighted by the texels'
// alpha. Writes straight alpha into `out` (the picture's size); other pixels stay. False: cancelled.
bool Vote(const VoteInput& input, Picture& out, RowProgress& progress);

// Vote pixel by pixel: the reference of all faster forms.
bool VotePlainly(const VoteInput& input, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
