#include "measure/painting/connected_regions.h"

#include <algorithm>
#include <limits>

#include "core/image/check.h"

namespace scumble {

Patches FindPatches(const std::vector<std::uint8_t>& mask, int width, int height, std::size_t least) {
  SCUMBLE_CHECK_EQ(mask.size(), std::size_t(width) * height);
  Patches patches;
  std::vector<std::uint8_t> seen(mask.size(), 0);
  std::vector<std::size_t> patch;
  for (std::size_t start = 0; start < mask.size(); ++start) {
    if (!mask[start] || seen[start]) continue;
    patch.assign(1, start);
    seen[start] = 1;
    double sum_x = 0.0, sum_y = 0.0;
    for (std::size_t next = 0; next < patch.size(); ++next) {
      const std::size_t i = patch[next];
      const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
      sum_x += x, sum_y += y;
      const auto visit = [&](bool inside, std::size_t neighbour) {
        if (!inside || !mask[neighbour] || seen[neighbour]) return;
        seen[neighbour] = 1;
        patch.push_back(neighbour);
      };
      visit(x > 0, i - 1), visit(x + 1 < width, i + 1), visit(y > 0, i - width), visit(y + 1 < height, i + width);
    }
    if (patch.size() < least) continue;
    ++patches.count;
    patches.pixels += patch.size();
    if (patch.size() <= patches.largest) continue;
    patches.largest = patch.size();
    const double size = static_cast<double>(patch.size()), middle_x = sum_x / size, middle_y = sum_y / size;
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::size_t i : patch) {
      const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
      const double distance = (x - middle_x) * (x - middle_x) + (y - middle_y) * (y - middle_y);
      if (distance < nearest) nearest = distance, patches.x = x, patches.y = y;
    }
  }
  return patches;
}

std::vector<std::uint8_t> MostlySet(const std::vector<std::uint8_t>& mask, int width, int height, int reach,
                                    double share) {
  SCUMBLE_CHECK_EQ(mask.size(), std::size_t(width) * height);
  // sums[y][x]: of the rectangle above and left of (x, y).
  const std::size_t stride = std::size_t(width) + 1;
  std::vector<std::uint32_t> sums(stride * (std::size_t(height) + 1), 0);
  for (int y = 0; y < height; ++y) {
    std::uint32_t row = 0;
    for (int x = 0; x < width; ++x) {
      row += mask[std::size_t(y) * width + x] != 0;
      sums[(std::size_t(y) + 1) * stride + x + 1] = sums[std::size_t(y) * stride + x + 1] + row;
    }
  }
  const double needed = share * (2 * reach + 1) * (2 * reach + 1);
  std::vector<std::uint8_t> out(mask.size());
  for (int y = 0; y < height; ++y) {
    const std::size_t top = std::max(0, y - reach) * stride, bottom = std::min(height, y + reach + 1) * stride;
    for (int x = 0; x < width; ++x) {
      const std::size_t left = std::max(0, x - reach), right = std::min(width, x + reach + 1);
      const std::uint32_t set = sums[bottom + right] - sums[bottom + left] - sums[top + right] + sums[top + left];
      out[std::size_t(y) * width + x] = set >= needed;
    }
  }
  return out;
}

}  // namespace scumble
