#include "pipeline/style/kit_template.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <utility>

#include "core/image/direction.h"
#include "core/io/guide_file.h"
#include "core/style/sphere_kit.h"
#include "guidegen/guidegen.h"

namespace scumble {
namespace {

// A light that lies on a matt sphere as n · l, by least squares over what is lit.
std::optional<KitLight> LightOf(GuideSet guides) {
  constexpr float kLit = 0.05f;
  const auto luminance = guides.Plane(Layer::kLuminance);
  glm::dmat3 normals(0.0);
  glm::dvec3 right(0.0);
  for (std::size_t i = 0; i < luminance.size(); ++i) {
    if (!(luminance[i] > kLit)) continue;
    const glm::dvec3 normal(guides.Vec3(Layer::kNormal, i));
    normals += glm::outerProduct(normal, normal);
    right += normal * double(luminance[i]);
  }
  if (!(std::fabs(glm::determinant(normals)) > 1e-9)) return std::nullopt;
  const glm::dvec3 light = glm::normalize(glm::inverse(normals) * right);
  return KitLight{glm::degrees(std::atan2(light.x, light.z)), glm::degrees(std::asin(std::clamp(light.y, -1.0, 1.0))),
                  std::move(guides)};
}

Expected<std::optional<KitLight>> LightFor(const Exemplar& exemplar, int threads) {
  if (exemplar.guides_file.empty()) {
    SphereOptions options;
    options.size = exemplar.picture.width;
    options.layers = {Layer::kLuminance};
    options.aa = 4;
    options.threads = threads;
    SCUMBLE_ASSIGN(GuidegenResult rendered, RenderSphereGuides(options));
    return std::optional(KitLight{options.light_azimuth, options.light_elevation, std::move(rendered.guides)});
  }
  GuideReadOptions options;
  options.required = {Layer::kCoverage, Layer::kNormal};
  options.optional = {Layer::kLuminance};
  SCUMBLE_ASSIGN(GuideSet guides, ReadGuides(exemplar.guides_file, options));
  if (!guides.Has(Layer::kLuminance)) return std::optional<KitLight>();
  return LightOf(std::move(guides));
}

}  // namespace

Expected<std::optional<BareTemplates>> FindBareTemplates(const Exemplar& exemplar, int threads) {
  constexpr int kSmallest = 16;
  const int size = exemplar.picture.width;
  if (!exemplar.is_sphere || size < kSmallest) return std::optional<BareTemplates>();
  SCUMBLE_ASSIGN(const std::optional<KitLight> light, LightFor(exemplar, threads));
  if (!light || light->guides.width() != size) return std::optional<BareTemplates>();
  const Picture drawn = DrawTemplate(*light);
  const int margin = (drawn.width - size) / 2;
  const Picture lit = DrawLitSphere(*light);
  BareTemplates bare{Picture(size, size), Picture(size, size)};
  for (int y = 0; y < size; ++y) {
    std::copy_n(drawn.At(margin, y + margin), 4 * std::size_t(size), bare.drawn.At(0, y));
    for (int x = 0; x < size; ++x) {
      std::uint16_t* texel = bare.printed.At(x, y);
      std::fill_n(texel, 3, static_cast<std::uint16_t>(65535.0 * PaleGrey(lit.At(x + margin, y + margin)) + 0.5));
      texel[3] = 65535;
    }
  }
  return std::optional(std::move(bare));
}

}  // namespace scumble
