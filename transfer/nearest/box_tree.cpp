#include "transfer/nearest/box_tree.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "core/image/check.h"
#include "transfer/nearest/box_search.h"

namespace scumble::internal {
namespace {

// Sorts points into leaves: halves a range across its longest side until it fits one.
class Sorter {
 public:
  Sorter(std::span<const float> points, std::size_t dimensions) : points_(points), dimensions_(dimensions) {
    order_.resize(points.size() / dimensions);
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i].index = static_cast<std::uint32_t>(i);
    Split(0, order_.size());
  }

  std::uint32_t operator[](std::size_t place) const { return order_[place].index; }

 private:
  struct Point {
    float key = 0.0f;
    std::uint32_t index = 0;
    bool operator<(const Point& other) const { return key < other.key || (key == other.key && index < other.index); }
  };

  float At(const Point& point, std::size_t d) const { return points_[point.index * dimensions_ + d]; }

  std::size_t LongestSide(std::size_t begin, std::size_t end) const {
    std::vector<float> least(points_.begin() + std::ptrdiff_t(order_[begin].index * dimensions_),
                             points_.begin() + std::ptrdiff_t((order_[begin].index + 1) * dimensions_));
    std::vector<float> largest = least;
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t d = 0; d < dimensions_; ++d) {
        const float value = At(order_[i], d);
        least[d] = std::min(least[d], value), largest[d] = std::max(largest[d], value);
      }
    }
    std::size_t longest = 0;
    for (std::size_t d = 1; d < dimensions_; ++d) {
      if (double(largest[d]) - least[d] > double(largest[longest]) - least[longest]) longest = d;
    }
    return longest;
  }

  // The left part has the largest power of two of leaves, so that nodes of 16, 256, … leaves begin where parts do.
  void Split(std::size_t begin, std::size_t end) {
    const std::size_t leaves = (end - begin + BoxTree::kWide - 1) / BoxTree::kWide;
    if (leaves <= 1) return;
    const std::size_t middle = begin + std::bit_floor(leaves - 1) * BoxTree::kWide, d = LongestSide(begin, end);
    for (std::size_t i = begin; i < end; ++i) order_[i].key = At(order_[i], d);
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end));
    constexpr std::size_t kWorthATask = 4096;
    if (end - begin < kWorthATask) {
      Split(begin, middle), Split(middle, end);
    } else {
      tbb::parallel_invoke([&] { Split(begin, middle); }, [&] { Split(middle, end); });
    }
  }

  std::span<const float> points_;
  std::size_t dimensions_;
  std::vector<Point> order_;
};

}  // namespace

BoxTree::BoxTree(int dimensions, std::span<const float> points)
    : dimensions_(dimensions), slack_(1.0 + 2.5e-7 * (dimensions + 4)) {
  SCUMBLE_CHECK_LE(1, dimensions);
  const auto size = static_cast<std::size_t>(dimensions);
  const std::size_t count = points.size() / size, leaves = (count + kWide - 1) / kWide;
  SCUMBLE_CHECK(count > 0 && points.size() % size == 0);
  SCUMBLE_CHECK_LT(count, std::size_t(1) << 31);
  const Sorter sorted(points, size);
  points_.resize(leaves * kWide * size), index_.resize(leaves * kWide);
  tbb::parallel_for(std::size_t(0), leaves, [&](std::size_t leaf) {
    for (std::size_t lane = 0; lane < kWide; ++lane) {
      // Repeats the last point to fill the last leaf; this changes no result.
      const std::uint32_t index = sorted[std::min(leaf * kWide + lane, count - 1)];
      index_[leaf * kWide + lane] = index;
      for (std::size_t d = 0; d < size; ++d) points_[(leaf * size + d) * kWide + lane] = points[index * size + d];
    }
  });
  MakeLevels();
}

void BoxTree::MakeLevels() {
  const auto size = static_cast<std::size_t>(dimensions_);
  for (std::size_t boxes = index_.size() / kWide; boxes > 1; boxes = (boxes + kWide - 1) / kWide) {
    Level level{boxes, std::vector<float>((boxes + kWide - 1) / kWide * 2 * kWide * size)};
    const Level* below = levels_.empty() ? nullptr : &levels_.back();
    for (std::size_t box = 0; box < boxes; ++box) {
      const std::size_t inside = below ? std::min(kWide, below->boxes - box * kWide) : kWide;
      for (std::size_t d = 0; d < size; ++d) {
        const float* lower = below ? &below->sides[(box * size + d) * 2 * kWide] : Leaf(box) + d * kWide;
        const float* upper = below ? lower + kWide : lower;
        float* side = &level.sides[(box / kWide * size + d) * 2 * kWide + box % kWide];
        side[0] = *std::min_element(lower, lower + inside), side[kWide] = *std::max_element(upper, upper + inside);
      }
    }
    levels_.push_back(std::move(level));
  }
}

std::uint32_t BoxTree::Nearest(const float* query, std::uint32_t& place) const {
  place = SearchBoxes(*this, query, place < index_.size() ? place : 0);
  return index_[place];
}

std::uint32_t BoxTree::ApproximateNearest(const float* query, double error) const {
  return index_[SearchBoxesRoughly(*this, query, error)];
}

}  // namespace scumble::internal
