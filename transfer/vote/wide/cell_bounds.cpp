#include "transfer/vote/wide/cell_bounds.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/vote/wide/cell_bounds.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kSide = WideCells::kSide;
constexpr float kFar = std::numeric_limits<float>::infinity();
using DF = HWY_CAPPED(float, 16);
using V = hn::Vec<DF>;

// By column of pixels, over the rows of a row of cells.
struct Columns {
  // Widest surroundings, and what is read beyond them four vectors at a time.
  static constexpr int kMost = kTileSide + 2 * 128 + 64;
  enum { kPlanes = 7 };  // depth, slopes, normal, object
  float low[kPlanes][kMost], high[kPlanes][kMost];
  float length2[kMost], seen[kMost];
  float strange[kMost];  // NaN where a value is not finite, else 0
  float slope_x[kMost], slope_y[kMost];
};

HWY_ATTR bool AllCovered(const WideSurface& surface, int y, int begin, int end) {
  const DF d;
  for (int row = y; row < y + kSide; ++row) {
    const float* coverage = surface.Row(WideSurface::kCoverage, row);
    for (int x = begin; x < end; x += static_cast<int>(hn::Lanes(d))) {
      if (!hn::AllTrue(d, hn::Gt(hn::LoadU(d, coverage + x), hn::Zero(d)))) return false;
    }
  }
  return true;
}

// NaN and infinity are told by the sum of all values, which is no number then either; where it overflows nothing is
// known, and nothing is taken for sure.
template <bool kAll>
HWY_ATTR void FoldColumns(const WideSurface& surface, int y, int begin, int end, Columns& out) {
  const DF d;
  const V far = hn::Set(d, kFar), back = hn::Set(d, -kFar), zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (int x = begin; x < end; x += static_cast<int>(hn::Lanes(d))) {
    const int at = x - begin;
    V sum = zero, seen = kAll ? one : zero, shortest = far;
    for (int k = 0; k < Columns::kPlanes; ++k) {
      V low = far, high = back;
      for (int row = y; row < y + kSide; ++row) {
        const V value = hn::LoadU(d, surface.Row(WideSurface::Plane(k), row) + x);
        if constexpr (kAll) {
          low = hn::Min(low, value), high = hn::Max(high, value);
          sum = hn::Add(sum, value);
        } else {
          const auto covered = hn::Gt(hn::LoadU(d, surface.Row(WideSurface::kCoverage, row) + x), zero);
          low = hn::Min(low, hn::IfThenElse(covered, value, far));
          high = hn::Max(high, hn::IfThenElse(covered, value, back));
          sum = hn::Add(sum, hn::IfThenElseZero(covered, value));
        }
      }
      hn::StoreU(low, d, out.low[k] + at), hn::StoreU(high, d, out.high[k] + at);
    }
    for (int row = y; row < y + kSide; ++row) {
      const auto normal = [&](int c) HWY_ATTR {
        return hn::LoadU(d, surface.Row(WideSurface::Plane(WideSurface::kNormalX + c), row) + x);
      };
      const V a = normal(0), b = normal(1), c = normal(2);
      V length2 = hn::Add(hn::Add(hn::Mul(a, a), hn::Mul(b, b)), hn::Mul(c, c));
      if constexpr (!kAll) {
        const auto covered = hn::Gt(hn::LoadU(d, surface.Row(WideSurface::kCoverage, row) + x), zero);
        length2 = hn::IfThenElse(covered, length2, far), seen = hn::IfThenElse(covered, one, seen);
      }
      shortest = hn::Min(shortest, length2);
    }
    hn::StoreU(shortest, d, out.length2 + at);
    hn::StoreU(hn::Mul(sum, zero), d, out.strange + at), hn::StoreU(seen, d, out.seen + at);
  }
}

// How far depth leaves the plane of each cell's slopes through its centre.
template <bool kAll>
HWY_ATTR void FoldRests(const WideSurface& surface, int y, int begin, int end, Columns& out) {
  const DF d;
  constexpr float kCentre = 0.5f * (kSide - 1);
  HWY_ALIGN float from_centre[16];
  for (int i = 0; i < 16; ++i) from_centre[i] = static_cast<float>(i % kSide) - kCentre;
  for (int x = begin; x < end; x += static_cast<int>(hn::Lanes(d))) {
    const int at = x - begin;
    const V rise = hn::Mul(hn::LoadU(d, out.slope_x + at), hn::LoadU(d, from_centre + at % kSide));
    const V fall = hn::LoadU(d, out.slope_y + at);
    V low = hn::Set(d, kFar), high = hn::Set(d, -kFar);
    for (int row = 0; row < kSide; ++row) {
      const V plane = hn::Add(rise, hn::Mul(fall, hn::Set(d, static_cast<float>(row) - kCentre)));
      const V rest = hn::Sub(hn::LoadU(d, surface.Row(WideSurface::kDepth, y + row) + x), plane);
      if constexpr (kAll) {
        low = hn::Min(low, rest), high = hn::Max(high, rest);
      } else {
        const auto covered = hn::Gt(hn::LoadU(d, surface.Row(WideSurface::kCoverage, y + row) + x), hn::Zero(d));
        low = hn::Min(low, hn::IfThenElse(covered, rest, hn::Set(d, kFar)));
        high = hn::Max(high, hn::IfThenElse(covered, rest, hn::Set(d, -kFar)));
      }
    }
    hn::StoreU(low, d, out.low[0] + at), hn::StoreU(high, d, out.high[0] + at);
  }
}

// The smallest or the largest of the columns of each cell, or their sum.
HWY_ATTR HWY_INLINE V LeastOf(const float* columns) {
  const DF d;
  V a, b, c, e;
  hn::LoadInterleaved4(d, columns, a, b, c, e);
  return hn::Min(hn::Min(a, b), hn::Min(c, e));
}
HWY_ATTR HWY_INLINE V MostOf(const float* columns) {
  const DF d;
  V a, b, c, e;
  hn::LoadInterleaved4(d, columns, a, b, c, e);
  return hn::Max(hn::Max(a, b), hn::Max(c, e));
}
HWY_ATTR HWY_INLINE V SumOf(const float* columns) {
  const DF d;
  V a, b, c, e;
  hn::LoadInterleaved4(d, columns, a, b, c, e);
  return hn::Add(hn::Add(a, b), hn::Add(c, e));
}

// A row of cells: pixels [begin, end) of kSide rows from y on. `out` is its first bound, others lie `plane` further.
HWY_ATTR void BoundRow(const WideSurface& surface, int y, int begin, int end, float* out, std::size_t plane) {
  const DF d;
  const int cells = (end - begin) / kSide;
  Columns columns;
  const bool all = AllCovered(surface, y, begin, end);
  (all ? FoldColumns<true> : FoldColumns<false>)(surface, y, begin, end, columns);
  const V half = hn::Set(d, 0.5f), zero = hn::Zero(d), nothing = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
  const auto put = [&](int bound, int cell, V value)
                       HWY_ATTR { hn::StoreU(value, d, out + std::size_t(bound) * plane + std::size_t(cell)); };
  for (int cell = 0; cell < cells; cell += static_cast<int>(hn::Lanes(d))) {
    const int at = kSide * cell;
    const auto low = [&](int k) HWY_ATTR { return LeastOf(columns.low[k] + at); };
    const auto high = [&](int k) HWY_ATTR { return MostOf(columns.high[k] + at); };
    const V near = low(0), far = high(0);
    put(WideCells::kLeastDepth, cell, near), put(WideCells::kFarthest, cell, hn::Max(hn::Abs(near), hn::Abs(far)));
    V steepest = zero;
    for (int axis = 0; axis < 2; ++axis) {
      const V least = low(1 + axis), most = high(1 + axis);
      const V slope = hn::Mul(half, hn::Add(least, most)), turn = hn::Mul(half, hn::Sub(most, least));
      put(WideCells::kSlopeX + axis, cell, slope), put(WideCells::kTurnX + axis, cell, turn);
      put(WideCells::kLeastSlopeX + axis, cell, hn::Max(zero, hn::Max(least, hn::Neg(most))));
      hn::StoreInterleaved4(slope, slope, slope, slope, d, (axis == 0 ? columns.slope_x : columns.slope_y) + at);
      steepest = hn::Add(steepest, hn::Add(hn::Abs(slope), turn));
    }
    put(WideCells::kSteepest, cell, steepest);
    for (int c = 0; c < 3; ++c) {
      put(WideCells::kLeastNormal + c, cell, low(3 + c)), put(WideCells::kMostNormal + c, cell, high(3 + c));
    }
    put(WideCells::kLeastLength2, cell, LeastOf(columns.length2 + at));
    put(WideCells::kSeen, cell, MostOf(columns.seen + at));
    const auto one = hn::And(hn::Eq(low(6), high(6)), hn::Eq(SumOf(columns.strange + at), zero));
    put(WideCells::kObject, cell, hn::IfThenElse(one, low(6), nothing));
  }
  (all ? FoldRests<true> : FoldRests<false>)(surface, y, begin, end, columns);
  for (int cell = 0; cell < cells; cell += static_cast<int>(hn::Lanes(d))) {
    const V least = LeastOf(columns.low[0] + kSide * cell), most = MostOf(columns.high[0] + kSide * cell);
    const V object = hn::LoadU(d, out + WideCells::kObject * plane + std::size_t(cell));
    put(WideCells::kDepth, cell, hn::Mul(half, hn::Add(least, most)));
    put(WideCells::kBend, cell, hn::IfThenElse(hn::Eq(object, object), hn::Mul(half, hn::Sub(most, least)), nothing));
  }
  for (int bound = 0; bound < WideCells::kBounds; ++bound) {
    std::fill_n(out + std::size_t(bound) * plane + std::size_t(cells), 16, 0.0f);  // vectors went beyond the end
  }
}

// Whether normals and objects surely pass, by the bounds of either side.
template <class OfP, class OfQ>
HWY_ATTR HWY_INLINE hn::Mask<DF> FacingAlike(const OfP& of_p, const OfQ& of_q, float crease_cosine) {
  const DF d;
  const V half = hn::Set(d, 0.5f);
  V spread = hn::Zero(d), length2 = hn::Zero(d);
  for (int c = 0; c < 3; ++c) {
    const V most = hn::Max(of_p(WideCells::kMostNormal + c), of_q(WideCells::kMostNormal + c));
    const V least = hn::Min(of_p(WideCells::kLeastNormal + c), of_q(WideCells::kLeastNormal + c));
    const V wide = hn::Sub(most, least);
    spread = hn::Add(spread, hn::Mul(wide, wide));
    length2 = hn::Add(length2, hn::Max(hn::Mul(most, most), hn::Mul(least, least)));
  }
  // a · b = ½ (|a|² + |b|² - |a - b|²).
  const V cosine =
      hn::Sub(hn::Min(of_p(WideCells::kLeastLength2), of_q(WideCells::kLeastLength2)), hn::Mul(half, spread));
  const V enough = hn::Add(hn::Set(d, crease_cosine), hn::Mul(hn::Set(d, 1e-5f), hn::Add(hn::Set(d, 1.0f), length2)));
  return hn::And(hn::Gt(cosine, enough), hn::Eq(of_p(WideCells::kObject), of_q(WideCells::kObject)));
}

// EdgeTest::SameSurface for all pairs at once. With p = P + u and q = Q + v from the cells' centres, planes differ from
// each other by depth(Q) - depth(P) - ½ (g_P + g_Q) · (Q - P) + ½ (g_Q - g_P) · (u + v) more than the slopes explain.
template <bool kFacing>
HWY_ATTR WideCells::Bits DoubtBitsOf(const CellPairs& pair, const EdgeLimits& limits) {
  const DF d;
  WideCells::Bits bits;
  const V zero = hn::Zero(d), half = hn::Set(d, 0.5f);
  const V x = hn::Set(d, static_cast<float>(kSide * pair.dx)), y = hn::Set(d, static_cast<float>(kSide * pair.dy));
  // How far apart pixels of these cells are, at most and at least.
  const auto most_apart = [&](int cells) HWY_ATTR {
    return hn::Set(d, static_cast<float>(std::min(pair.radius, kSide * std::abs(cells) + kSide - 1)));
  };
  const auto least_apart = [&](int cells) HWY_ATTR {
    return hn::Set(d, static_cast<float>(std::max(0, kSide * (std::abs(cells) - 1) + 1)));
  };
  const V most_x = most_apart(pair.dx), most_y = most_apart(pair.dy);
  const V least_x = least_apart(pair.dx), least_y = least_apart(pair.dy);
  for (std::size_t i = 0; i < WideCells::kAcross; i += hn::Lanes(d)) {
    const auto of_p = [&](int bound) HWY_ATTR { return hn::LoadU(d, pair.p + std::size_t(bound) * pair.plane + i); };
    const auto of_q = [&](int bound) HWY_ATTR { return hn::LoadU(d, pair.q + std::size_t(bound) * pair.plane + i); };
    const V slope_x = of_p(WideCells::kSlopeX), slope_y = of_p(WideCells::kSlopeY);
    const V other_x = of_q(WideCells::kSlopeX), other_y = of_q(WideCells::kSlopeY);
    const V along = hn::Add(hn::Mul(hn::Add(slope_x, other_x), x), hn::Mul(hn::Add(slope_y, other_y), y));
    const V step = hn::Abs(hn::Sub(hn::Sub(of_q(WideCells::kDepth), of_p(WideCells::kDepth)), hn::Mul(half, along)));
    const V twist = hn::Mul(hn::Set(d, 0.5f * (kSide - 1)),
                            hn::Add(hn::Abs(hn::Sub(other_x, slope_x)), hn::Abs(hn::Sub(other_y, slope_y))));
    const auto drift = [&](int turn, int leeway, V most, V least) HWY_ATTR {
      const V more = hn::Sub(hn::Mul(half, hn::Add(of_p(turn), of_q(turn))), hn::Min(of_p(leeway), of_q(leeway)));
      return hn::Mul(more, hn::IfThenElse(hn::Gt(more, zero), most, least));
    };
    const V bends = hn::Add(of_p(WideCells::kBend), of_q(WideCells::kBend));
    const V drifts = hn::Add(drift(WideCells::kTurnX, WideCells::kLeastSlopeX, most_x, least_x),
                             drift(WideCells::kTurnY, WideCells::kLeastSlopeY, most_y, least_y));
    // Neither these sums nor the test's own are exact.
    const V steepest = hn::Add(of_p(WideCells::kSteepest), of_q(WideCells::kSteepest));
    const V slack =
        hn::Mul(hn::Set(d, 4e-6f), hn::Add(hn::Add(of_p(WideCells::kFarthest), of_q(WideCells::kFarthest)),
                                           hn::Mul(steepest, hn::Set(d, static_cast<float>(pair.radius + 2 * kSide)))));
    const V off = hn::Add(hn::Add(hn::Add(step, twist), bends), hn::Add(drifts, slack));
    const V nearest = hn::Min(of_p(WideCells::kLeastDepth), of_q(WideCells::kLeastDepth));
    const V tolerance = hn::Add(hn::Set(d, limits.give.fixed), hn::Mul(hn::Set(d, limits.give.share), nearest));
    const auto seen = hn::Gt(hn::Min(of_p(WideCells::kSeen), of_q(WideCells::kSeen)), zero);
    const auto put = [&](hn::Mask<DF> sure, std::uint32_t& word) HWY_ATTR {
      std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(d, hn::AndNot(sure, seen), bytes);
      word |= std::uint32_t(bytes[0] | bytes[1] << 8) << i;
    };
    put(hn::Le(off, tolerance), bits.depth);
    if constexpr (kFacing) put(FacingAlike(of_p, of_q, limits.crease_cosine), bits.facing);
  }
  return bits;
}

HWY_ATTR WideCells::Bits DoubtBits(const CellPairs& pair, const EdgeLimits& limits) {
  return (pair.facing ? DoubtBitsOf<true> : DoubtBitsOf<false>)(pair, limits);
}

// Whether no pixel of any cell can fail by facing, rows of `cells` cells.
HWY_ATTR bool AllFaceAlike(const float* first, std::size_t stride, std::size_t plane, int cells, float crease_cosine) {
  const DF d;
  const V far = hn::Set(d, kFar), zero = hn::Zero(d);
  V low[4] = {far, far, far, far}, high[4], shortest = far;
  for (V& value : high) value = hn::Neg(far);
  auto whole = hn::Eq(zero, zero);
  for (int row = 0; row < cells; ++row) {
    for (int cell = 0; cell < cells; cell += static_cast<int>(hn::Lanes(d))) {
      const auto of = [&](int bound) HWY_ATTR {
        return hn::LoadU(d, first + std::size_t(row) * stride + std::size_t(bound) * plane + std::size_t(cell));
      };
      const auto seen = hn::Gt(of(WideCells::kSeen), zero);
      for (int c = 0; c < 4; ++c) {
        const V least = of(c < 3 ? WideCells::kLeastNormal + c : int(WideCells::kObject));
        const V most = of(c < 3 ? WideCells::kMostNormal + c : int(WideCells::kObject));
        low[c] = hn::Min(low[c], hn::IfThenElse(seen, least, far));
        high[c] = hn::Max(high[c], hn::IfThenElse(seen, most, hn::Neg(far)));
      }
      shortest = hn::Min(shortest, hn::IfThenElse(seen, of(WideCells::kLeastLength2), far));
      const V object = of(WideCells::kObject);
      whole = hn::And(whole, hn::Or(hn::Not(seen), hn::Eq(object, object)));
    }
  }
  if (!hn::AllTrue(d, whole)) return false;
  float bounds[WideCells::kBounds];
  for (int c = 0; c < 3; ++c) {
    bounds[WideCells::kLeastNormal + c] = hn::GetLane(hn::MinOfLanes(d, low[c]));
    bounds[WideCells::kMostNormal + c] = hn::GetLane(hn::MaxOfLanes(d, high[c]));
  }
  bounds[WideCells::kLeastLength2] = hn::GetLane(hn::MinOfLanes(d, shortest));
  bounds[WideCells::kObject] = hn::GetLane(hn::MinOfLanes(d, low[3]));
  if (bounds[WideCells::kObject] != hn::GetLane(hn::MaxOfLanes(d, high[3]))) return false;
  const auto of_all = [&](int bound) HWY_ATTR { return hn::Set(d, bounds[bound]); };
  return hn::AllTrue(d, FacingAlike(of_all, of_all, crease_cosine));
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(BoundRow);
HWY_EXPORT(DoubtBits);
HWY_EXPORT(AllFaceAlike);

void WideCells::Read(const WideSurface& surface, const EdgeLimits& limits) {
  margin_ = surface.margin() / kSide, radius_ = surface.radius();
  const int across = kAcross + 2 * margin_;
  stride_ = std::size_t(across + 2 * kPad + kAcross), plane_ = stride_ * std::size_t(across);
  if (bounds_.size() != kBounds * plane_) bounds_.assign(kBounds * plane_, 0.0f);
  const int begin = -surface.margin(), end = kTileSide + surface.margin();
  for (int row = 0; row < across; ++row) {
    HWY_DYNAMIC_DISPATCH(BoundRow)
    (surface, begin + kSide * row, begin, end, bounds_.data() + std::size_t(row) * stride_ + kPad, plane_);
  }
  facing_ = !HWY_DYNAMIC_DISPATCH(AllFaceAlike)(bounds_.data() + kPad, stride_, plane_, across, limits.crease_cosine);
}

WideCells::Bits WideCells::Doubts(const EdgeLimits& limits, int column, int row, int dx, int dy) const {
  const int across = kAcross + 2 * margin_, y = row + margin_;
  if (y < 0 || y >= across || y + dy < 0 || y + dy >= across) return {};
  const float* p = bounds_.data() + std::size_t(y) * stride_ + std::size_t(column + margin_ + kPad);
  const float* q = p + std::ptrdiff_t(dy) * std::ptrdiff_t(stride_) + dx;
  return HWY_DYNAMIC_DISPATCH(DoubtBits)({p, q, plane_, dx, dy, radius_, facing_}, limits);
}

}  // namespace scumble::internal
#endif
