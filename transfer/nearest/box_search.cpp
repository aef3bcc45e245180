#include "transfer/nearest/box_search.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/nearest/box_search.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, BoxTree::kWide>;

// Sixteen squared distances in floats, wrong by the tree's slack at most, and those that are within a bound.
struct Sixteen {
  HWY_ALIGN float distance[BoxTree::kWide];
  std::uint32_t within = 0;  // a bit for each
};

HWY_INLINE std::uint32_t BitsOf(hn::Mask<Floats> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Floats(), mask, bits);
  return bits[0] | std::uint32_t(bits[1]) << 8;
}

// `off` returns, for a dimension and a lane, the distance of the query from 16 boxes or points. Where the last bits may
// change the result, products are not fused with sums, so that all machines agree.
template <bool kFused, class Off>
HWY_INLINE void Measure(int dimensions, float bound, const Off& off, Sixteen& found) {
  const Floats d;
  found.within = 0;
  for (std::size_t lane = 0; lane < BoxTree::kWide; lane += hn::Lanes(d)) {
    auto sum = hn::Zero(d);
    for (int k = 0; k < dimensions; ++k) {
      const auto distance = off(k, lane);
      sum = kFused ? hn::MulAdd(distance, distance, sum) : hn::Add(hn::Mul(distance, distance), sum);
    }
    hn::Store(sum, d, found.distance + lane);
    found.within |= BitsOf(hn::Le(sum, hn::Set(d, bound))) << lane;
  }
}

// `nearer`: a box counts if it may hold a point at less than this share of the distance found; 1 unless kApproximate.
template <bool kApproximate>
class Search {
 public:
  Search(const BoxTree& tree, const float* query, std::uint32_t first, double nearer = 1.0)
      : tree_(tree), query_(query), nearer_squared_(nearer * nearer) {
    Take(first, Distance(first));
  }

  std::uint32_t Run() {
    if (tree_.levels().empty()) {
      VisitLeaf(0);
    } else {
      VisitNode(tree_.levels().size() - 1, 0);
    }
    return best_;
  }

 private:
  // Squares summed in the order that BoxTree::Nearest documents.
  HWY_INLINE double Distance(std::size_t place) const {
    const float* point = tree_.Leaf(place / BoxTree::kWide) + place % BoxTree::kWide;
    double sum = 0.0;
    for (int k = 0; k < tree_.dimensions(); ++k) {
      const double off = static_cast<double>(query_[k]) - point[std::size_t(k) * BoxTree::kWide];
      sum += off * off;
    }
    return sum;
  }

  void Take(std::size_t place, double distance) {
    best_ = static_cast<std::uint32_t>(place), distance_ = distance;
    // A distance that is larger in floats by this bound is larger; the least summand is for squares that underflow.
    const double bound = distance * tree_.slack() * tree_.slack() + 1e-40;
    bound_ = InFloats(bound);
    box_bound_ = kApproximate ? InFloats(bound * nearer_squared_) : bound_;
  }
  static float InFloats(double bound) {
    return bound < 3e38 ? static_cast<float>(bound) : std::numeric_limits<float>::infinity();
  }

  void VisitLeaf(std::size_t leaf) {
    const Floats d;
    const float* HWY_RESTRICT points = tree_.Leaf(leaf);
    Sixteen found;
    Measure<!kApproximate>(
        tree_.dimensions(), bound_,
        [&](int k, std::size_t lane) HWY_ATTR {
          return hn::Sub(hn::Set(d, query_[k]), hn::LoadU(d, points + std::size_t(k) * BoxTree::kWide + lane));
        },
        found);
    for (std::uint32_t left = found.within; left != 0; left &= left - 1) {
      const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(left);
      if (found.distance[lane] > bound_) continue;
      const std::size_t place = leaf * BoxTree::kWide + lane;
      const double distance = Distance(place);
      if (distance < distance_ || (distance == distance_ && tree_.IndexAt(place) < tree_.IndexAt(best_))) {
        Take(place, distance);
      }
    }
  }

  // Nearest boxes first, as long as they can hold a nearer point.
  void VisitNode(std::size_t level, std::size_t node) {
    const Floats d;
    const BoxTree::Level& boxes = tree_.levels()[level];
    const float* HWY_RESTRICT sides = boxes.sides.data() + node * std::size_t(tree_.dimensions()) * 2 * BoxTree::kWide;
    Sixteen found;
    Measure<!kApproximate>(
        tree_.dimensions(), box_bound_,
        [&](int k, std::size_t lane) HWY_ATTR {
          const float* lower = sides + std::size_t(k) * 2 * BoxTree::kWide + lane;
          const auto at = hn::Set(d, query_[k]);
          const auto outside =
              hn::Max(hn::Sub(hn::LoadU(d, lower), at), hn::Sub(at, hn::LoadU(d, lower + BoxTree::kWide)));
          return hn::Max(outside, hn::Zero(d));
        },
        found);
    const std::size_t first = node * BoxTree::kWide, inside = boxes.boxes - first;
    if (inside < BoxTree::kWide) found.within &= (1u << inside) - 1;
    while (found.within != 0) {
      std::uint32_t nearest = hwy::Num0BitsBelowLS1Bit_Nonzero32(found.within);
      for (std::uint32_t left = found.within & (found.within - 1); left != 0; left &= left - 1) {
        const std::uint32_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(left);
        if (found.distance[lane] < found.distance[nearest]) nearest = lane;
      }
      if (found.distance[nearest] > box_bound_) return;
      found.within &= ~(1u << nearest);
      if (level == 0) {
        VisitLeaf(first + nearest);
      } else {
        VisitNode(level - 1, first + nearest);
      }
    }
  }

  const BoxTree& tree_;
  const float* query_;
  double distance_ = 0.0;
  double nearer_squared_;
  float bound_ = 0.0f;
  float box_bound_ = 0.0f;
  std::uint32_t best_ = 0;
};

std::uint32_t SearchHere(const BoxTree& tree, const float* query, std::uint32_t first) {
  return Search<false>(tree, query, first).Run();
}

std::uint32_t SearchRoughlyHere(const BoxTree& tree, const float* query, double error) {
  return Search<true>(tree, query, 0, 1.0 / (1.0 + error)).Run();
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(SearchHere);
HWY_EXPORT(SearchRoughlyHere);

std::uint32_t SearchBoxes(const BoxTree& tree, const float* query, std::uint32_t first) {
  return HWY_DYNAMIC_DISPATCH(SearchHere)(tree, query, first);
}

std::uint32_t SearchBoxesRoughly(const BoxTree& tree, const float* query, double error) {
  return HWY_DYNAMIC_DISPATCH(SearchRoughlyHere)(tree, query, error);
}

}  // namespace scumble::internal
#endif
