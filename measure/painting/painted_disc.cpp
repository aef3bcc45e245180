#include "measure/painting/painted_disc.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "core/image/check.h"
#include "core/image/color.h"
#include "core/image/oklab.h"
#include "core/painting/circle_fit.h"

namespace scumble {
namespace {

glm::vec3 LinearOf(const std::uint16_t* texel) {
  return {Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])};
}

// The pixel that lies so far from the middle in a direction.
struct Ray {
  glm::dvec2 direction;
  glm::dvec2 At(double middle, double distance) const { return glm::dvec2(middle) + distance * direction; }
};

// Whether ground lies between the usable rim and paint of a clearly different colour.
bool HasFringe(const PaintOnGround& paint, const Ray& ray) {
  const PaintSheet& sheet = paint.sheet();
  const double middle = 0.5 * sheet.width(), usable = middle - std::max(1.0, sheet.rim());
  const double least = std::max(1.0, 0.004 * middle), widest = 0.1 * middle, beside = std::max(2.0, 0.03 * middle);
  constexpr float kOtherColour = 0.15f;  // in Oklab
  // If the rim leaves almost none of the sphere, there is no room for a fringe.
  if (!(usable > widest + beside + 2.0)) return false;
  const auto pixel_at = [&](double depth) {
    return glm::clamp(glm::ivec2(ray.At(middle, usable - depth)), 0, sheet.width() - 1);
  };
  double width = 0.0;
  while (width <= widest && !paint.IsPaint(pixel_at(width).x, pixel_at(width).y)) width += 0.5;
  if (width < least || width > widest) return false;
  if (paint.ground().kind == BarePaper::Kind::kTransparent) return true;
  glm::vec3 sum(0.0f);
  float count = 0.0f;
  for (double depth = width + 1.0; depth < width + 1.0 + beside; depth += 1.0, count += 1.0f) {
    const glm::ivec2 at = pixel_at(depth);
    sum += LinearOf(sheet.picture().At(at.x, at.y));
  }
  return glm::length(OklabFromLinear(sum / count) - OklabFromLinear(paint.ground().color)) >= kOtherColour;
}

}  // namespace

PaintOnGround::PaintOnGround(const PaintSheet& sheet) : sheet_(sheet), mask_(sheet.picture()) {
  SCUMBLE_CHECK(sheet.is_sphere());
}

PaintedDisc FindPaintedDisc(const PaintOnGround& paint) {
  if (!paint.known()) return {};
  constexpr double kLeastOutline = 0.5;
  const int width = paint.sheet().width();
  const double size = width, tolerance = std::max(1.0, 0.004 * size);
  const std::vector<glm::dvec2> points = PaintOutline(paint.mask(), width, width, glm::dvec2(0.5 * size));
  if (static_cast<double>(points.size()) < kLeastOutline * kOutlineDirections) return {};
  const auto fit = FitCircle(points, tolerance, 0.1 * size, size);
  if (!fit) return {};
  const double outline = static_cast<double>(fit->agree) / kOutlineDirections;
  if (outline < kLeastOutline) return {};
  return {true, fit->circle.x, fit->circle.y, fit->circle.radius, outline};
}

double FringeOfRim(const PaintOnGround& paint) {
  if (!paint.known()) return 0.0;
  std::vector<bool> fringed;
  for (int i = 0; i < kOutlineDirections; ++i) fringed.push_back(HasFringe(paint, {OutlineDirection(i)}));
  // Gaps between strokes are no fringe: a fringe is at least 5 degrees long.
  constexpr int kLeastRun = kOutlineDirections * 5 / 360;
  int share = 0;
  for (int i = 0; i < kOutlineDirections; ++i) {
    bool in_run = false;
    for (int start = i - kLeastRun + 1; start <= i && !in_run; ++start) {
      in_run = true;
      for (int k = start; k < start + kLeastRun && in_run; ++k) {
        in_run = fringed[std::size_t((k + kOutlineDirections) % kOutlineDirections)];
      }
    }
    share += in_run;
  }
  return static_cast<double>(share) / kOutlineDirections;
}

Patches BareShade(const PaintOnGround& paint, const glm::vec3& light) {
  const PaintSheet& sheet = paint.sheet();
  if (paint.ground().kind != BarePaper::Kind::kPaper) return {};
  const int size = sheet.width();
  const double inner = 0.9 * 0.5 * size;
  std::vector<std::uint8_t> bare(paint.mask().size(), 0);
  std::size_t lighter = 0, painted = 0;
  const float ground = OklabFromLinear(paint.ground().color).x;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (!sheet.Usable(x, y)) continue;
      if (paint.IsPaint(x, y)) {
        ++painted;
        lighter += OklabFromLinear(LinearOf(sheet.picture().At(x, y))).x > ground;
        continue;
      }
      if (std::hypot(x + 0.5 - 0.5 * size, y + 0.5 - 0.5 * size) > inner) continue;
      bare[sheet.Index(x, y)] = glm::dot(sheet.Normal(x, y), light) < 0.0f;
    }
  }
  if (4 * lighter > painted) return {};
  const int reach = std::max(1, static_cast<int>(std::lround(0.015 * size)));
  return FindPatches(MostlySet(bare, size, size, reach, 1.0), size, size);
}

}  // namespace scumble
