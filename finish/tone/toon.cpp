#include <algorithm>
#include <array>
#include <memory>
#include <span>

#include "core/filter/wide_loops.h"
#include "finish/tone/point_effect.h"
#include "finish/tone/toon_bands.h"
#include "finish/tone/toon_ramp.h"

namespace scumble::internal {
namespace {

// Scaling all of Oklab scales linear colours by the cube: the hue and the saturation stay.
SCUMBLE_WIDE_LOOPS void Darken(const float* light, float darkest, float tint, const LabColor& color, std::size_t count,
                               OklabBlock& block) {
  for (std::size_t i = 0; i < count; ++i) {
    const float factor = darkest + (1.0f - darkest) * light[i], share = tint * (1.0f - light[i]);
    const float a = block.a[i] * factor, b = block.b[i] * factor;
    block.lightness[i] *= factor;
    block.a[i] = a + (color.a - a) * share, block.b[i] = b + (color.b - b) * share;
  }
}

// One darker tone of the base colour.
class PlainShading {
 public:
  explicit PlainShading(const ToonPass& pass)
      : color_(ToOklab(pass.color)), darkest_(static_cast<float>(pass.shade)), tint_(static_cast<float>(pass.tint)) {}

  void Apply(const float* light, std::size_t, std::size_t count, OklabBlock& block) const {
    Darken(light, darkest_, tint_, color_, count, block);
  }

 private:
  LabColor color_;
  float darkest_, tint_;
};

// From cool to warm (Gooch, Gooch, Shirley, Cohen, "A non-photorealistic lighting model for automatic technical
// illustration", 1998), in Oklab: light · (warm + warm_base · base) + (1 - light) · (cool + cool_base · base). A
// lightness above 1 becomes 1; chroma that sRGB lacks is lost where all colours lose it, when they are encoded.
class GoochShading {
 public:
  explicit GoochShading(const ToonPass& pass)
      : warm_(ToOklab(pass.warm)),
        cool_(ToOklab(pass.cool)),
        warm_base_(static_cast<float>(pass.warm_base)),
        cool_base_(static_cast<float>(pass.cool_base)) {}

  void Apply(const float* light, std::size_t, std::size_t count, OklabBlock& block) const {
    for (std::size_t i = 0; i < count; ++i) {
      const float t = light[i], base = cool_base_ + (warm_base_ - cool_base_) * t;
      const auto sum = [&](float warm, float cool, float of_base) { return cool + (warm - cool) * t + base * of_base; };
      block.lightness[i] = std::min(sum(warm_.lightness, cool_.lightness, block.lightness[i]), 1.0f);
      block.a[i] = sum(warm_.a, cool_.a, block.a[i]);
      block.b[i] = sum(warm_.b, cool_.b, block.b[i]);
    }
  }

 private:
  LabColor warm_, cool_;
  float warm_base_, cool_base_;
};

// Colours of a ramp instead of the base colour. Copies share the tables.
class RampShading {
 public:
  RampShading(const ToonPass& pass, const FinishFrame& frame)
      : colors_(std::make_shared<const RampColors>(*pass.ramp_colors)) {
    if (pass.ramp_colors->rows > 1) rows_ = std::make_shared<const RampRows>(pass, frame);
  }

  void Apply(const float* light, std::size_t first, std::size_t count, OklabBlock& block) const {
    float rows[kOklabBlock] = {};
    if (rows_) rows_->At(first, count, rows);
    for (std::size_t i = 0; i < count; ++i) {
      const LabColor color = colors_->At(light[i], rows[i]);
      block.lightness[i] = color.lightness, block.a[i] = color.a, block.b[i] = color.b;
    }
  }

 private:
  std::shared_ptr<const RampColors> colors_;
  std::shared_ptr<const RampRows> rows_;  // null: there is one
};

template <class Shading>
PointEffect ToonOf(const ToonPass& pass, const FinishFrame& frame, std::span<const float> lights,
                   const Shading& shading) {
  const BandOf band_of(pass, frame, lights);
  const bool is_plain = pass.shading == ToonPass::Shading::kPlain, has_bands = pass.bands > 1;
  const bool from_albedo = pass.base == ToonPass::Color::kAlbedo && pass.shading != ToonPass::Shading::kRamp;
  const float per_band = has_bands ? 1.0f / static_cast<float>(pass.bands - 1) : 0.0f;
  std::array<const float*, 3> albedo{};
  if (from_albedo) {
    for (int c = 0; c < 3; ++c) albedo[std::size_t(c)] = frame.guides->Plane(Layer::kAlbedo, c).data();
  }
  return [=](std::size_t first, std::size_t count, OklabBlock& block) {
    if (from_albedo) OklabFromPlanes({albedo[0] + first, albedo[1] + first, albedo[2] + first}, count, block);
    float light[kOklabBlock];
    if (has_bands) {
      band_of.At(first, count, light);
      for (std::size_t i = 0; i < count; ++i) light[i] *= per_band;
    } else if (is_plain) {
      std::fill_n(light, count, 1.0f);
    } else {
      band_of.Tones(first, count, light);
    }
    shading.Apply(light, first, count, block);
  };
}

}  // namespace

PointEffect MakeToon(const ToonPass& pass, const FinishFrame& frame, std::span<const float> light) {
  switch (pass.shading) {
    case ToonPass::Shading::kGooch:
      return ToonOf(pass, frame, light, GoochShading(pass));
    case ToonPass::Shading::kRamp:
      return ToonOf(pass, frame, light, RampShading(pass, frame));
    case ToonPass::Shading::kPlain:
      break;
  }
  return ToonOf(pass, frame, light, PlainShading(pass));
}

}  // namespace scumble::internal
