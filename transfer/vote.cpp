#include "transfer/vote.h"

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
  return ForEachRow(input.region, progress, [&](int y) {
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      if (!input.active[input.field.Index(x, y)]) continue;
      Ballot ballot;
      ForEachVote(input, x, y, [&](int exemplar, Source source) {
        ballot.Add(input.exemplar.picture(exemplar).At(source.x, source.y));
      });
      ballot.Count(out.At(x, y));
    }
  });
}

}  // namespace scumble::internal
