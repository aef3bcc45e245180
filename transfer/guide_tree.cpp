#include "transfer/guide_tree.h"

#include <algorithm>
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
  // Normals; with luminance or another single value; with one colour.
  switch (dimensions) {
    case 3: search_ = std::make_unique<SearchOf<3>>(std::move(points), std::move(first)); break;
    case 4: search_ = std::make_unique<SearchOf<4>>(std::move(points), std::move(first)); break;
    case 6: search_ = std::make_unique<SearchOf<6>>(std::move(points), std::move(first)); break;
    default: search_ = std::make_unique<SearchOf<-1>>(std::move(points), std::move(first)); break;
  }
}

PointTree::~PointTree() = default;
PointTree::PointTree(PointTree&&) noexcept = default;
PointTree& PointTree::operator=(PointTree&&) noexcept = default;

std::uint32_t PointTree::Nearest(std::span<const float> query) const {
  SCUMBLE_DCHECK(query.size() == std::size_t(dimensions_));
  constexpr std::size_t kFew = 32;
  if (query.size() <= kFew) {
    double few[kFew];
    std::copy(query.begin(), query.end(), few);
    return search_->Nearest(few);
  }
  const std::vector<double> any(query.begin(), query.end());
  return search_->Nearest(any.data());
}

}  // namespace scumble
