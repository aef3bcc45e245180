// A mesh that emits, in pieces of few triangles. A point takes its light from the piece that lights it most, because a
// row of lanterns may be one mesh.
//
// The pieces are the leaves of a binary tree. Going down, the side is taken more often that is larger, nearer, and
// turned towards the point or away from it: both sides shine. A piece's triangles are chosen by area. light_tree.h
// chooses among lights alike, but does not know where they face.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <utility>
#include <vector>

#include "guidegen/surface/surface.h"

namespace scumble {

// Immutable once built; free to use from any thread.
class EmitterPieces {
 public:
  EmitterPieces() = default;
  // The mesh's triangles, view space, by their number in it. Those without an area are left out.
  explicit EmitterPieces(std::span<const Triangle> triangles);

  // The whole mesh: its area, and a sphere about it. Not above 0, or infinite, where nothing can be chosen.
  double area() const { return nodes_.empty() ? 0.0 : nodes_[0].area; }
  const glm::dvec3& centre() const { return nodes_[0].centre; }
  double radius() const { return nodes_[0].radius; }

  // A triangle; u in [0, 1). `area` is the inverse of the density with which Choose and an even choice within the
  // triangle take a place of it: of a mesh of one piece the whole area. 0: no piece can light the point.
  struct Choice {
    std::uint32_t primitive = 0;
    double area = 0.0;
    double remainder = 0.0;  // of u, rescaled to [0, 1]
  };
  Choice Choose(const SurfacePoint& point, double u) const;
  // The choice's area for this triangle; infinite where Choose does not take it.
  double AreaFor(const SurfacePoint& point, std::uint32_t primitive) const;

 private:
  struct Node {
    glm::dvec3 centre{0.0};
    double radius = 0.0;
    double area = 0.0;
    glm::dvec3 normal{0.0};  // the mean of the triangles' unit normals
    std::uint32_t parent = 0;
    std::uint32_t child[2] = {};
    std::uint32_t begin = 0, count = 0;  // a leaf's triangles, in order_; a count of 0: no leaf
  };
  struct Flat {  // a triangle
    glm::dvec3 centre{0.0};
    glm::dvec3 area_normal{0.0};  // as long as its area
    double area = 0.0;
  };

  std::uint32_t Build(std::span<const Triangle> triangles, std::span<const Flat> flats,
                      std::pair<std::uint32_t, std::uint32_t> range, std::uint32_t parent, std::uint32_t most);
  std::size_t Split(std::span<const Triangle> triangles, std::span<const Flat> flats,
                    std::span<std::uint32_t> mine) const;
  double Weight(const Node& node, const SurfacePoint& point) const;
  double FirstShare(const Node& node, const SurfacePoint& point) const;

  std::vector<Node> nodes_;             // the root first
  std::vector<std::uint32_t> order_;    // triangles, leaf by leaf
  std::vector<double> areas_up_to_;     // cumulative within each leaf, as order_
  std::vector<std::uint32_t> leaf_of_;  // by triangle
};

}  // namespace scumble
