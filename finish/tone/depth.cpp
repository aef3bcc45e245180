#include <array>
#include <cmath>
#include <memory>
#include <span>

#include "core/filter/wide_loops.h"
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

// What distance takes of the paint's own chroma, and what it gives of the colour's.
struct Haze {
  float desaturate, tint;
  LabColor color;
};

SCUMBLE_WIDE_LOOPS void Fade(const Haze& haze, const float* shares, std::size_t count, float* a, float* b) {
  const auto [desaturate, tint, color] = haze;
  for (std::size_t i = 0; i < count; ++i) {
    const float kept = 1.0f - desaturate * shares[i], taken = tint * shares[i];
    const float own_a = kept * a[i], own_b = kept * b[i];
    a[i] = own_a + (color.a - own_a) * taken, b[i] = own_b + (color.b - own_b) * taken;
  }
}

// `depth_of`: of the pixels from `first` on, kOklabBlock at most.
template <typename DepthOf>
PointEffect Make(const DepthPass& pass, FinishPass::Stage at, const FinishFrame& frame, DepthOf depth_of) {
  // Copies of the effect share their tables.
  const auto scale = std::make_shared<const DepthScale>(pass, frame.measures);
  const auto air = std::make_shared<const Air>(pass.air);
  const LabColor color = ToOklab(pass.color);
  // What a picture shows behind all surfaces, such as a sky, is its painter's own. A sheet is bare there.
  const float infinity = BackgroundValue(Layer::kDepth);
  const double behind = at == FinishPass::Stage::kSheet ? air->Share(scale->Distance(infinity)) : air->Share(1.0);
  const bool has_air = pass.air > 0.0;
  const Haze haze{static_cast<float>(pass.desaturate), static_cast<float>(pass.tint), color};
  return [=](std::size_t first, std::size_t count, OklabBlock& block) {
    std::array<float, kOklabBlock> shares;
    const float* const depth = depth_of(first);
    scale->Shares(depth, count, shares.data());
    Fade(haze, shares.data(), count, block.a.data(), block.b.data());
    for (std::size_t i = 0; i < count && has_air; ++i) {
      const bool is_behind = depth[i] == infinity;
      const auto share = static_cast<float>(is_behind ? behind : air->Share(scale->Distance(depth[i])));
      block.lightness[i] += (color.lightness - block.lightness[i]) * share;
      block.a[i] += (color.a - block.a[i]) * share, block.b[i] += (color.b - block.b[i]) * share;
    }
  };
}

}  // namespace

PointEffect MakeDepth(const DepthPass& pass, FinishPass::Stage at, const FinishFrame& frame) {
  const std::span<const float> depth = frame.guides->Plane(Layer::kDepth);
  return Make(pass, at, frame, [depth](std::size_t first) { return depth.data() + first; });
}

PointEffect MakeDepthOfBackground(const DepthPass& pass, FinishPass::Stage at, const FinishFrame& frame) {
  std::array<float, kOklabBlock> depth;
  depth.fill(BackgroundValue(Layer::kDepth));
  return Make(pass, at, frame, [depth](std::size_t) { return depth.data(); });
}

}  // namespace scumble::internal
