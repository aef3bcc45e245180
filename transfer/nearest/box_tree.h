// Nearest neighbours in many dimensions, exact or nearly so: a tree of boxes, sixteen to a node, whose distances are
// found together.
//
// Guides of a scene lie on surfaces in their space, however many dimensions it has. A kd-tree that bounds what it
// leaves out by its splitting planes, as nanoflann's does, sees little of that: where queries are off the surface,
// which noise of light paths is enough for, it visits most of fifteen dimensions' points. Boxes hug the surface. Boxes
// and points are kept sixteen side by side, coordinate by coordinate, which vector instructions read as they lie.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scumble::internal {

// Immutable; any number of threads may ask at once.
class BoxTree {
 public:
  static constexpr std::size_t kWide = 16;

  // `points` holds `dimensions` finite floats each, at least one point, fewer than 2^31. Building takes O(n log n), on
  // all threads of the caller's oneTBB arena; the tree holds 4 bytes a coordinate and 4 a point, and an eighth of it
  // again.
  BoxTree(int dimensions, std::span<const float> points);

  // The index of the point with the least Euclidean distance to `query`, squares summed in double in the order of the
  // dimensions; ties to the lowest index. `query` has as many finite values as there are dimensions.
  //
  // `place` says where to look first, and gets the place of the answer: a query that resembles the last is quicker with
  // the last one's. It never changes the answer; any number will do to begin with.
  std::uint32_t Nearest(const float* query, std::uint32_t& place) const;

  // The index of a point that is at most (1 + error) times as far as the nearest, error 0 or more: boxes that cannot
  // hold one nearer than its distance / (1 + error) are left out (Arya et al., "An Optimal Algorithm for Approximate
  // Nearest Neighbor Searching in Fixed Dimensions", JACM 1998). With error 0 it is one of the nearest; which, where
  // several are, is not said. The answer depends on points and query alone: not on the searches before, nor on the
  // machine.
  std::uint32_t ApproximateNearest(const float* query, double error) const;

  // What the search reads, in every instruction set. Leaf j holds places 16 j … 16 j + 15; node j of a level holds the
  // boxes of 16 j … of the level below.
  struct Level {
    std::size_t boxes = 0;
    std::vector<float> sides;  // by node: for each dimension 16 lower sides, then 16 upper ones
  };
  int dimensions() const { return dimensions_; }
  double slack() const { return slack_; }
  const std::vector<Level>& levels() const { return levels_; }  // from the leaves' boxes upwards
  const float* Leaf(std::size_t j) const { return points_.data() + j * kWide * static_cast<std::size_t>(dimensions_); }
  std::uint32_t IndexAt(std::size_t place) const { return index_[place]; }
  std::size_t places() const { return index_.size(); }

 private:
  void MakeLevels();

  int dimensions_;
  double slack_;                      // by what factor a distance in floats may be off
  std::vector<float> points_;         // by leaf: for each dimension 16 coordinates
  std::vector<std::uint32_t> index_;  // by place
  std::vector<Level> levels_;
};

}  // namespace scumble::internal
