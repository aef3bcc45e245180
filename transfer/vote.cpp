#include "transfer/vote.h"

#include "transfer/chunk_interiors.h"

namespace scumble::internal {
namespace {

struct Ballot {
  std::uint64_t color[3] = {0, 0, 0};
  std::uint64_t alpha = 0;
  std::uint32_t votes = 0;

  void Add(const std::uint16_t* texel) {
    const std::uint64_t weight = texel[3];
    for (int c = 0; c < 3; ++c) color[c] += weight * texel[c];
    alpha += weight;
    ++votes;
  }
  void Count(std::uint16_t* out) const {
    for (int c = 0; c < 3; ++c) out[c] = alpha ? static_cast<std::uint16_t>((color[c] + alpha / 2) / alpha) : 0;
    out[3] = static_cast<std::uint16_t>((alpha + votes / 2) / votes);
  }
};

}  // namespace

bool Vote(const VoteInput& input, Picture& out, RowProgress& progress) {
  const SourceField& field = input.field;
  const Region& region = input.region;
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
      else ForEachVote(input, x, y, add);
      ballot.Count(out.At(x, y));
    }
  });
}

}  // namespace scumble::internal
