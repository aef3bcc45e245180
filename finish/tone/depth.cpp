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
    for (std::size_t i = 0; i < count; ++i) {
      const float at = depth[first + i];
      const auto u = static_cast<float>(scale->Share(at));
      float &lightness = block.lightness[i], &a = block.a[i], &b = block.b[i];
      if (u > 0.0f) {
        const float kept = 1.0f - desaturate * u, taken = tint * u;
        a = kept * a, b = kept * b;
        a += (color.a - a) * taken, b += (color.b - b) * taken;
      }
      if (!has_air) continue;
      const auto share = static_cast<float>(air->Share(scale->Distance(at)));
      if (!(share > 0.0f)) continue;
      lightness += (color.lightness - lightness) * share;
      a += (color.a - a) * share, b += (color.b - b) * share;
    }
  };
}

}  // namespace scumble::internal
