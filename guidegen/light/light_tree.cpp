#include "guidegen/light/light_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace scumble {
namespace {

constexpr double kLeastCosine = 0.1;

}  // namespace

double SphereWeight(const glm::dvec3& centre, double radius, double power, const SurfacePoint& point) {
  const glm::dvec3 to_centre = centre - point.position;
  if (glm::dot(point.facing, to_centre) < -radius) return 0.0;
  const double square = std::max(glm::dot(to_centre, to_centre), kLeastSquaredDistance);
  const double cosine = (glm::dot(point.normal, to_centre) + radius) / std::sqrt(square);
  return power * std::clamp(cosine, kLeastCosine, 1.0) / std::max(square, radius * radius);
}

double SunWeight(const glm::dvec3& direction, double half_angle, double power, const SurfacePoint& point) {
  // At least the sine: a wide sun is spread over a flat disc.
  const double spread = std::min(std::tan(half_angle), 1.0);
  if (glm::dot(point.facing, direction) < -spread) return 0.0;
  return power * std::clamp(glm::dot(point.normal, direction) + spread, kLeastCosine, 1.0);
}

LightTree::LightTree(std::span<const TreeLight> lights) : order_(lights.size()), path_to_(lights.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  if (!lights.empty()) Build(lights, 0, std::uint32_t(lights.size()), 0, 0);
}

// Halves a leaf that is too large along its longest side. Suns have no place and stay together at one end.
std::uint32_t LightTree::Build(std::span<const TreeLight> lights, std::uint32_t begin, std::uint32_t end,
                               std::uint64_t path, int depth) {
  const std::uint32_t index = std::uint32_t(nodes_.size());
  nodes_.emplace_back();
  Node node;
  const std::span<int> mine(order_.data() + begin, end - begin);
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high(-std::numeric_limits<double>::infinity());
  std::uint32_t suns = 0;
  for (const int light : mine) {
    const TreeLight& one = lights[std::size_t(light)];
    if (!one.is_delta) node.power[0] += one.power;
    node.power[1] += one.power;
    suns += one.is_sun;
    if (one.is_sun) continue;
    low = glm::min(low, one.centre);
    high = glm::max(high, one.centre);
  }
  node.centre = suns > 0 ? glm::dvec3(0.0) : 0.5 * (low + high);
  for (const int light : mine) {
    const TreeLight& one = lights[std::size_t(light)];
    node.radius = std::max(node.radius, suns > 0 ? std::numeric_limits<double>::infinity()
                                                 : glm::length(one.centre - node.centre) + one.radius);
  }
  if (mine.size() <= kLeafSize) {
    node.begin = begin;
    node.count = int(mine.size());
    for (const int light : mine) path_to_[std::size_t(light)] = path;
    nodes_[index] = node;
    return index;
  }
  const glm::dvec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::sort(mine.begin(), mine.end(), [&](int a, int b) {
    const TreeLight& left = lights[std::size_t(a)];
    const TreeLight& right = lights[std::size_t(b)];
    if (left.is_sun != right.is_sun) return left.is_sun;
    if (!left.is_sun && left.centre[axis] != right.centre[axis]) return left.centre[axis] < right.centre[axis];
    return a < b;
  });
  const bool mixed = suns > 0 && suns < mine.size();
  const std::uint32_t middle = begin + (mixed ? suns : std::uint32_t(mine.size() / 2));
  node.child[0] = Build(lights, begin, middle, path, depth + 1);
  node.child[1] = Build(lights, middle, end, path | std::uint64_t(1) << depth, depth + 1);
  nodes_[index] = node;
  return index;
}

double LightTree::NodeWeight(const Node& node, const SurfacePoint& point, bool with_delta) const {
  const double power = node.power[with_delta];
  return std::isinf(node.radius) ? power : SphereWeight(node.centre, node.radius, power, point);
}

double LightTree::FirstShare(const Node& node, const SurfacePoint& point, bool with_delta) const {
  const double first = NodeWeight(nodes_[node.child[0]], point, with_delta);
  const double second = NodeWeight(nodes_[node.child[1]], point, with_delta);
  return first + second > 0.0 ? first / (first + second) : -1.0;
}

bool LightTree::MayMeet(const Node& node, const glm::dvec3& origin, const glm::dvec3& direction) {
  if (std::isinf(node.radius)) return true;
  const glm::dvec3 to_centre = node.centre - origin;
  const double along = glm::dot(to_centre, direction);
  if (along < -node.radius) return false;
  const glm::dvec3 off = to_centre - direction * along;
  return glm::dot(off, off) <= node.radius * node.radius * (1.0 + 1e-9) + kLeastSquaredDistance;
}

}  // namespace scumble
