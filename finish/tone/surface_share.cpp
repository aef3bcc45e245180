#include "finish/tone/surface_share.h"

#include "core/filter/wide_loops.h"

namespace scumble::internal {

SCUMBLE_WIDE_LOOPS void SurfaceShares(const float* coverage, const std::uint16_t* texels, bool of_guides,
                                      std::size_t count, float* shares) {
  constexpr float kHalfStep = 0.5f / 255.0f;
  for (std::size_t i = 0; i < count; ++i) {
    const float alpha = static_cast<float>(texels[4 * i + 3]) / 65535.0f;
    const bool is_whole = of_guides || coverage[i] + kHalfStep >= alpha;
    const float share = is_whole ? 1.0f : coverage[i] / alpha;
    shares[i] = coverage[i] > 0.0f ? share : 0.0f;
  }
}

}  // namespace scumble::internal
