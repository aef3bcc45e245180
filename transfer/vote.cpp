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
  const SourceField& field = input.field;
  const int radius = input.radius;
  return ForEachRow(input.region, progress, [&](int y) {
    const int y0 = std::max(0, y - radius), y1 = std::min(field.height - 1, y + radius);
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      const std::size_t p = field.Index(x, y);
      if (!input.active[p]) continue;
      const int x0 = std::max(0, x - radius), x1 = std::min(field.width - 1, x + radius);
      Ballot ballot;
      for (int v = y0; v <= y1; ++v) {
        for (int u = x0; u <= x1; ++u) {
          const std::size_t q = field.Index(u, v);
          if (!input.active[q]) continue;
          const int sx = field.x[q] + (x - u), sy = field.y[q] + (y - v);
          if (!input.exemplar.Usable(sx, sy)) continue;
          if (input.edges && !input.edges->SameSurface(p, q, u - x, v - y)) continue;
          ballot.Add(input.exemplar.picture(field.exemplar[q]).At(sx, sy));
        }
      }
      ballot.Count(out.At(x, y));  // p's own vote always counts
    }
  });
}

}  // namespace scumble::internal
