#include "measure/repetition.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/image/check.h"
#include "core/image/color.h"
#include "core/image/oklab.h"

namespace scumble {
namespace {

constexpr float kSmoothCosine = 0.9659258f;  // 15 degrees

glm::vec3 LabAt(const Picture& picture, int x, int y) {
  const std::uint16_t* pixel = picture.At(x, y);
  return OklabFromLinear({Srgb16ToLinear(pixel[0]), Srgb16ToLinear(pixel[1]), Srgb16ToLinear(pixel[2])});
}

std::uint8_t ExemplarAt(const SourcePlanes& planes, std::size_t i) {
  return planes.exemplar.empty() ? std::uint8_t{0} : planes.exemplar[i];
}

bool SameChunk(const SourcePlanes& planes, std::size_t a, std::size_t b, int dx, int dy) {
  return planes.source_x[b] - planes.source_x[a] == dx && planes.source_y[b] - planes.source_y[a] == dy &&
         ExemplarAt(planes, a) == ExemplarAt(planes, b);
}

}  // namespace

double SourceRepetition(const SourcePlanes& planes) {
  std::vector<std::uint64_t> sources;
  for (std::size_t i = 0; i < planes.covered.size(); ++i) {
    if (!planes.covered[i]) continue;
    sources.push_back(std::uint64_t(ExemplarAt(planes, i)) << 32 |
                      std::uint64_t(std::uint16_t(planes.source_y[i])) << 16 | std::uint16_t(planes.source_x[i]));
  }
  const double covered = static_cast<double>(sources.size());
  std::sort(sources.begin(), sources.end());
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
  return sources.empty() ? 0.0 : covered / static_cast<double>(sources.size());
}

SeamStrength MeasureSeams(const Picture& picture, const SourcePlanes& planes, const GuideSet& guides) {
  SCUMBLE_CHECK(picture.width == planes.width && picture.height == planes.height);
  SCUMBLE_CHECK(guides.width() == planes.width && guides.height() == planes.height);
  const std::span<const float> object =
      guides.Has(Layer::kObject) ? guides.Plane(Layer::kObject) : std::span<const float>();
  double across = 0.0, within = 0.0;
  SeamStrength seams;
  const auto add = [&](int x, int y, int dx, int dy) {
    if (x + dx >= planes.width || y + dy >= planes.height) return;
    const std::size_t a = std::size_t(y) * planes.width + x, b = a + std::size_t(dy) * planes.width + std::size_t(dx);
    if (!planes.covered[a] || !planes.covered[b]) return;
    if (!object.empty() && object[a] != object[b]) return;
    if (!(glm::dot(guides.Vec3(Layer::kNormal, a), guides.Vec3(Layer::kNormal, b)) > kSmoothCosine)) return;
    const glm::vec3 d = LabAt(picture, x, y) - LabAt(picture, x + dx, y + dy);
    const double length = std::sqrt(double(d.x) * d.x + double(d.y) * d.y + double(d.z) * d.z);
    if (SameChunk(planes, a, b, dx, dy))
      within += length, ++seams.inside_pairs;
    else
      across += length, ++seams.border_pairs;
  };
  for (int y = 0; y < planes.height; ++y) {
    for (int x = 0; x < planes.width; ++x) add(x, y, 1, 0), add(x, y, 0, 1);
  }
  if (seams.border_pairs > 0) seams.along_borders = across / static_cast<double>(seams.border_pairs);
  if (seams.inside_pairs > 0) seams.inside = within / static_cast<double>(seams.inside_pairs);
  if (seams.border_pairs > 0 && seams.inside > 0.0) seams.excess = seams.along_borders / seams.inside - 1.0;
  return seams;
}

}  // namespace scumble
