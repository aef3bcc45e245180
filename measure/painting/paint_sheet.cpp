#include "measure/painting/paint_sheet.h"

#include <algorithm>
#include <cmath>

#include "core/image/check.h"
#include "core/image/color.h"
#include "core/painting/soft_edge.h"

namespace scumble {
namespace {

// CIE 15: L* = 116 f(Y) - 16, Y relative to white.
float Lightness(float luminance) {
  constexpr float kEpsilon = 216.0f / 24389.0f, kKappa = 24389.0f / 27.0f;
  return luminance > kEpsilon ? 116.0f * std::cbrt(luminance) - 16.0f : kKappa * luminance;
}

}  // namespace

PaintSheet::PaintSheet(const Exemplar& exemplar, double rim) : exemplar_(exemplar), rim_(rim) {
  const Picture& paint = exemplar.picture;
  SCUMBLE_CHECK(!paint.empty());
  SCUMBLE_CHECK(exemplar.is_sphere ? paint.width == paint.height : exemplar.guides.has_value());
  const std::size_t count = std::size_t(paint.width) * paint.height;
  usable_.resize(count);
  lightness_.resize(count);
  if (exemplar.is_sphere) soft_edge_ = SoftEdge(paint);
  const double radius = 0.5 * paint.width, limit = radius - this->rim();
  for (int y = 0; y < paint.height; ++y) {
    for (int x = 0; x < paint.width; ++x) {
      const std::size_t i = Index(x, y);
      usable_[i] = exemplar.is_sphere ? std::hypot(x + 0.5 - radius, y + 0.5 - radius) <= limit
                                      : exemplar.guides->Plane(Layer::kCoverage)[i] > 0.0f;
      usable_pixels_ += usable_[i];
      const std::uint16_t* texel = paint.At(x, y);
      float luminance = Luminance(Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2]));
      if (texel[3] < 65535 && Shows(x, y))
        luminance = 1.0f + (luminance - 1.0f) * (static_cast<float>(texel[3]) / 65535.0f);
      lightness_[i] = Lightness(luminance);
    }
  }
}

glm::vec3 PaintSheet::Normal(int x, int y) const {
  if (!is_sphere()) return exemplar_.guides->Vec3(Layer::kNormal, Index(x, y));
  const float radius = 0.5f * static_cast<float>(width());
  const float nx = (static_cast<float>(x) + 0.5f) / radius - 1.0f, ny = 1.0f - (static_cast<float>(y) + 0.5f) / radius;
  return {nx, ny, std::sqrt(std::fmax(0.0f, 1.0f - nx * nx - ny * ny))};
}

}  // namespace scumble
