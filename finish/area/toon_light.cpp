#include <algorithm>
#include <span>
#include <vector>

#include "core/filter/wide_loops.h"
#include "finish/area/area_effects.h"
#include "finish/area/even_light.h"
#include "finish/area/oklab_blocks.h"
#include "finish/tone/toon_bands.h"

namespace scumble::internal {
namespace {

// NaN is dark, and no shadow.
inline float WrappedLightOf(float cosine, float shadow, float cast, bool squares) {
  const float turned = cosine > -1.0f ? cosine < 1.0f ? cosine : 1.0f : -1.0f;
  const float blocked = shadow > 0.0f ? shadow < 1.0f ? shadow : 1.0f : 0.0f;
  const float lit = turned > 0.0f ? turned * (1.0f - cast * blocked) : turned;
  const float half = 0.5f + 0.5f * lit;
  return squares ? half * half : half;
}

// Light that wraps around the form: ((1 + c) / 2)^power with c the cosine to the key light (Half-Lambert: Mitchell,
// Francke, Eng, "Illustrative rendering in Team Fortress 2", 2007). Where c is above 0, cast shadow takes of it first.
// `shadows`: null where there are none.
SCUMBLE_WIDE_LOOPS void WrapLights(const float* cosines, const float* shadows, float cast, bool squares,
                                   std::size_t count, float* out) {
  if (!shadows) {
    for (std::size_t i = 0; i < count; ++i) out[i] = WrappedLightOf(cosines[i], 0.0f, cast, squares);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) out[i] = WrappedLightOf(cosines[i], shadows[i], cast, squares);
}

// Light in which bands are evenly apart, made of light in which they begin at these shares of the brightest.
void EvenOutBands(const std::vector<double>& thresholds, float brightest, FloatPlane& light) {
  std::vector<float> from{0.0f};
  for (const double one : thresholds) from.push_back(static_cast<float>(one) * brightest);
  from.push_back(brightest);
  const float to = brightest / static_cast<float>(from.size() - 1);
  ForEachOklabBlock(light.size(), [&](std::size_t first, std::size_t count) {
    for (float& one : std::span(light).subspan(first, count)) {
      if (!(one > 0.0f) || !(one < brightest)) continue;
      std::size_t band = 0;
      while (one >= from[band + 1]) ++band;
      one = to * (static_cast<float>(band) + (one - from[band]) / (from[band + 1] - from[band]));
    }
  });
}

FloatPlane LightOf(const ToonPass& pass, const FinishFrame& frame) {
  if (pass.bands == 1 && pass.shading == ToonPass::Shading::kPlain) return {};
  const GuideSet& guides = *frame.guides;
  FloatPlane light(guides.pixel_count());
  const bool is_wrapped = pass.light == ToonPass::Light::kWrapped, has_cast = is_wrapped && pass.cast > 0.0;
  if (is_wrapped) {
    const float* const cosines = guides.Plane(Layer::kCosine).data();
    const float* const shadows = has_cast ? guides.Plane(Layer::kShadow).data() : nullptr;
    ForEachOklabBlock(light.size(), [&](std::size_t first, std::size_t count) {
      WrapLights(cosines + first, shadows ? shadows + first : nullptr, static_cast<float>(pass.cast),
                 pass.wrap_power == 2, count, light.data() + first);
    });
  } else {
    const auto direct = guides.Plane(Layer::kLuminance);
    std::copy(direct.begin(), direct.end(), light.begin());
  }
  const bool takes_chance = (!is_wrapped || has_cast) && !HasExactLight(guides);
  if (pass.bands == 1 || !takes_chance) return light;
  return EvenedLight(light, LitSurfaceOf(guides), guides.width(), guides.height(),
                     LightNoiseOf(guides) * static_cast<float>(BrightestOf(pass, frame)), frame.Apart());
}

}  // namespace

FloatPlane ToonLight(const ToonPass& pass, const FinishFrame& frame) {
  FloatPlane light = LightOf(pass, frame);
  if (!pass.thresholds.empty()) EvenOutBands(pass.thresholds, static_cast<float>(BrightestOf(pass, frame)), light);
  return light;
}

}  // namespace scumble::internal
