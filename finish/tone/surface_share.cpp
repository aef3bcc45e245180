#include "finish/tone/surface_share.h"

#include "core/filter/wide_loops.h"

namespace scumble::internal {

namespace {

SCUMBLE_WIDE_LOOPS void MakeShares(const float* coverage, const std::uint16_t* texels, bool of_guides,
                                   std::size_t count, float* shares) {
  constexpr float kHalfStep = 0.5f / 255.0f;
  for (std::size_t i = 0; i < count; ++i) {
    const float alpha = static_cast<float>(texels[4 * i + 3]) / 65535.0f;
    const bool is_whole = of_guides || coverage[i] + kHalfStep >= alpha;
    const float share = is_whole ? 1.0f : coverage[i] / alpha;
    shares[i] = coverage[i] > 0.0f ? share : 0.0f;
  }
}

SCUMBLE_WIDE_LOOPS ShareKinds KindsOf(const float* shares, std::size_t count) {
  int zeros = 0, ones = 0;
  for (std::size_t i = 0; i < count; ++i) {
    zeros += shares[i] > 0.0f ? 0 : 1;
    ones += shares[i] < 1.0f ? 0 : 1;
  }
  const int all = static_cast<int>(count);
  return {.all_zero = zeros == all, .all_one = ones == all, .is_mixed = zeros + ones < all};
}

}  // namespace

ShareKinds SurfaceShares(const float* coverage, const std::uint16_t* texels, bool of_guides, std::size_t count,
                         float* shares) {
  MakeShares(coverage, texels, of_guides, count, shares);
  return KindsOf(shares, count);
}

}  // namespace scumble::internal
