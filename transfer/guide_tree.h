// Exact nearest neighbours among guides of any number of dimensions: kd-trees (Friedman, Bentley, Finkel, "An Algorithm
// for Finding Best Matches in Logarithmic Expected Time", ACM TOMS 1977; nanoflann's).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "image/guides.h"
#include "image/status.h"
#include "transfer/source.h"

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

// A layer and what it counts: its values are multiplied by the weight before distances are taken.
struct WeightedLayer {
  Layer layer;
  float weight = 1.0f;  // 0 or more, finite
};

// Which pixel of an exemplar's guides is most like a pixel of the scene's, in several layers at once: normals,
// luminance, light paths. Immutable; any number of threads may ask at once.
class GuideTree {
 public:
  // Over the usable pixels of `guides` (`usable` has one value a pixel, 1 for yes; empty: all covered ones), in row
  // order. Refuses layers that are missing, ids (they have no distances), values that are NaN or infinite, weights
  // below 0, and sets without a usable pixel. `name` stands for the guides in messages.
  static Expected<GuideTree> Build(const GuideSet& guides, std::span<const WeightedLayer> layers,
                                   std::span<const std::uint8_t> usable, const std::string& name);

  // The usable pixel nearest to pixel `pixel` of `target`, exactly; ties to the lowest (y, x). `target` must hold the
  // layers. A value that is NaN or infinite counts as 0.
  Source Nearest(const GuideSet& target, std::size_t pixel) const;

  const PointTree& points() const { return points_; }

 private:
  GuideTree(std::vector<WeightedLayer> layers, std::vector<Source> sources, PointTree points)
      : layers_(std::move(layers)), sources_(std::move(sources)), points_(std::move(points)) {}

  std::vector<WeightedLayer> layers_;
  std::vector<Source> sources_;  // of the points, in row order
  PointTree points_;
};

}  // namespace scumble
