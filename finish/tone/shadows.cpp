#include <algorithm>
#include <cmath>
#include <span>

#include "finish/tone/point_effect.h"

namespace scumble::internal {
namespace {

float SmoothStep(float from, float to, float x) {
  if (!(to > from)) return x < from ? 0.0f : 1.0f;
  const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

// How much of a pixel is in shade, 0 … 1: the larger of cast and form shadow.
class Shade {
 public:
  Shade(const ShadowsPass& pass, const FinishFrame& frame)
      : full_(static_cast<float>(pass.full * frame.measures.bright)),
        none_(static_cast<float>(pass.none * frame.measures.bright)) {
    if (pass.source != ShadowsPass::Source::kForm) cast_ = frame.guides->Plane(Layer::kShadow);
    if (pass.source != ShadowsPass::Source::kCast) light_ = frame.guides->Plane(Layer::kLuminance);
  }
  float At(std::size_t pixel) const {
    const float cast = cast_.empty() ? 0.0f : std::clamp(cast_[pixel], 0.0f, 1.0f);
    return light_.empty() ? cast : std::max(cast, 1.0f - SmoothStep(full_, none_, light_[pixel]));
  }

 private:
  float full_, none_;
  std::span<const float> cast_, light_;
};

float Mix(float from, float to, float share) { return from + (to - from) * share; }

// The colour of paint that is in full shade, and of paint in full light; what is between mixes them.
struct Look {
  LabColor shade, light;
};

// Below this chroma paint counts more and more as grey.
constexpr float kGrey = 0.04f;

Look LookOf(ShadowsPass::Mode mode, const LabColor& paint, const LabColor& color) {
  const auto& [lightness, a, b] = paint;
  switch (mode) {
    case ShadowsPass::Mode::kBlack:
      return {{0.0f, 0.0f, 0.0f}, paint};
    case ShadowsPass::Mode::kDarker:
      return {{0.5f * lightness, 0.5f * a, 0.5f * b}, paint};
    case ShadowsPass::Mode::kColor:
      return {color, paint};
    case ShadowsPass::Mode::kComplement: {
      const float grey = 1.0f - SmoothStep(0.0f, kGrey, std::sqrt(a * a + b * b));
      return {{lightness, Mix(-a, color.a, grey), Mix(-b, color.b, grey)}, paint};
    }
    case ShadowsPass::Mode::kChiaroscuro:
      return {{0.35f * lightness, 0.6f * a, 0.6f * b}, {Mix(lightness, 1.0f, 0.25f), a, b}};
    case ShadowsPass::Mode::kImpression:
      return {{0.85f * lightness, 1.4f * a, 1.4f * b}, {Mix(lightness, 1.0f, 0.2f), 0.7f * a, 0.7f * b}};
    case ShadowsPass::Mode::kNegative:
      return {{1.0f - lightness, -a, -b}, paint};
  }
  return {paint, paint};
}

}  // namespace

void ShadeOf(const ShadowsPass& pass, const FinishFrame& frame, std::size_t first, std::size_t count, float* out) {
  const Shade shade(pass, frame);
  for (std::size_t i = 0; i < count; ++i) out[i] = shade.At(first + i);
}

PointEffect MakeShadows(const ShadowsPass& pass, const FinishFrame& frame, std::span<const float> soft) {
  const Shade shade(pass, frame);
  const LabColor color = ToOklab(pass.color);
  const bool changes_light =
      pass.mode == ShadowsPass::Mode::kChiaroscuro || pass.mode == ShadowsPass::Mode::kImpression;
  return [=, mode = pass.mode](std::size_t first, std::size_t count, OklabBlock& block) {
    for (std::size_t i = 0; i < count; ++i) {
      const float share = soft.empty() ? shade.At(first + i) : soft[first + i];
      if (!(share > 0.0f) && !changes_light) continue;
      const auto [dark, light] = LookOf(mode, {block.lightness[i], block.a[i], block.b[i]}, color);
      block.lightness[i] = Mix(light.lightness, dark.lightness, share);
      block.a[i] = Mix(light.a, dark.a, share);
      block.b[i] = Mix(light.b, dark.b, share);
    }
  };
}

}  // namespace scumble::internal
