#include "transfer/vote/wide/vote_removal.h"

#include <hwy/cache_control.h>

#include <algorithm>

namespace scumble::internal {

void WideWithdrawals::Apply(const VoteInput& input, const WideTile& tile, WideSums& sums) {
  constexpr std::size_t kTogether = 64;
  const SourceField& field = input.field;
  const std::uint16_t* texels[kTogether];
  for (std::size_t first = 0; first < count_; first += kTogether) {
    const Run* runs = runs_.data() + first;
    const std::size_t count = std::min(kTogether, count_ - first);
    for (std::size_t k = 0; k < count; ++k) {
      const Run& run = runs[k];
      const std::size_t q = field.Index(tile.area().x0 + run.column + run.dx, tile.area().y0 + run.row + run.dy);
      // All votes of a chunk for a pixel are for one texel, which counts if it is usable.
      const Source source{field.x[q] - run.dx, field.y[q] - run.dy};
      const bool usable = input.exemplar.Usable(source.x, source.y);
      texels[k] = usable ? input.exemplar.picture(field.exemplar[q]).At(source.x, source.y) : nullptr;
      hwy::Prefetch(texels[k]);
    }
    for (std::size_t k = 0; k < count; ++k) {
      if (texels[k]) sums.Withdraw(runs[k].column, runs[k].row, texels[k], static_cast<std::uint32_t>(runs[k].votes));
    }
  }
  count_ = 0;
}

}  // namespace scumble::internal
