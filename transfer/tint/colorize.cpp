#include "transfer/tint/colorize.h"

#include <algorithm>
#include <glm/glm.hpp>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "transfer/tint/multiply.h"
#include "transfer/tint/oklab.h"

namespace scumble::internal {
namespace {

constexpr float kBrightest = 0.98f;  // of a channel that lighter paint leads to, so that none is clipped

glm::vec3 ToLinear(const std::uint16_t* texel) {
  return {Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])};
}

bool InGamut(glm::vec3 c, float top) {
  constexpr float kSlack = 1e-4f;
  const float low = -kSlack, high = top + kSlack;
  return c.r >= low && c.g >= low && c.b >= low && c.r <= high && c.g <= high && c.b <= high;
}

// How much of a colour's chroma keeps its channels within 0 … top at its lightness.
float ChromaThatFits(glm::vec3 lab, float top) {
  if (InGamut(LinearFromOklab(lab), top)) return 1.0f;
  float inside = 0.0f, outside = 1.0f;
  for (int step = 0; step < 10; ++step) {
    const float middle = 0.5f * (inside + outside);
    (InGamut(LinearFromOklab({lab.x, middle * lab.y, middle * lab.z}), top) ? inside : outside) = middle;
  }
  return inside;
}

glm::vec3 WithChroma(glm::vec3 lab, float factor) { return {lab.x, factor * lab.y, factor * lab.z}; }

// What a paint of lightness `own` becomes on an albedo, whose largest channel is `brightest`.
glm::vec3 Target(glm::vec3 scene, float brightest, float own, float reference) {
  constexpr float kLeast = 1e-6f;
  if (own <= reference) return scene * (own / std::max(reference, kLeast));
  const float room = std::max(1.0f - std::min(reference, scene.x), kLeast);
  const float rise = std::min((own - reference) / room, 1.0f);
  const glm::vec3 lighter = WithChroma({scene.x + rise * (1.0f - scene.x), scene.y, scene.z}, 1.0f - rise * rise);
  return WithChroma(lighter, ChromaThatFits(lighter, std::max(kBrightest, brightest)));
}

glm::vec3 TintInOklab(glm::vec3 paint, glm::vec3 albedo, float reference, float weight) {
  const glm::vec3 base = glm::clamp(albedo, 0.0f, 1.0f);
  const glm::vec3 own = OklabFromLinear(paint), scene = OklabFromLinear(base);
  const float brightest = std::max({base.r, base.g, base.b});
  const glm::vec3 mixed = own + (Target(scene, brightest, own.x, reference) - own) * weight;
  return LinearFromOklab(WithChroma(mixed, ChromaThatFits(mixed, 1.0f)));
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

float ReferenceLightness(const PreparedExemplar& exemplar) {
  float reference = 0.0f;
  for (int k = 0; k < exemplar.count(); ++k) reference = std::max(reference, MeanLightness(exemplar, k));
  return reference;
}

void Tint::Apply(glm::vec3 albedo, std::uint16_t* texel) const {
  const glm::vec3 paint = ToLinear(texel);
  const glm::vec3 tinted = mode == ColorizeMode::kMultiply ? paint * ((1.0f - weight) + weight * albedo)
                                                           : TintInOklab(paint, albedo, reference_lightness, weight);
  for (int c = 0; c < 3; ++c) texel[c] = Srgb16FromLinear(tinted[c]);
}

namespace {

// Calls run(begin, end) for each longest stretch of a row's pixels that are active, counted from `active`.
template <class Run>
void ForEachRun(std::span<const std::uint8_t> active, const Run& run) {
  const std::uint8_t *begin = active.data(), *end = begin + active.size();
  while ((begin = std::find(begin, end, 1)) != end) {
    const std::uint8_t* stop = std::find(begin, end, 0);
    run(static_cast<std::size_t>(begin - active.data()), static_cast<std::size_t>(stop - active.data()));
    begin = stop;
  }
}

}  // namespace

void ColorizeRow(const ColorizeInput& input, int y, int x0, int x1, Picture& picture) {
  if (x1 <= x0) return;
  const std::size_t row = input.guides.Index(x0, y);
  const std::size_t begin = input.guides.Index(x0, y - input.first_row);
  ForEachRun(input.active.subspan(begin, std::size_t(x1 - x0)), [&](std::size_t from, std::size_t to) {
    const float* albedo[3];
    for (int c = 0; c < 3; ++c) albedo[c] = input.guides.Plane(Layer::kAlbedo, c).data() + row + from;
    std::uint16_t* texels = picture.At(x0, y) + 4 * from;
    if (input.tint.mode == ColorizeMode::kMultiply) return MultiplyTint(albedo, to - from, input.tint.weight, texels);
    OklabTint(albedo, to - from, input.tint, texels);
  });
}

}  // namespace scumble::internal
