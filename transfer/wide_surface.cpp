#include "transfer/wide_surface.h"

#include <cmath>
#include <cstring>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/wide_surface.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DF = HWY_CAPPED(float, 16);

// Depth, NaN where nothing is covered, so that nothing that is made of it passes a comparison. All arrays hold a vector
// more than `n`.
HWY_ATTR void MaskDepth(const float* coverage, const float* depth, int n, float* masked) {
  const DF d;
  const auto none = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
  for (int i = 0; i < n; i += static_cast<int>(hn::Lanes(d))) {
    const auto covered = hn::Gt(hn::LoadU(d, coverage + i), hn::Zero(d));
    hn::StoreU(hn::IfThenElse(covered, hn::LoadU(d, depth + i), none), d, masked + i);
  }
}

// DepthSlopes' rule for one direction: values before, at and behind each pixel.
HWY_ATTR void SlopeRow(const float* before, const float* here, const float* after, int n, float* slope) {
  const DF d;
  for (int i = 0; i < n; i += static_cast<int>(hn::Lanes(d))) {
    const auto depth = hn::LoadU(d, here + i);
    const auto back = hn::Sub(depth, hn::LoadU(d, before + i)), front = hn::Sub(hn::LoadU(d, after + i), depth);
    const auto gentler = hn::IfThenElse(hn::Lt(hn::Abs(back), hn::Abs(front)), back, front);
    hn::StoreU(hn::IfThenElseZero(hn::Gt(hn::Mul(back, front), hn::Zero(d)), gentler), d, slope + i);
  }
}

// The smallest and the largest value.
struct Range {
  float least, most;
};

struct CellRanges {
  Range value[WideSurface::kPlanes];
  float length2;
  bool any, nan;
};

// Of kSize² pixels; false where kAll promises that all are covered and they are not. NaN and infinity are told by a sum
// of values times 0, which is NaN then.
template <int kSize, bool kAll>
HWY_ATTR bool CellRangesOf(const float* const* planes, const std::ptrdiff_t* strides, CellRanges& out) {
  const HWY_CAPPED(float, kSize) d;
  using V = hn::Vec<decltype(d)>;
  constexpr float kFar = std::numeric_limits<float>::infinity();
  const int lanes = static_cast<int>(hn::Lanes(d));
  float least[8], most[7];
  std::fill_n(least, 8, kFar), std::fill_n(most, 7, -kFar);
  out.any = false, out.nan = false;
  for (int x = 0; x < kSize; x += lanes) {
    const V far = hn::Set(d, kFar), back = hn::Set(d, -kFar), zero = hn::Zero(d);
    V low0 = far, low1 = far, low2 = far, low3 = far, low4 = far, low5 = far, low6 = far, low7 = far;
    V high0 = back, high1 = back, high2 = back, high3 = back, high4 = back, high5 = back, high6 = back;
    V strange = zero, seen = zero;
    for (int y = 0; y < kSize; ++y) {
      const std::ptrdiff_t at = y * strides[WideSurface::kDepth] + x, from = y * strides[WideSurface::kCoverage] + x;
      const V coverage = hn::LoadU(d, planes[WideSurface::kCoverage] + from);
      const auto covered = hn::Gt(coverage, zero);
      if constexpr (kAll) {
        if (!hn::AllTrue(d, covered)) return false;
      } else {
        seen = hn::Or(seen, hn::IfThenElseZero(covered, hn::Set(d, 1.0f)));
      }
      const auto fold = [&](V value, V& low, V& high) HWY_ATTR {
        if constexpr (kAll) {
          low = hn::Min(low, value), high = hn::Max(high, value);
          strange = hn::Add(strange, hn::Mul(value, zero));
        } else {
          low = hn::Min(low, hn::IfThenElse(covered, value, far));
          high = hn::Max(high, hn::IfThenElse(covered, value, back));
          strange = hn::Add(strange, hn::IfThenElseZero(covered, hn::Mul(value, zero)));
        }
      };
      const V nx = hn::LoadU(d, planes[3] + from), ny = hn::LoadU(d, planes[4] + from),
              nz = hn::LoadU(d, planes[5] + from);
      fold(hn::LoadU(d, planes[0] + at), low0, high0);
      fold(hn::LoadU(d, planes[1] + at), low1, high1);
      fold(hn::LoadU(d, planes[2] + at), low2, high2);
      fold(nx, low3, high3), fold(ny, low4, high4), fold(nz, low5, high5);
      fold(hn::LoadU(d, planes[6] + from), low6, high6);
      const V length2 = hn::Add(hn::Add(hn::Mul(nx, nx), hn::Mul(ny, ny)), hn::Mul(nz, nz));
      low7 = hn::Min(low7, kAll ? length2 : hn::IfThenElse(covered, length2, far));
    }
    const auto lowest = [&](V value, int k)
                            HWY_ATTR { least[k] = std::min(least[k], hn::GetLane(hn::MinOfLanes(d, value))); };
    const auto highest = [&](V value, int k)
                             HWY_ATTR { most[k] = std::max(most[k], hn::GetLane(hn::MaxOfLanes(d, value))); };
    lowest(low0, 0), lowest(low1, 1), lowest(low2, 2), lowest(low3, 3), lowest(low4, 4), lowest(low5, 5);
    lowest(low6, 6), lowest(low7, 7);
    highest(high0, 0), highest(high1, 1), highest(high2, 2), highest(high3, 3), highest(high4, 4), highest(high5, 5);
    highest(high6, 6);
    out.any |= kAll || hn::GetLane(hn::MaxOfLanes(d, seen)) > 0.0f;
    out.nan |= !hn::AllTrue(d, hn::Eq(strange, zero));
  }
  for (int k = 0; k < 7; ++k) out.value[k] = {least[k], most[k]};
  out.length2 = least[7];
  return true;
}

// How far depth leaves the plane of these slopes through the cell's centre.
template <int kSize>
HWY_ATTR void BendOf(const float* depth, std::ptrdiff_t stride, const float* coverage, std::ptrdiff_t coverage_stride,
                     float slope_x, float slope_y, Range& out) {
  const HWY_CAPPED(float, kSize) d;
  constexpr float kFar = std::numeric_limits<float>::infinity();
  constexpr float kCentre = 0.5f * (kSize - 1);
  out = {kFar, -kFar};
  for (int x = 0; x < kSize; x += static_cast<int>(hn::Lanes(d))) {
    const auto rise = hn::Mul(hn::Set(d, slope_x), hn::Iota(d, static_cast<float>(x) - kCentre));
    auto low = hn::Set(d, kFar), high = hn::Set(d, -kFar);
    for (int y = 0; y < kSize; ++y) {
      const auto covered = hn::Gt(hn::LoadU(d, coverage + y * coverage_stride + x), hn::Zero(d));
      const auto plane = hn::Add(rise, hn::Set(d, slope_y * (static_cast<float>(y) - kCentre)));
      const auto rest = hn::Sub(hn::LoadU(d, depth + y * stride + x), plane);
      low = hn::Min(low, hn::IfThenElse(covered, rest, hn::Set(d, kFar)));
      high = hn::Max(high, hn::IfThenElse(covered, rest, hn::Set(d, -kFar)));
    }
    out.least = std::min(out.least, hn::GetLane(hn::MinOfLanes(d, low)));
    out.most = std::max(out.most, hn::GetLane(hn::MaxOfLanes(d, high)));
  }
}

template <int kSize>
HWY_ATTR void BoundOf(const float* const* planes, const std::ptrdiff_t* strides, WideSurface::Cell& cell) {
  CellRanges ranges;
  if (!CellRangesOf<kSize, true>(planes, strides, ranges)) CellRangesOf<kSize, false>(planes, strides, ranges);
  cell.empty = !ranges.any;
  if (cell.empty) return;
  const Range* value = ranges.value;
  const Range &depth = value[0], &x = value[1], &y = value[2];
  cell.odd = ranges.nan || value[6].least != value[6].most;
  cell.object = value[6].least;
  cell.least_depth = depth.least, cell.most_depth = depth.most;
  cell.slope_x = 0.5f * (x.least + x.most), cell.turn_x = 0.5f * (x.most - x.least);
  cell.slope_y = 0.5f * (y.least + y.most), cell.turn_y = 0.5f * (y.most - y.least);
  const auto steepness = [](const Range& r) { return std::max(0.0f, std::max(r.least, -r.most)); };
  cell.least_slope_x = steepness(x), cell.least_slope_y = steepness(y);
  for (int c = 0; c < 3; ++c) cell.least_normal[c] = value[3 + c].least, cell.most_normal[c] = value[3 + c].most;
  cell.least_length2 = ranges.length2;
  Range rest;
  BendOf<kSize>(planes[0], strides[0], planes[WideSurface::kCoverage], strides[WideSurface::kCoverage], cell.slope_x,
                cell.slope_y, rest);
  cell.depth = 0.5f * (rest.least + rest.most), cell.bend = 0.5f * (rest.most - rest.least);
}

HWY_ATTR void BoundCell(const float* const* planes, const std::ptrdiff_t* strides, WideSurface::Cell& cell) {
  BoundOf<WideSurface::kCell>(planes, strides, cell);
}
HWY_ATTR void BoundQuarter(const float* const* planes, const std::ptrdiff_t* strides, WideSurface::Cell& cell) {
  BoundOf<WideSurface::kQuarter>(planes, strides, cell);
}

HWY_ATTR std::uint64_t CoveredBits(const float* coverage) {
  const DF d;
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < 64; i += hn::Lanes(d)) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, hn::Gt(hn::LoadU(d, coverage + i), hn::Zero(d)), bytes);
    word |= std::uint64_t(bytes[0] | bytes[1] << 8) << i;
  }
  return word;
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(MaskDepth);
HWY_EXPORT(SlopeRow);
HWY_EXPORT(BoundCell);
HWY_EXPORT(BoundQuarter);
HWY_EXPORT(CoveredBits);

namespace {

constexpr struct GuideSource {
  WideSurface::Plane plane;
  Layer layer;
  int component;
} kSources[] = {{WideSurface::kDepth, Layer::kDepth, 0},    {WideSurface::kNormalX, Layer::kNormal, 0},
                {WideSurface::kNormalY, Layer::kNormal, 1}, {WideSurface::kNormalZ, Layer::kNormal, 2},
                {WideSurface::kObject, Layer::kObject, 0},  {WideSurface::kCoverage, Layer::kCoverage, 0}};

}  // namespace

void BitPlane::Reset(int margin) {
  margin_ = margin + 1, rows_ = kTileSide + 2 * margin_ + 8;
  words_.assign(std::size_t(rows_) * std::size_t((kTileSide + 2 * margin_ + 63) / 64 + 2), 0);
}

void BitPlane::Put(int row, int column, std::uint64_t bits) {
  const int at = column + margin_;
  if (at <= -64 || at >= kTileSide + 2 * margin_) return;
  if (at < 0) {
    words_[std::size_t(row + margin_)] |= bits >> -at;
    return;
  }
  const int shift = at & 63;
  std::uint64_t* low = words_.data() + std::size_t(at >> 6) * rows_ + std::size_t(row + margin_);
  low[0] |= bits << shift;
  low[rows_] |= bits >> 1 >> (63 - shift);
}

void WideSurface::Read(const GuideSet& guides, const Region& area, int radius) {
  radius_ = radius, reach_ = (radius + kCell - 1) / kCell;
  const int across = kTileSide + 2 * margin(), most = margin() + 1;
  stride_ = std::size_t(across + 2 * kPad + 64);
  for (const Plane plane : {kDepth, kSlopeX, kSlopeY}) planes_[plane].resize(stride_ * std::size_t(across + 2));
  // In the middle of the picture most guides are read where they are.
  const Region needed{area.x0 - most, area.y0 - most, area.x0 + kTileSide + most + 64, area.y0 + kTileSide + most + 1};
  const float* depth = nullptr;
  if (needed.x0 >= 0 && needed.y0 >= 0 && needed.x1 <= guides.width() && needed.y1 <= guides.height()) {
    const std::size_t corner = guides.Index(area.x0, area.y0);
    for (const GuideSource& source : kSources) {
      const float* base = guides.Plane(source.layer, source.component).data() + corner;
      if (source.plane == kDepth)
        depth = base;
      else
        bases_[source.plane] = base, strides_[source.plane] = guides.width();
    }
  } else {
    Copy(guides, area);
    depth = Own(kDepth, 0);
  }
  for (const Plane plane : {kDepth, kSlopeX, kSlopeY})
    bases_[plane] = Own(plane, 0), strides_[plane] = std::ptrdiff_t(stride_);
  const std::ptrdiff_t depth_stride = depth == Own(kDepth, 0) ? std::ptrdiff_t(stride_) : guides.width();
  for (int row = -most; row < kTileSide + most; ++row) {
    HWY_DYNAMIC_DISPATCH(MaskDepth)
    (Row(kCoverage, row) - most, depth + row * depth_stride - most, across + 2, Own(kDepth, row) - most);
  }
  covered_.Reset(margin());
  all_covered_ = true;
  const int left = -margin(), right = kTileSide + margin();
  for (int row = left; row < right; ++row) {
    const float* here = Row(kDepth, row) + left;
    HWY_DYNAMIC_DISPATCH(SlopeRow)(here - 1, here, here + 1, across, Own(kSlopeX, row) + left);
    HWY_DYNAMIC_DISPATCH(SlopeRow)
    (Row(kDepth, row - 1) + left, here, Row(kDepth, row + 1) + left, across, Own(kSlopeY, row) + left);
    for (int x = left; x < right; x += 64) {
      std::uint64_t covered = HWY_DYNAMIC_DISPATCH(CoveredBits)(Row(kCoverage, row) + x);
      if (right - x < 64) covered &= (std::uint64_t{1} << (right - x)) - 1;
      covered_.Put(row, x, covered);
      const std::uint64_t inner = BitsBetween(-radius - x, kTileSide + radius - x);
      if (row >= -radius && row < kTileSide + radius && (inner & ~covered)) all_covered_ = false;
    }
  }
  const int cells = kCells + 2 * reach_;
  cells_.assign(std::size_t(cells) * cells, Cell{});
  quartered_.assign(cells_.size(), 0);
  quarters_.resize(4 * cells_.size());
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      const float* planes[kPlanes];
      PlanesAt(kCell * (column - reach_), kCell * (row - reach_), planes);
      HWY_DYNAMIC_DISPATCH(BoundCell)(planes, strides_, cells_[std::size_t(row) * cells + column]);
    }
  }
}

// Into the own planes, from the row and column before the margin to those behind it; what is not in the picture is not
// covered.
void WideSurface::Copy(const GuideSet& guides, const Region& area) {
  const int most = margin() + 1;
  for (const GuideSource& source : kSources) {
    std::vector<float>& plane = planes_[source.plane];
    plane.assign(stride_ * std::size_t(kTileSide + 2 * most), 0.0f);
    const auto values = guides.Plane(source.layer, source.component);
    const int begin = std::max(0, area.x0 - most), end = std::min(guides.width(), area.x0 + kTileSide + most);
    for (int y = std::max(0, area.y0 - most); y < std::min(guides.height(), area.y0 + kTileSide + most); ++y) {
      std::memcpy(Own(source.plane, y - area.y0) + (begin - area.x0), values.data() + guides.Index(begin, y),
                  sizeof(float) * std::size_t(end - begin));
    }
    bases_[source.plane] = Own(source.plane, 0), strides_[source.plane] = std::ptrdiff_t(stride_);
  }
}

const WideSurface::Cell& WideSurface::QuarterAt(int column, int row) {
  const int x = column + 2 * reach_, y = row + 2 * reach_;
  const std::size_t cell = std::size_t(y / 2) * (kCells + 2 * reach_) + std::size_t(x / 2);
  if (!quartered_[cell]) {
    quartered_[cell] = 1;
    for (int k = 0; k < 4; ++k) {
      const float* planes[kPlanes];
      PlanesAt(kQuarter * ((column & ~1) + k % 2), kQuarter * ((row & ~1) + k / 2), planes);
      Cell& quarter = quarters_[4 * cell + std::size_t(k)];
      quarter = {};
      HWY_DYNAMIC_DISPATCH(BoundQuarter)(planes, strides_, quarter);
    }
  }
  return quarters_[4 * cell + std::size_t(2 * (y & 1) + (x & 1))];
}

unsigned WideSurface::QuarterDoubts(const EdgeLimits& limits, int column, int row, int dx, int dy) {
  const Cell& p = QuarterAt(column, row);
  return Doubts(limits, p, QuarterAt(column + dx, row + dy), kQuarter, dx, dy);
}

// EdgeTest::SameSurface for all pairs at once. With p = P + u and q = Q + v from the cells' centres, planes differ from
// each other by depth(Q) - depth(P) - ½ (g_P + g_Q) · (Q - P) + ½ (g_Q - g_P) · (u + v) more than the slopes explain.
unsigned WideSurface::Doubts(const EdgeLimits& limits, const Cell& p, const Cell& q, int size, int dx, int dy) const {
  if (p.empty || q.empty) return 0;
  if (p.odd || q.odd) return kDepthDoubt | kFacingDoubt;
  unsigned doubts = 0;
  if (p.object != q.object) doubts |= kFacingDoubt;
  float spread = 0.0f, length2 = 0.0f;
  for (int c = 0; c < 3; ++c) {
    const float most = std::max(p.most_normal[c], q.most_normal[c]),
                least = std::min(p.least_normal[c], q.least_normal[c]);
    spread += (most - least) * (most - least);
    length2 += std::max(most * most, least * least);
  }
  // a · b = ½ (|a|² + |b|² - |a - b|²).
  const float cosine = std::min(p.least_length2, q.least_length2) - 0.5f * spread;
  if (!(cosine > limits.crease_cosine + 1e-5f * (1.0f + length2))) doubts |= kFacingDoubt;
  const auto drift = [&](float turn, float leeway, int cells) {
    const float more = turn - leeway;
    const int apart = more > 0.0f ? std::min(radius_, size * std::abs(cells) + size - 1)
                                  : std::max(0, size * (std::abs(cells) - 1) + 1);
    return more * static_cast<float>(apart);
  };
  const float x = static_cast<float>(size * dx), y = static_cast<float>(size * dy);
  const float step = std::fabs(q.depth - p.depth - 0.5f * ((p.slope_x + q.slope_x) * x + (p.slope_y + q.slope_y) * y));
  const float twist =
      0.5f * static_cast<float>(size - 1) * (std::fabs(q.slope_x - p.slope_x) + std::fabs(q.slope_y - p.slope_y));
  const float off = step + twist + p.bend + q.bend +
                    drift(0.5f * (p.turn_x + q.turn_x), std::min(p.least_slope_x, q.least_slope_x), dx) +
                    drift(0.5f * (p.turn_y + q.turn_y), std::min(p.least_slope_y, q.least_slope_y), dy);
  // Neither these sums nor the test's own are exact.
  const float depths = std::max(std::fabs(p.least_depth), std::fabs(p.most_depth)) +
                       std::max(std::fabs(q.least_depth), std::fabs(q.most_depth));
  const float slopes = std::fabs(p.slope_x) + std::fabs(q.slope_x) + std::fabs(p.slope_y) + std::fabs(q.slope_y) +
                       p.turn_x + q.turn_x + p.turn_y + q.turn_y;
  const float slack = 4e-6f * (depths + slopes * static_cast<float>(radius_ + kCell));
  if (!(off + slack <= limits.depth_tolerance * std::min(p.least_depth, q.least_depth))) doubts |= kDepthDoubt;
  return doubts;
}

}  // namespace scumble::internal
#endif
