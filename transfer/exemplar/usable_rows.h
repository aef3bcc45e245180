// Which texels of an exemplar may be shown, row by row.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/filter/region.h"
#include "transfer/exemplar/prepared_exemplar.h"

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

  // Whether all texels of a rectangle are surely usable: of a sphere, whose disc bulges nowhere inwards, its first and
  // its last row tell; of a scene it is not found out.
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
