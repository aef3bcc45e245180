#include "core/painting/soft_edge.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/painting/bare_paper.h"

namespace scumble {
namespace {

constexpr std::uint16_t kClear = 655;                // 1%: less is no paint
constexpr double kDeepest = 0.1;                     // of the radius
constexpr double kInnerFrom = 0.1, kInnerTo = 0.25;  // depths of the rings to compare with
constexpr double kSlack = 0.001;                     // of a ring's pixels
constexpr std::size_t kInARow = 3;

// 99% of the median alpha of the paint at nine tenths of the radius and deeper.
std::uint16_t OpaqueFrom(const Picture& picture) {
  const double half = 0.5 * picture.width, inner = (1.0 - kInnerFrom) * half;
  std::vector<std::uint16_t> alphas;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double dx = x + 0.5 - half, dy = y + 0.5 - half;
      const std::uint16_t alpha = picture.At(x, y)[3];
      if (alpha > kClear && dx * dx + dy * dy <= inner * inner) alphas.push_back(alpha);
    }
  }
  if (alphas.empty()) return 65535;
  const auto middle = alphas.begin() + std::ptrdiff_t(alphas.size() / 2);
  std::nth_element(alphas.begin(), middle, alphas.end());
  return static_cast<std::uint16_t>(*middle - *middle / 100);
}

}  // namespace

int SoftEdge(const Picture& picture) {
  if (picture.empty() || !HasClearCorners(picture)) return 0;
  const double half = 0.5 * picture.width;
  const std::uint16_t opaque_from = OpaqueFrom(picture);
  struct Ring {
    double pixels = 0, opaque = 0;
    double Share() const { return pixels > 0 ? opaque / pixels : 1.0; }
  };
  std::vector<Ring> rings(static_cast<std::size_t>(kInnerTo * half) + kInARow + 1);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double dx = x + 0.5 - half, dy = y + 0.5 - half, depth = half - std::sqrt(dx * dx + dy * dy);
      if (!(depth >= 0.0 && depth < static_cast<double>(rings.size()))) continue;
      Ring& ring = rings[static_cast<std::size_t>(depth)];
      ring.pixels += 1, ring.opaque += picture.At(x, y)[3] >= opaque_from;
    }
  }
  double least = 1.0;
  for (auto k = static_cast<std::size_t>(kInnerFrom * half); k <= static_cast<std::size_t>(kInnerTo * half); ++k) {
    least = std::min(least, rings[k].Share());
  }
  // Between loose strokes the shares scatter; where all is opaque, they do not.
  const double enough = least - std::min(0.05, 1.0 - least) - kSlack;
  std::size_t in_a_row = 0;
  for (std::size_t k = 0; k < rings.size(); ++k) {
    in_a_row = rings[k].Share() >= enough ? in_a_row + 1 : 0;
    if (in_a_row < kInARow) continue;
    const std::size_t depth = k + 1 - kInARow;
    return static_cast<double>(depth) <= kDeepest * half ? static_cast<int>(depth) : 0;
  }
  return 0;
}

}  // namespace scumble
