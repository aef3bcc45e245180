// The usable texels of an exemplar, row by row.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/filter/region.h"
#include "transfer/prepared_exemplar.h"

namespace scumble::internal {

class UsableRows {
 public:
  struct Span {
    int begin, end;  // texels [begin, end)
  };
  // O(rows · log columns) for a sphere, O(texels) for a scene.
  explicit UsableRows(const PreparedExemplar& exemplar);

  // The spans of usable texels of row y, from left to right; none outside the picture.
  std::span<const Span> Row(int y) const {
    if (y < 0 || y + 1 >= static_cast<int>(first_.size())) return {};
    return {spans_.data() + first_[y], spans_.data() + first_[y + 1]};
  }

  // Whether all texels of a rectangle are known to be usable. A sphere's disc is convex, so the rectangle's first and
  // last row decide. For a scene the answer is always false.
  bool AllOf(const Region& texels) const {
    const auto holds = [&](int y) {
      const std::span<const Span> row = Row(y);
      return !row.empty() && row.front().begin <= texels.x0 && texels.x1 <= row.front().end;
    };
    return is_sphere_ && !texels.empty() && holds(texels.y0) && holds(texels.y1 - 1);
  }

 private:
  bool is_sphere_;
  std::vector<Span> spans_;
  std::vector<std::uint32_t> first_;  // by row, and the end of the last
};

}  // namespace scumble::internal
