#include "transfer/tint/colorize.h"

#include <algorithm>
#include <glm/glm.hpp>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "core/image/scalar_lane.h"
#include "transfer/tint/tint_row.h"

namespace scumble::internal {
namespace {

using namespace scalar;
#include "transfer/tint/tint-inl.h"

LaneColor Tinted(const Tint& tint, LaneColor albedo, LaneColor codes) {
  if (tint.mode == ColorizeMode::kMultiply) {
    MultiplyingTint multiplying(tint);
    multiplying.SetAlbedo(albedo);
    return multiplying.Tinted(codes);
  }
  OklabTint oklab(tint);
  oklab.SetAlbedo(albedo);
  return OklabTint::Encoded(oklab.Linear(OklabTint::RootsOfPaint(codes)));
}

}  // namespace

float MeanLightness(const PreparedExemplar& exemplar, int index) {
  double sum = 0.0, weight = 0.0;
  for (int y = 0; y < exemplar.size(); ++y) {
    for (int x = 0; x < exemplar.size(); ++x) {
      if (!exemplar.Usable(x, y)) continue;
      const std::uint16_t* texel = exemplar.picture(index).At(x, y);
      const glm::vec3 paint(Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2]));
      sum += static_cast<double>(texel[3]) * OklabFromLinear(paint).x;
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
  const LaneColor tinted =
      Tinted(*this, {albedo.r, albedo.g, albedo.b}, {float(texel[0]), float(texel[1]), float(texel[2])});
  texel[0] = Rounded(tinted.r), texel[1] = Rounded(tinted.g), texel[2] = Rounded(tinted.b);
}

namespace {

// Calls run(begin, end) for each maximal run of a row's active pixels, counted from `active`.
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
    TintRow(input.tint, albedo, to - from, texels);
  });
}

}  // namespace scumble::internal
