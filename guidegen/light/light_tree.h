// Lights in a binary tree, so that choosing one of many costs their number's logarithm.
//
// After Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG 2018, without its
// splitting. Going down, the side that may light the receiver more is taken more often. The few lights of a leaf are
// weighted individually, and a scene with few lights is a single leaf.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "guidegen/surface/surface.h"

namespace scumble {

// Smaller squared distances are lights inside the surface.
inline constexpr double kLeastSquaredDistance = 1e-30;

// A light that was chosen for sampling.
struct LightChoice {
  int light = -1;  // −1: none can reach the point
  double probability = 0.0;
  // The remainder of the random number that chose, rescaled to [0, 1). It samples a point of the light, so that the
  // points on each light are as evenly distributed as the numbers.
  double remainder = 0.0;
};

// A light in the tree: a bounding sphere, or a sun, which is equally strong everywhere.
struct TreeLight {
  glm::dvec3 centre{0.0};
  double radius = 0.0;  // of suns half the angle, in radians
  double power = 0.0;   // over the squared distance: about the irradiance; of suns the irradiance itself
  bool is_sun = false;
  bool is_delta = false;
};

// The approximate irradiance that lights of this power inside a sphere can bring to a point. 0 only if none of them can
// rise above its horizon. The cosine counts as 0.1 at least, because highlights do not follow it.
double SphereWeight(const glm::dvec3& centre, double radius, double power, const SurfacePoint& point);
// SphereWeight's counterpart for light from one direction.
double SunWeight(const glm::dvec3& direction, double half_angle, double power, const SurfacePoint& point);

// Whether a light fills so much of the hemisphere that directions of a wide lobe should sample it too. For a smaller
// light, all points on it contribute about equally, and such directions would be wasted. `distance`: up to how many of
// its radii a light is wide.
inline constexpr double kWideDistance = 4.0;
inline bool IsWide(const TreeLight& light, const glm::dvec3& point, double distance = kWideDistance) {
  if (light.is_delta) return false;
  if (light.is_sun) return light.radius * distance > 1.0;
  const glm::dvec3 to_centre = light.centre - point;
  return glm::dot(to_centre, to_centre) < distance * distance * light.radius * light.radius;
}

// Immutable once built; free to use from any thread.
class LightTree {
 public:
  LightTree() = default;
  explicit LightTree(std::span<const TreeLight> lights);

  // A random light, u in [0, 1). `weight(light)` is the approximate irradiance of a light in a leaf, 0 where it brings
  // none. `with_delta` says whether lights without extent take part.
  template <class Weight>
  LightChoice Choose(const SurfacePoint& point, double u, bool with_delta, const Weight& weight) const {
    LightChoice choice;
    if (nodes_.empty()) return choice;
    double probability = 1.0;
    const Node* node = &nodes_[0];
    while (node->count == 0) {
      const double first = FirstShare(*node, point, with_delta);
      if (!(first >= 0.0)) return choice;
      const bool second = u >= first;
      const double share = second ? 1.0 - first : first;
      u = std::min((second ? u - first : u) / share, kBelowOne);
      probability *= share;
      node = &nodes_[node->child[second]];
    }
    std::array<double, kLeafSize> weights;
    double total = 0.0;
    for (int i = 0; i < node->count; ++i) total += weights[i] = weight(order_[node->begin + i]);
    double left = u * total;
    for (int i = 0; i < node->count && total > 0.0; ++i) {
      if (!(weights[i] > 0.0)) continue;
      choice = {order_[node->begin + i], probability * weights[i] / total, left / weights[i]};
      if (left < weights[i]) break;
      left -= weights[i];
    }
    choice.remainder = std::clamp(choice.remainder, 0.0,
                                  kBelowOne);  // rounding may leave a remainder slightly above 1 for the last one
    return choice;
  }

  // The probability with which Choose takes this light.
  template <class Weight>
  double Probability(const SurfacePoint& point, int light, bool with_delta, const Weight& weight) const {
    double probability = 1.0;
    const Node* node = &nodes_[0];
    for (std::uint64_t path = path_to_[light]; node->count == 0; path >>= 1) {
      const double first = FirstShare(*node, point, with_delta);
      if (!(first >= 0.0)) return 0.0;
      probability *= (path & 1) != 0 ? 1.0 - first : first;
      node = &nodes_[node->child[path & 1]];
    }
    if (node->count == 1) return weight(light) > 0.0 ? probability : 0.0;
    double total = 0.0;
    for (int i = 0; i < node->count; ++i) total += weight(order_[node->begin + i]);
    return total > 0.0 ? probability * weight(light) / total : 0.0;
  }

  // Calls visit(light) for every light with extent that a ray may meet, and for others near its line.
  template <class Visit>
  void VisitAlong(const glm::dvec3& origin, const glm::dvec3& direction, const Visit& visit) const {
    if (!nodes_.empty()) VisitAlong(nodes_[0], origin, direction, visit);
  }

 private:
  static constexpr int kLeafSize = 16;
  static constexpr double kBelowOne = 1.0 - 0x1.0p-53;

  struct Node {
    glm::dvec3 centre{0.0};
    double radius = 0.0;            // infinite where a sun is below
    std::array<double, 2> power{};  // of the lights with extent, and of all
    std::array<std::uint32_t, 2> child{};
    std::uint32_t begin = 0;  // a leaf's lights, in order_
    int count = 0;            // 0: no leaf
  };

  std::uint32_t Build(std::span<const TreeLight> lights, std::uint32_t begin, std::uint32_t end, std::uint64_t path,
                      int depth);
  double NodeWeight(const Node& node, const SurfacePoint& point, bool with_delta) const;
  // The probability of a node's first child; −1 where neither can light the point.
  double FirstShare(const Node& node, const SurfacePoint& point, bool with_delta) const;

  template <class Visit>
  void VisitAlong(const Node& node, const glm::dvec3& origin, const glm::dvec3& direction, const Visit& visit) const {
    if (!(node.power[0] > 0.0) || !MayMeet(node, origin, direction)) return;
    for (int i = 0; i < node.count; ++i) visit(order_[node.begin + i]);
    if (node.count > 0) return;
    for (const std::uint32_t child : node.child) VisitAlong(nodes_[child], origin, direction, visit);
  }
  static bool MayMeet(const Node& node, const glm::dvec3& origin, const glm::dvec3& direction);

  std::vector<Node> nodes_;             // the root first
  std::vector<int> order_;              // lights, leaf by leaf
  std::vector<std::uint64_t> path_to_;  // by light: bit d says which child is taken at depth d
};

}  // namespace scumble
