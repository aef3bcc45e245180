#include "guidegen/light/emitter_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "guidegen/light/light_tree.h"

namespace scumble {
namespace {

constexpr std::uint32_t kPieceTriangles = 4;
constexpr std::uint32_t kMostPieces = 4096;
constexpr std::uint32_t kNoLeaf = ~0u;
constexpr double kBelowOne = 1.0 - 0x1.0p-53;
constexpr std::size_t kBins = 16;

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};

  void Add(const glm::dvec3& place) { low = glm::min(low, place), high = glm::max(high, place); }
  double SquaredSize() const { return glm::dot(high - low, high - low); }
};

}  // namespace

EmitterPieces::EmitterPieces(std::span<const Triangle> triangles) : leaf_of_(triangles.size(), kNoLeaf) {
  std::vector<Flat> flats(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& corner = triangles[i].corner;
    const glm::dvec3 across = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double area = 0.5 * glm::length(across);
    if (!(area > 0.0) || !std::isfinite(area)) continue;
    flats[i] = {(corner[0] + corner[1] + corner[2]) / 3.0, 0.5 * across, area};
    order_.push_back(std::uint32_t(i));
  }
  if (order_.empty()) return;
  areas_up_to_.resize(order_.size());
  const auto count = std::uint32_t(order_.size());
  Build(triangles, flats, {0, count}, 0, std::max(kPieceTriangles, (count + kMostPieces - 1) / kMostPieces));
}

// Parts a range that is too long at one of a few planes across the longest side of its centres' box, so that the
// parts' sizes, weighted by their area, are least: between lanterns, not through them. Returns the first part's length.
std::size_t EmitterPieces::Split(std::span<const Triangle> triangles, std::span<const Flat> flats,
                                 std::span<std::uint32_t> mine) const {
  Box centres;
  for (const std::uint32_t i : mine) centres.Add(flats[i].centre);
  const glm::dvec3 size = centres.high - centres.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto bin_of = [&](std::uint32_t i) {
    const double at = (flats[i].centre[axis] - centres.low[axis]) / size[axis] * kBins;
    return at > 0.0 ? std::min(std::size_t(at), kBins - 1) : 0;
  };
  struct Part {
    Box box;
    double area = 0.0;
    double Cost() const { return area > 0.0 ? area * box.SquaredSize() : 0.0; }
  };
  std::array<Part, kBins> bins;
  for (const std::uint32_t i : mine) {
    Part& bin = bins[bin_of(i)];
    bin.area += flats[i].area;
    for (const glm::dvec3& corner : triangles[i].corner) bin.box.Add(corner);
  }
  const auto joined = [](const Part& a, const Part& b) {
    Part sum = a;
    sum.area += b.area, sum.box.Add(b.box.low), sum.box.Add(b.box.high);
    return sum;
  };
  std::array<Part, kBins> after = bins;  // a bin and all after it
  for (std::size_t k = kBins - 1; k > 0; --k) {
    if (after[k].area > 0.0) after[k - 1] = after[k - 1].area > 0.0 ? joined(after[k - 1], after[k]) : after[k];
  }
  Part before;
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < kBins; ++k) {
    if (bins[k].area > 0.0) before = before.area > 0.0 ? joined(before, bins[k]) : bins[k];
    const double cost = before.Cost() + after[k + 1].Cost();
    if (before.area > 0.0 && after[k + 1].area > 0.0 && cost < least) least = cost, best = k + 1;
  }
  if (best == 0) return mine.size() / 2;  // all at one place
  const auto middle =
      std::stable_partition(mine.begin(), mine.end(), [&](std::uint32_t i) { return bin_of(i) < best; });
  return std::size_t(middle - mine.begin());
}

std::uint32_t EmitterPieces::Build(std::span<const Triangle> triangles, std::span<const Flat> flats,
                                   std::pair<std::uint32_t, std::uint32_t> range, std::uint32_t parent,
                                   std::uint32_t most) {
  const auto index = std::uint32_t(nodes_.size());
  nodes_.emplace_back();
  const auto [begin, end] = range;
  const std::span<std::uint32_t> mine(order_.data() + begin, end - begin);
  Node node;
  node.parent = parent;
  Box box;
  for (const std::uint32_t i : mine) {
    for (const glm::dvec3& corner : triangles[i].corner) box.Add(corner);
  }
  node.centre = 0.5 * (box.low + box.high);
  node.radius = 0.5 * std::sqrt(box.SquaredSize());
  if (mine.size() <= most) {
    std::sort(mine.begin(), mine.end());
    for (std::uint32_t k = begin; k < end; ++k) {
      const Flat& flat = flats[order_[k]];
      areas_up_to_[k] = node.area += flat.area;
      node.normal += flat.area_normal;
      leaf_of_[order_[k]] = index;
    }
    node.normal /= node.area;
    node.begin = begin;
    node.count = end - begin;
    nodes_[index] = node;
    return index;
  }
  const auto middle = begin + std::uint32_t(Split(triangles, flats, mine));
  node.child[0] = Build(triangles, flats, {begin, middle}, index, most);
  node.child[1] = Build(triangles, flats, {middle, end}, index, most);
  for (const std::uint32_t child : node.child) node.area += nodes_[child].area;
  for (const std::uint32_t child : node.child) node.normal += nodes_[child].normal * (nodes_[child].area / node.area);
  nodes_[index] = node;
  return index;
}

// The light of a node, about: as if its normals were in part all its mean one, in part evenly spread.
double EmitterPieces::Weight(const Node& node, const SurfacePoint& point) const {
  const double weight = SphereWeight(node.centre, node.radius, node.area, point);
  const glm::dvec3 to_point = point.position - node.centre;
  const double distance = glm::length(to_point);
  if (!(weight > 0.0) || !(distance > 0.0)) return weight;
  const double one_way = std::min(glm::length(node.normal), 1.0), spread = 1.0 - one_way;
  const double cosine = std::abs(glm::dot(node.normal, to_point)) / distance;
  return weight * (0.5 * spread + std::min(cosine + one_way * node.radius / distance, one_way));
}

// The probability of a node's first child; −1 where neither can light the point.
double EmitterPieces::FirstShare(const Node& node, const SurfacePoint& point) const {
  const Node& first = nodes_[node.child[0]];
  const Node& second = nodes_[node.child[1]];
  const double a = Weight(first, point), b = Weight(second, point);
  if (std::isfinite(a + b)) return a + b > 0.0 ? a / (a + b) : -1.0;
  return first.area / (first.area + second.area);
}

EmitterPieces::Choice EmitterPieces::Choose(const SurfacePoint& point, double u) const {
  const Node* node = &nodes_[0];
  double probability = 1.0;
  while (node->count == 0) {
    const double first = FirstShare(*node, point);
    if (!(first >= 0.0)) return {};
    const bool second = u >= first;
    const double share = second ? 1.0 - first : first;
    u = std::min((second ? u - first : u) / share, kBelowOne);
    probability *= share;
    node = &nodes_[node->child[second]];
  }
  const double wanted = u * node->area;
  const auto begin = areas_up_to_.begin() + node->begin, end = begin + node->count;
  const auto at = std::min(std::upper_bound(begin, end, wanted), end - 1);
  const double before = at != begin ? *(at - 1) : 0.0;
  Choice choice;
  choice.primitive = order_[std::size_t(at - areas_up_to_.begin())];
  choice.area = node->area / probability;
  choice.remainder = std::clamp((wanted - before) / (*at - before), 0.0, 1.0);
  return choice;
}

double EmitterPieces::AreaFor(const SurfacePoint& point, std::uint32_t primitive) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::uint32_t at = leaf_of_[primitive];
  if (at == kNoLeaf) return kNever;
  const double area = nodes_[at].area;
  double probability = 1.0;
  while (at != 0) {
    const Node& parent = nodes_[nodes_[at].parent];
    const double first = FirstShare(parent, point);
    if (!(first >= 0.0)) return kNever;
    probability *= at == parent.child[1] ? 1.0 - first : first;
    at = nodes_[at].parent;
  }
  return probability > 0.0 ? area / probability : kNever;
}

}  // namespace scumble
