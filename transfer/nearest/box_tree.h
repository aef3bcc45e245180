// Nearest neighbours in many dimensions, exact or (1+ε)-approximate: a tree of boxes, sixteen to a node, whose
// distances are computed together.
//
// Guides of a scene lie on surfaces in their space, however many dimensions it has. A kd-tree that bounds subtrees by
// its splitting planes, like nanoflann's, gains little from that. If queries are off the surface, for example by the
// noise of light paths, it visits most points of a space of fifteen dimensions. Boxes fit the surface tightly. Boxes
// and points are stored sixteen side by side, coordinate by coordinate, as vector instructions read them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scumble::internal {

// Immutable; any number of threads may search at once.
class BoxTree {
 public:
  static constexpr std::size_t kWide = 16;

  // `points` holds `dimensions` finite floats each, at least one point, fewer than 2^31. Building takes O(n log n), on
  // all threads of the caller's oneTBB arena; the tree holds 4 bytes a coordinate and 4 a point, and an eighth more.
  BoxTree(int dimensions, std::span<const float> points);

  // The index of the point with the least Euclidean distance to `query`, squares summed in double in the order of the
  // dimensions; ties to the lowest index. `query` has as many finite values as there are dimensions.
  //
  // The search begins at `place`, and sets it to the place of the result: a query that resembles the last one is faster
  // with the last place. It never changes the result; any number will do at first.
  std::uint32_t Nearest(const float* query, std::uint32_t& place) const;

  // The index of a point at most (1 + error) times as far as the nearest, error 0 or more. Boxes that cannot hold one
  // nearer than its distance / (1 + error) are skipped (Arya et al., "An Optimal Algorithm for Approximate Nearest
  // Neighbor Searching in Fixed Dimensions", JACM 1998). With error 0 it is one of the nearest; ties are unspecified.
  // The result depends on points and query alone: not on earlier searches, nor on the machine.
  std::uint32_t ApproximateNearest(const float* query, double error) const;

  // The data of the search, for every instruction set. Leaf j holds places 16 j … 16 j + 15; node j of a level holds
  // the boxes of 16 j … of the level below.
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
  double slack_;                      // the factor by which a distance in floats may be wrong
  std::vector<float> points_;         // by leaf: for each dimension 16 coordinates
  std::vector<std::uint32_t> index_;  // by place
  std::vector<Level> levels_;
};

}  // namespace scumble::internal
