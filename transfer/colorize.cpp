#include "transfer/colorize.h"

#include <algorithm>
#include <glm/glm.hpp>

#include "image/color.h"
#include "image/oklab.h"

namespace scumble::internal {
namespace {

glm::vec3 ToLinear(const std::uint16_t* texel) {
  return {Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])};
}

bool InGamut(glm::vec3 c) {
  constexpr float kSlack = 1e-4f;
  return c.r >= -kSlack && c.g >= -kSlack && c.b >= -kSlack && c.r <= 1.0f + kSlack && c.g <= 1.0f + kSlack &&
         c.b <= 1.0f + kSlack;
}

// The colour itself, or the same lightness and hue with as much chroma as the gamut has.
glm::vec3 FitGamut(glm::vec3 lab) {
  const glm::vec3 whole = LinearFromOklab(lab);
  if (InGamut(whole)) return whole;
  float inside = 0.0f, outside = 1.0f;
  for (int step = 0; step < 10; ++step) {
    const float middle = 0.5f * (inside + outside);
    (InGamut(LinearFromOklab({lab.x, middle * lab.y, middle * lab.z})) ? inside : outside) = middle;
  }
  return LinearFromOklab({lab.x, inside * lab.y, inside * lab.z});
}

glm::vec3 TintInOklab(glm::vec3 paint, glm::vec3 albedo, float mean_lightness, float weight) {
  constexpr float kBlack = 1e-3f, kMostChroma = 1.5f;
  const glm::vec3 own = OklabFromLinear(paint), scene = OklabFromLinear(glm::clamp(albedo, 0.0f, 1.0f));
  const float lightness = std::clamp(scene.x + (own.x - mean_lightness), 0.0f, 1.0f);
  // Chroma in proportion to lightness, as light itself does it; a dark colour made light must not begin to glow.
  const float chroma = std::min(lightness / std::max(scene.x, kBlack), kMostChroma);
  const glm::vec3 target(lightness, scene.y * chroma, scene.z * chroma);
  return FitGamut(own + (target - own) * weight);
}

}  // namespace

float MeanLightness(const PreparedExemplar& exemplar, int index) {
  double sum = 0.0, weight = 0.0;
  for (int y = 0; y < exemplar.size(); ++y) {
    for (int x = 0; x < exemplar.size(); ++x) {
      if (!exemplar.Usable(x, y)) continue;
      const std::uint16_t* texel = exemplar.picture(index).At(x, y);
      sum += static_cast<double>(texel[3]) * OklabFromLinear(ToLinear(texel)).x;
      weight += texel[3];
    }
  }
  return weight > 0.0 ? static_cast<float>(sum / weight) : 0.0f;
}

void Tint::Apply(glm::vec3 albedo, int exemplar, std::uint16_t* texel) const {
  const glm::vec3 paint = ToLinear(texel);
  const glm::vec3 tinted = mode == ColorizeMode::kMultiply
                               ? paint * ((1.0f - weight) + weight * albedo)
                               : TintInOklab(paint, albedo, mean_lightness[std::size_t(exemplar)], weight);
  for (int c = 0; c < 3; ++c) texel[c] = Srgb16FromLinear(tinted[c]);
}

bool Colorize(const ColorizeInput& input, Picture& picture, RowProgress& progress) {
  return ForEachRow(input.region, progress, [&](int y) {
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      const std::size_t i = std::size_t(y) * input.width + x;
      if (!input.active[i]) continue;
      input.tint.Apply(input.guides.Vec3(Layer::kAlbedo, i), input.exemplar[i], picture.At(x, y));
    }
  });
}

}  // namespace scumble::internal
