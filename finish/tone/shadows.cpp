#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/filter/wide_loops.h"
#include "finish/tone/point_effect.h"

namespace scumble::internal {
namespace {

inline float Clamped(float x) { return x < 0.0f ? 0.0f : 1.0f < x ? 1.0f : x; }

inline float SmoothStep(float from, float to, float x) {
  const float t = to > from ? Clamped((x - from) / (to - from)) : x < from ? 0.0f : 1.0f;
  return t * t * (3.0f - 2.0f * t);
}

SCUMBLE_WIDE_LOOPS void TakeCast(const float* shadow, std::size_t count, float* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = Clamped(shadow[i]);
}

SCUMBLE_WIDE_LOOPS void AddForm(const float* light, float full, float none, std::size_t count, float* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const float form = 1.0f - SmoothStep(full, none, light[i]);
    out[i] = out[i] < form ? form : out[i];
  }
}

// How much of pixels is in shade, 0 … 1: the larger of cast and form shadow.
class Shade {
 public:
  Shade(const ShadowsPass& pass, const FinishFrame& frame)
      : full_(static_cast<float>(pass.full * frame.measures.bright)),
        none_(static_cast<float>(pass.none * frame.measures.bright)) {
    if (pass.source != ShadowsPass::Source::kForm) cast_ = frame.guides->Plane(Layer::kShadow);
    if (pass.source != ShadowsPass::Source::kCast) light_ = frame.guides->Plane(Layer::kLuminance);
  }
  void Of(std::size_t first, std::size_t count, float* out) const {
    if (cast_.empty()) std::fill_n(out, count, 0.0f);
    if (!cast_.empty()) TakeCast(cast_.data() + first, count, out);
    if (!light_.empty()) AddForm(light_.data() + first, full_, none_, count, out);
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

template <ShadowsPass::Mode kMode>
Look LookOf(const LabColor& paint, const LabColor& color, float tint) {
  const auto& [lightness, a, b] = paint;
  switch (kMode) {
    case ShadowsPass::Mode::kBlack:
      return {{0.0f, 0.0f, 0.0f}, paint};
    case ShadowsPass::Mode::kDarker:
      return {{0.5f * lightness, 0.5f * a, 0.5f * b}, paint};
    case ShadowsPass::Mode::kColor:
      return {color, paint};
    case ShadowsPass::Mode::kComplement: {
      const float grey = tint * (1.0f - SmoothStep(0.0f, kGrey, std::sqrt(a * a + b * b)));
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

// `shares`: of shade.
template <ShadowsPass::Mode kMode>
SCUMBLE_WIDE_LOOPS void PaintShade(const float* shares, const LabColor& color, float tint, std::size_t count,
                                   OklabBlock& block) {
  constexpr bool kChangesLight = kMode == ShadowsPass::Mode::kChiaroscuro || kMode == ShadowsPass::Mode::kImpression;
  for (std::size_t i = 0; i < count; ++i) {
    const LabColor paint{block.lightness[i], block.a[i], block.b[i]};
    const auto [dark, light] = LookOf<kMode>(paint, color, tint);
    const bool stays = !kChangesLight && !(shares[i] > 0.0f);
    block.lightness[i] = stays ? paint.lightness : Mix(light.lightness, dark.lightness, shares[i]);
    block.a[i] = stays ? paint.a : Mix(light.a, dark.a, shares[i]);
    block.b[i] = stays ? paint.b : Mix(light.b, dark.b, shares[i]);
  }
}

using ShadePainter = void (*)(const float* shares, const LabColor& color, float tint, std::size_t count,
                              OklabBlock& block);

ShadePainter PainterOf(ShadowsPass::Mode mode) {
  using Mode = ShadowsPass::Mode;
  switch (mode) {
    case Mode::kBlack:
      return PaintShade<Mode::kBlack>;
    case Mode::kDarker:
      return PaintShade<Mode::kDarker>;
    case Mode::kColor:
      return PaintShade<Mode::kColor>;
    case Mode::kComplement:
      return PaintShade<Mode::kComplement>;
    case Mode::kChiaroscuro:
      return PaintShade<Mode::kChiaroscuro>;
    case Mode::kImpression:
      return PaintShade<Mode::kImpression>;
    case Mode::kNegative:
      return PaintShade<Mode::kNegative>;
  }
  return PaintShade<Mode::kDarker>;
}

}  // namespace

void ShadeOf(const ShadowsPass& pass, const FinishFrame& frame, std::size_t first, std::size_t count, float* out) {
  Shade(pass, frame).Of(first, count, out);
}

PointEffect MakeShadows(const ShadowsPass& pass, const FinishFrame& frame, std::span<const float> soft) {
  const Shade shade(pass, frame);
  const LabColor color = ToOklab(pass.color);
  return [=, tint = static_cast<float>(pass.tint), paint = PainterOf(pass.mode)](std::size_t first, std::size_t count,
                                                                                 OklabBlock& block) {
    std::array<float, kOklabBlock> shares;
    if (soft.empty()) shade.Of(first, count, shares.data());
    paint(soft.empty() ? shares.data() : soft.data() + first, color, tint, count, block);
  };
}

}  // namespace scumble::internal
