#include "transfer/variety.h"

#include <algorithm>
#include <cmath>

#include "image/hash.h"

namespace scumble::internal {
namespace {

constexpr float kFlatCosine = 0.99996192f;  // half a degree
constexpr int kTries = 24;                  // the box around the cone is at most twice its area where the sphere faces us

}  // namespace

bool IsFlat(const MatchInput& input, PixelPosition at, int reach) {
  const GuideSet& guides = input.guides;
  const auto object = guides.Plane(Layer::kObject);
  const std::size_t here = guides.Index(at.x, at.y);
  const glm::vec3 normal = guides.Vec3(Layer::kNormal, here);
  const int steps[4][2] = {{-reach, 0}, {reach, 0}, {0, -reach}, {0, reach}};
  for (const auto& [dx, dy] : steps) {
    const int x = at.x + dx, y = at.y + dy;
    if (x < 0 || y < 0 || x >= guides.width() || y >= guides.height()) continue;
    const std::size_t there = guides.Index(x, y);
    if (!input.active[there] || object[there] != object[here]) return false;
    const glm::vec3 other = guides.Vec3(Layer::kNormal, there);
    if (!(normal.x * other.x + normal.y * other.y + normal.z * other.z > kFlatCosine)) return false;
  }
  return true;
}

Source ChooseAlike(const MatchInput& input, Source own, std::uint64_t hash) {
  if (!(input.variety_degrees > 0.0)) return own;
  const PreparedExemplar& exemplar = input.exemplar;
  const double radians = input.variety_degrees * (3.14159265358979323846 / 180.0);
  const float cosine = static_cast<float>(std::cos(radians));
  const int reach = std::max(1, static_cast<int>(std::ceil(0.5 * exemplar.size() * std::sin(std::min(radians, 1.57)))));
  const glm::vec3 normal = exemplar.Normal(own.x, own.y);
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const std::uint64_t a = Mix64(hash + 2 * attempt), b = Mix64(hash + 2 * attempt + 1);
    const int side = 2 * reach + 1;
    const Source source{own.x - reach + static_cast<int>(a % static_cast<std::uint64_t>(side)),
                        own.y - reach + static_cast<int>(b % static_cast<std::uint64_t>(side))};
    if (!exemplar.Usable(source.x, source.y)) continue;
    const glm::vec3 other = exemplar.Normal(source.x, source.y);
    if (normal.x * other.x + normal.y * other.y + normal.z * other.z >= cosine) return source;
  }
  return own;
}

}  // namespace scumble::internal
