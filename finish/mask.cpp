#include "finish/mask.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/filter/resample.h"

namespace scumble {
namespace {

double DepthShare(const FinishMask& mask, double depth) {
  const auto beyond = [&](double by) {
    return mask.soft > 0.0 ? std::clamp(by / mask.soft + 0.5, 0.0, 1.0) : by >= 0.0 ? 1.0 : 0.0;
  };
  if (!(depth >= 0.0)) return 0.0;
  const double near = mask.near > 0.0 ? beyond(depth - mask.near) : 1.0;
  return near * (mask.far > 0.0 ? beyond(mask.far - depth) : 1.0);
}

double RadialShare(int x, int y, int width, int height) {
  const double u = (2.0 * x + 1.0) / width - 1.0, v = (2.0 * y + 1.0) / height - 1.0;
  const double r = std::min(1.0, u * u + v * v);
  return r * r * (3.0 - 2.0 * r);
}

}  // namespace

std::vector<std::uint16_t> MaskShares(const FinishMask& mask, const GuideSet* guides, int width, int height) {
  std::vector<std::uint16_t> shares;
  if (mask.empty()) return shares;
  shares.resize(std::size_t(width) * std::size_t(height));
  Picture picture;
  if (mask.picture) picture = Resample(*mask.picture, width, height);
  const bool is_radial = mask.shape == kRadialMask, has_depth = mask.HasDepth() && guides;
  const auto depth = has_depth ? guides->Plane(Layer::kDepth) : std::span<const float>();
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      for (int x = 0; x < width; ++x) {
        const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
        double share = 1.0;
        if (has_depth) share *= DepthShare(mask, depth[i]);
        if (is_radial) share *= RadialShare(x, y, width, height);
        if (mask.picture) share *= picture.rgba[4 * i] / 65535.0;
        if (mask.invert) share = 1.0 - share;
        shares[i] = static_cast<std::uint16_t>(share * 65535.0 + 0.5);
      }
    }
  });
  return shares;
}

}  // namespace scumble
