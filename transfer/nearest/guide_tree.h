// Nearest neighbours among guides of any number of dimensions (made by transfer/exemplar/guide_space.h), after
// Friedman, Bentley, Finkel, "An Algorithm for Finding Best Matches in Logarithmic Expected Time", ACM TOMS 1977. The
// tree is our own; transfer/nearest/box_tree.h gives the reason.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace scumble {

namespace internal {
class BoxTree;
}

// Points of `dimensions` finite floats each. Equal points count once, as the first of them, so that a flat face of ten
// thousand pixels costs as much as one pixel. Building is O(n log n), on all threads of the caller's oneTBB arena;
// about 5 bytes a coordinate and 8 a distinct point. Immutable; any number of threads may search at once.
class PointTree {
 public:
  // `coordinates` holds the points one after the other; at least one.
  PointTree(int dimensions, std::vector<float> coordinates);
  ~PointTree();
  PointTree(PointTree&&) noexcept;
  PointTree& operator=(PointTree&&) noexcept;

  int dimensions() const { return dimensions_; }
  std::size_t distinct() const { return first_.size(); }

  // The index, in the order given, of the point with the least Euclidean distance to `query`, squares summed in double
  // in the order of the dimensions; ties to the lowest index. `query` has as many finite values as there are
  // dimensions.
  std::uint32_t Nearest(std::span<const float> query) const;

  // Nearest with a start: faster if the query resembles the one that set `place`; any number will do at first.
  std::uint32_t Nearest(std::span<const float> query, std::uint32_t& place) const;

  // A point at most (1 + error) times as far as the nearest, error above 0; for error 0 the nearest itself. The choice
  // depends on points, query and error alone.
  std::uint32_t Nearest(std::span<const float> query, std::uint32_t& place, double error) const;

 private:
  int dimensions_;
  std::vector<std::uint32_t> first_;  // of each distinct point, among all points
  std::unique_ptr<internal::BoxTree> tree_;
};

}  // namespace scumble
