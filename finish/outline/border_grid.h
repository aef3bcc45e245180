// Borders between pixels as lines of a grid: which end where.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "finish/outline/border_map.h"

namespace scumble::internal {

// A border: the one to the right of the pixel, or below it.
struct Border {
  int x, y;
  bool is_right;
  bool operator==(const Border&) const = default;
};

// A corner of the pixels, 0 … width by 0 … height.
struct Corner {
  int x, y;
  bool operator==(const Corner&) const = default;
};

// Keeps a reference to the map.
class BorderGrid {
 public:
  explicit BorderGrid(BorderMap& map) : map_(map) {}

  std::uint8_t& At(const Border& border) {
    const std::size_t i = First(border);
    return border.is_right ? map_.right[i] : map_.below[i];
  }

  // The pixels on its two sides.
  std::size_t First(const Border& border) const {
    return std::size_t(border.y) * std::size_t(map_.width) + std::size_t(border.x);
  }
  std::size_t Second(const Border& border) const {
    return First(border) + (border.is_right ? 1 : std::size_t(map_.width));
  }

  static std::array<Corner, 2> Corners(const Border& border) {
    const auto [x, y, is_right] = border;
    return is_right ? std::array{Corner{x + 1, y}, Corner{x + 1, y + 1}}
                    : std::array{Corner{x, y + 1}, Corner{x + 1, y + 1}};
  }
  static Corner OtherEnd(const Border& border, const Corner& corner) {
    const std::array<Corner, 2> ends = Corners(border);
    return ends[0] == corner ? ends[1] : ends[0];
  }

  // Calls visit for each border that ends in the corner and is not 0: above, to the left, to the right, below.
  template <class Visit>
  void ForEachAt(const Corner& corner, const Visit& visit) {
    ForEachPlaceAt(corner, [&](const Border& border) {
      if (At(border)) visit(border);
    });
  }
  // The same for those that are 0 too.
  template <class Visit>
  void ForEachPlaceAt(const Corner& corner, const Visit& visit) const {
    const auto [x, y] = corner;
    const auto offer = [&](const Border& border) {
      const int right = border.x + (border.is_right ? 1 : 0), below = border.y + (border.is_right ? 0 : 1);
      if (border.x >= 0 && border.y >= 0 && right < map_.width && below < map_.height) visit(border);
    };
    offer({x - 1, y - 1, true});
    offer({x - 1, y - 1, false});
    offer({x, y - 1, false});
    offer({x - 1, y, true});
  }

  // Calls visit for each border that is not 0, row by row.
  template <class Visit>
  void ForEachBorder(const Visit& visit) {
    for (int y = 0; y < map_.height; ++y) {
      const std::size_t row = std::size_t(y) * std::size_t(map_.width);
      for (int x = 0; x < map_.width; ++x) {
        while (x + kAtOnce <= map_.width && HasNone(row + std::size_t(x))) x += kAtOnce;
        if (x == map_.width) break;
        const std::size_t i = row + std::size_t(x);
        if (map_.right[i]) visit(Border{x, y, true});
        if (map_.below[i]) visit(Border{x, y, false});
      }
    }
  }

 private:
  // Whether kAtOnce pixels have no border.
  static constexpr int kAtOnce = 8;
  bool HasNone(std::size_t first) const {
    std::uint64_t right, below;
    std::memcpy(&right, map_.right.data() + first, kAtOnce);
    std::memcpy(&below, map_.below.data() + first, kAtOnce);
    return (right | below) == 0;
  }

  BorderMap& map_;
};

}  // namespace scumble::internal
