#include "transfer/guide_tree.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <nanoflann.hpp>

#include "image/check.h"
#include "image/hash.h"

namespace scumble {
namespace {

// The points as nanoflann reads them.
struct Points {
  std::vector<float> coordinates;
  std::size_t dimensions;

  std::size_t kdtree_get_point_count() const { return coordinates.size() / dimensions; }
  double kdtree_get_pt(std::uint32_t index, std::size_t dimension) const {
    return coordinates[index * dimensions + dimension];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

// nanoflann's own metric subtracts in the elements' type; here floats are subtracted and summed as doubles.
struct SquaredDistance {
  using ElementType = double;
  using DistanceType = double;
  const Points& points;

  explicit SquaredDistance(const Points& all) : points(all) {}
  double evalMetric(const double* query, std::uint32_t index, std::size_t dimensions) const {
    double sum = 0.0;
    for (std::size_t d = 0; d < dimensions; ++d) {
      const double difference = query[d] - points.kdtree_get_pt(index, d);
      sum += difference * difference;
    }
    return sum;
  }
  double accum_dist(double a, double b, std::size_t) const { return (a - b) * (a - b); }
};

// nanoflann compares with `<` before it offers a point, which loses ties, and prunes by sums that are rounded in
// another order than the distance itself. Asking for a hair more than the best loses neither.
class LowestOfNearest {
 public:
  double worstDist() const { return best_distance_ * (1.0 + 1e-9) + std::numeric_limits<double>::min(); }
  bool addPoint(double distance, std::uint32_t index) {
    if (distance < best_distance_ || (distance == best_distance_ && index < best_)) {
      best_distance_ = distance, best_ = index;
    }
    return true;
  }
  bool full() const { return best_ != kNone; }
  std::size_t size() const { return full(); }
  std::uint32_t best() const { return best_; }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  double best_distance_ = std::numeric_limits<double>::max() / 2;
  std::uint32_t best_ = kNone;
};

// Keeps the first of equal points, in order; returns which they were.
std::vector<std::uint32_t> RemoveRepeats(std::vector<float>& coordinates, std::size_t dimensions) {
  const std::size_t count = coordinates.size() / dimensions;
  for (float& value : coordinates) value += 0.0f;  // -0 and +0 are the same place
  std::size_t slots = 16;
  while (slots < 2 * count) slots *= 2;
  constexpr std::uint32_t kFree = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> table(slots, kFree);  // open addressing, of indices into what is kept
  std::vector<std::uint32_t> first;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float* point = coordinates.data() + i * dimensions;
    std::uint64_t hash = 0;
    for (std::size_t d = 0; d < dimensions; ++d) {
      std::uint32_t bits;
      std::memcpy(&bits, point + d, sizeof bits);
      hash = Mix64(hash ^ bits);
    }
    std::size_t slot = hash & (slots - 1);
    const auto same = [&](std::uint32_t other) {
      return std::memcmp(coordinates.data() + other * dimensions, point, dimensions * sizeof(float)) == 0;
    };
    while (table[slot] != kFree && !same(table[slot])) slot = (slot + 1) & (slots - 1);
    if (table[slot] != kFree) continue;
    table[slot] = static_cast<std::uint32_t>(kept);
    std::memmove(coordinates.data() + kept * dimensions, point, dimensions * sizeof(float));
    first.push_back(static_cast<std::uint32_t>(i));
    ++kept;
  }
  coordinates.resize(kept * dimensions);
  coordinates.shrink_to_fit();
  return first;
}

}  // namespace

struct PointTree::Search {
  virtual ~Search() = default;
  virtual std::uint32_t Nearest(const double* query) const = 0;
};

template <int kDimensions>
struct PointTree::SearchOf : PointTree::Search {
  Points points;
  std::vector<std::uint32_t> first;  // of each distinct point, among all that were given
  nanoflann::KDTreeSingleIndexAdaptor<SquaredDistance, Points, kDimensions, std::uint32_t> index;

  SearchOf(Points distinct, std::vector<std::uint32_t> first_of)
      : points(std::move(distinct)),
        first(std::move(first_of)),
        index(static_cast<int>(points.dimensions), points, nanoflann::KDTreeSingleIndexAdaptorParams(12)) {}

  std::uint32_t Nearest(const double* query) const override {
    LowestOfNearest result;
    index.findNeighbors(result, query, nanoflann::SearchParams());
    return first[result.best()];
  }
};

PointTree::PointTree(int dimensions, std::vector<float> coordinates) : dimensions_(dimensions) {
  SCUMBLE_CHECK_LE(1, dimensions);
  const auto size = static_cast<std::size_t>(dimensions);
  SCUMBLE_CHECK(!coordinates.empty() && coordinates.size() % size == 0);
  SCUMBLE_CHECK_LT(coordinates.size() / size, std::size_t(1) << 31);
  std::vector<std::uint32_t> first = RemoveRepeats(coordinates, size);
  distinct_ = first.size();
  Points points{std::move(coordinates), size};
  if (dimensions == 3)
    search_ = std::make_unique<SearchOf<3>>(std::move(points), std::move(first));
  else
    search_ = std::make_unique<SearchOf<-1>>(std::move(points), std::move(first));
}

PointTree::~PointTree() = default;
PointTree::PointTree(PointTree&&) noexcept = default;
PointTree& PointTree::operator=(PointTree&&) noexcept = default;

std::uint32_t PointTree::Nearest(std::span<const float> query) const {
  SCUMBLE_DCHECK(query.size() == std::size_t(dimensions_));
  if (dimensions_ == 3) {
    const double three[3] = {query[0], query[1], query[2]};
    return search_->Nearest(three);
  }
  const std::vector<double> any(query.begin(), query.end());
  return search_->Nearest(any.data());
}

Expected<GuideTree> GuideTree::Build(const GuideSet& guides, std::span<const WeightedLayer> layers,
                                     std::span<const std::uint8_t> usable, const std::string& name) {
  int dimensions = 0;
  for (const WeightedLayer& each : layers) {
    const std::string layer = Info(each.layer).name;
    if (!guides.Has(each.layer)) {
      return InputError(name + " has no layer " + layer + "; it holds " + guides.layers().ToString());
    }
    if (each.layer == Layer::kObject || each.layer == Layer::kMaterial) {
      return UsageError("layer " + layer + " holds ids, which are equal or not: they have no distance to match by");
    }
    if (!(each.weight >= 0.0f && std::isfinite(each.weight))) {
      return UsageError("the weight of layer " + layer + " must be 0 or more, and finite");
    }
    dimensions += ChannelCount(each.layer);
  }
  if (dimensions == 0) return UsageError("name at least one layer to match by");
  SCUMBLE_CHECK(usable.empty() || usable.size() == guides.pixel_count());
  const auto coverage = guides.Plane(Layer::kCoverage);
  std::vector<float> coordinates;
  std::vector<Source> sources;
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      const std::size_t i = guides.Index(x, y);
      if (usable.empty() ? !(coverage[i] > 0.0f) : !usable[i]) continue;
      for (const WeightedLayer& each : layers) {
        for (int c = 0; c < ChannelCount(each.layer); ++c) {
          const float value = guides.Plane(each.layer, c)[i] * each.weight;
          if (!std::isfinite(value)) {
            return InputError(name + ": layer " + Info(each.layer).name + " is NaN or infinite at (" +
                              std::to_string(x) + ", " + std::to_string(y) +
                              "): write finite values, or set A to 0 there");
          }
          coordinates.push_back(value);
        }
      }
      sources.push_back({x, y});
    }
  }
  if (sources.empty()) return InputError(name + " has no usable pixel: nothing in it is covered");
  return GuideTree({layers.begin(), layers.end()}, std::move(sources), PointTree(dimensions, std::move(coordinates)));
}

Source GuideTree::Nearest(const GuideSet& target, std::size_t pixel) const {
  constexpr int kFew = 32;
  float few[kFew];
  std::vector<float> many;
  float* query = few;
  if (points_.dimensions() > kFew) many.resize(std::size_t(points_.dimensions())), query = many.data();
  std::size_t n = 0;
  for (const WeightedLayer& each : layers_) {
    for (int c = 0; c < ChannelCount(each.layer); ++c) {
      const float value = target.Plane(each.layer, c)[pixel] * each.weight;
      query[n++] = std::isfinite(value) ? value : 0.0f;
    }
  }
  return sources_[points_.Nearest({query, n})];
}

}  // namespace scumble
