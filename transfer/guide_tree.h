// Exact nearest neighbours among guides of any number of dimensions (transfer/guide_space.h makes them): kd-trees (Friedman, Bentley, Finkel, "An Algorithm
// for Finding Best Matches in Logarithmic Expected Time", ACM TOMS 1977; nanoflann's).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace scumble {

// Points of `dimensions` finite floats each. Equal points count once, as the first of them, so that a flat face of ten
// thousand pixels costs what one pixel does. Building is O(n log n) on one thread; about 30 bytes a distinct point
// beside the floats. Immutable; any number of threads may ask at once.
class PointTree {
 public:
  // `coordinates` holds the points one after the other; at least one.
  PointTree(int dimensions, std::vector<float> coordinates);
  ~PointTree();
  PointTree(PointTree&&) noexcept;
  PointTree& operator=(PointTree&&) noexcept;

  int dimensions() const { return dimensions_; }
  std::size_t distinct() const { return distinct_; }

  // The index, in the order given, of the point with the least Euclidean distance to `query`, squares summed in double
  // in the order of the dimensions; ties to the lowest index. `query` has as many finite values as there are
  // dimensions.
  std::uint32_t Nearest(std::span<const float> query) const;

 private:
  struct Search;
  template <int kDimensions>
  struct SearchOf;

  int dimensions_;
  std::size_t distinct_ = 0;
  std::unique_ptr<Search> search_;
};

}  // namespace scumble
