#include "core/io/guides/normal_space.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numeric>
#include <vector>

namespace scumble::internal {

// A plane has n · P = c, and P = Z · (x, y, -1) for a perspective view, x to the right and y up in the picture: so
// 1 / Z = n · (x, y, -1) / c. Its slope is (n.x, n.y) / c, and c < 0 as the plane faces the eye. Of an orthographic
// view the slope of Z is (n.x, n.y) / n.z. Either way depth grows along (n.x, n.y).
double NormalsAgainstDepth(const GuideSet& guides) {
  constexpr std::size_t kEnoughPixels = 50;
  constexpr int kApart = 3;  // rows and columns of the pixels that are looked at
  // Across the view, of a unit normal, and of the surface by its depth: the tangent of its slant, at about a radian of
  // view. What faces the eye and has bumps by its normals alone tells nothing.
  constexpr double kSlanted = 0.3;
  constexpr double kMostBend = 0.2;      // of the slope
  constexpr double kMostOfDepth = 0.05;  // two neighbours are of one surface
  const auto depth = guides.Plane(Layer::kDepth), coverage = guides.Plane(Layer::kCoverage);
  const auto object = guides.Plane(Layer::kObject);
  std::vector<double> turned;
  for (int y = 1; y + 1 < guides.height(); y += kApart) {
    for (int x = 1; x + 1 < guides.width(); x += kApart) {
      const std::size_t i = guides.Index(x, y), left = i - 1, right = i + 1,
                        up = i - static_cast<std::size_t>(guides.width()),
                        down = i + static_cast<std::size_t>(guides.width());
      const double here = depth[i];
      const auto is_beside = [&](std::size_t j) {
        return coverage[j] >= 1.0f && object[j] == object[i] && std::fabs(depth[j] - here) < kMostOfDepth * here;
      };
      if (!(coverage[i] >= 1.0f) || !is_beside(left) || !is_beside(right) || !is_beside(up) || !is_beside(down))
        continue;
      const glm::dvec3 normal(guides.Vec3(Layer::kNormal, i));
      const double rise_x = 1.0 / depth[left] - 1.0 / depth[right], rise_y = 1.0 / depth[down] - 1.0 / depth[up];
      const double across = std::hypot(normal.x, normal.y), rise = std::hypot(rise_x, rise_y);
      // Where it is a plane nearly, 1 / Z has no bend. Blades of grass beside each other have, and noise.
      const double bend_x = 1.0 / depth[left] + 1.0 / depth[right] - 2.0 / here,
                   bend_y = 1.0 / depth[up] + 1.0 / depth[down] - 2.0 / here;
      if (std::hypot(bend_x, bend_y) > kMostBend * rise) continue;
      if (!(across > kSlanted) || !(rise * here * guides.width() > 2.0 * kSlanted)) continue;
      const double cosine = (normal.x * rise_x + normal.y * rise_y) / (across * rise);
      turned.push_back(glm::degrees(std::acos(std::clamp(cosine, -1.0, 1.0))));
    }
  }
  if (turned.size() < kEnoughPixels) return -1.0;
  return std::accumulate(turned.begin(), turned.end(), 0.0) / static_cast<double>(turned.size());
}

// As above: n.z has the sign of 1 / Z - (x, y) · its slope, what the plane has at the picture's centre. Of an
// orthographic view that may be negative, but n.z is positive everywhere.
double ShareTurnedAway(const GuideSet& guides) {
  constexpr std::size_t kEnoughPixels = 50;
  constexpr int kApart = 3;
  constexpr double kClearly = 0.25;  // of 1 / Z
  constexpr float kFacing = 0.9f;    // without depth: views of 128 degrees and less see no normal beyond -0.9
  const auto coverage = guides.Plane(Layer::kCoverage), z = guides.Plane(Layer::kNormal, 2);
  const auto depth = guides.Has(Layer::kDepth) ? guides.Plane(Layer::kDepth) : std::span<const float>();
  std::size_t towards = 0, away = 0;
  for (int y = 1; y + 1 < guides.height(); y += kApart) {
    for (int x = 1; x + 1 < guides.width(); x += kApart) {
      const std::size_t i = guides.Index(x, y), width = static_cast<std::size_t>(guides.width());
      if (!(coverage[i] >= 1.0f)) continue;
      if (!depth.empty()) {
        const double here = 1.0 / depth[i];
        const double slope_x = 0.5 / depth[i + 1] - 0.5 / depth[i - 1],
                     slope_y = 0.5 / depth[i + width] - 0.5 / depth[i - width];
        const double at_centre =
            here + slope_x * (0.5 * guides.width() - x - 0.5) + slope_y * (0.5 * guides.height() - y - 0.5);
        if (!(at_centre > kClearly * here)) continue;
      } else if (!(std::fabs(z[i]) > kFacing)) {
        continue;
      }
      ++(z[i] < 0.0f ? away : towards);
    }
  }
  const std::size_t all = towards + away;
  return all < kEnoughPixels ? 0.0 : static_cast<double>(away) / static_cast<double>(all);
}

Status CheckNormalSpace(const GuideSet& guides, const std::string& name) {
  constexpr double kMostDegrees = 30.0;
  constexpr double kMostAway = 0.9;  // some back faces are none the less seen
  if (guides.Has(Layer::kCoverage) && guides.Has(Layer::kNormal) && ShareTurnedAway(guides) > kMostAway) {
    return InputError(name +
                      ": its normals point away from the eye: expected normals in view space, x to the right, y up "
                      "and z towards the eye; some renderers, such as RenderMan, let z grow into the picture: write "
                      "normals with z negated");
  }
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) {
    if (!guides.Has(layer)) return Ok();
  }
  const double degrees = NormalsAgainstDepth(guides);
  if (degrees <= kMostDegrees) return Ok();
  return InputError(name + ": its normals do not fit its depth, and are turned away from it by " +
                    std::to_string(std::lround(degrees)) +
                    " degrees: expected normals in view space, x to the right, y up and z towards the eye, and depth " +
                    "that grows with the distance; these normals may be in world space, which renderers often write " +
                    "as N, or this depth inverted: write camera space normals, and Z");
}

}  // namespace scumble::internal
