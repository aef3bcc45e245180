#include <array>
#include <cmath>
#include <memory>
#include <span>

#include "core/image/exact_math.h"
#include "finish/tone/depth_scale.h"
#include "finish/tone/point_effect.h"

namespace scumble::internal {
namespace {

// Of the air between near and a distance, by Beer and Lambert's law: `air` at 1.
class Air {
 public:
  explicit Air(double air) : air_(air) {
    if (air > 0.0 && air < 1.0)
      share_ = Curve(8.0, [rate = Log2(1.0 - air)](double distance) { return 1.0 - Exp2(rate * distance); });
  }
  double Share(double distance) const {
    if (!(distance > 0.0)) return 0.0;
    if (!(air_ > 0.0)) return 0.0;
    if (air_ >= 1.0 || std::isinf(distance)) return 1.0;
    return share_.At(distance);
  }

 private:
  double air_;
  Curve share_;
};

}  // namespace

PointEffect MakeDepth(const DepthPass& pass, const FinishFrame& frame) {
  // Copies of the effect share their tables.
  const auto scale = std::make_shared<const DepthScale>(pass, frame.measures);
  const auto air = std::make_shared<const Air>(pass.air);
  const std::span<const float> depth = frame.guides->Plane(Layer::kDepth);
  const LabColor color = ToOklab(pass.color);
  const bool has_air = pass.air > 0.0;
  const auto desaturate = static_cast<float>(pass.desaturate), tint = static_cast<float>(pass.tint);
  return [=](std::size_t first, std::size_t count, OklabBlock& block) {
    std::array<float, kOklabBlock> shares;
    scale->Shares(depth.data() + first, count, shares.data());
    for (std::size_t i = 0; i < count; ++i) {
      const float kept = 1.0f - desaturate * shares[i], taken = tint * shares[i];
      const float a = kept * block.a[i], b = kept * block.b[i];
      block.a[i] = a + (color.a - a) * taken, block.b[i] = b + (color.b - b) * taken;
    }
    for (std::size_t i = 0; i < count && has_air; ++i) {
      const auto share = static_cast<float>(air->Share(scale->Distance(depth[first + i])));
      block.lightness[i] += (color.lightness - block.lightness[i]) * share;
      block.a[i] += (color.a - block.a[i]) * share, block.b[i] += (color.b - block.b[i]) * share;
    }
  };
}

}  // namespace scumble::internal
