#include "transfer/vote/wide/guide_tile.h"

#include <cstring>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/vote/wide/guide_tile.cpp"
#include <hwy/cache_control.h>
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
  radius_ = radius;
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
  // Rows of a tile are short, so the machine does not see by itself that the next tile, to the right, will be read.
  const bool next = area.x0 + 2 * kTileSide + most <= guides.width();
  for (int row = -most; row < kTileSide + most; ++row) {
    if (next && area.y0 + row >= 0 && area.y0 + row < guides.height()) {
      const std::size_t at = guides.Index(area.x0 + kTileSide + most, area.y0 + row);
      for (const GuideSource& source : kSources) {
        const float* values = guides.Plane(source.layer, source.component).data() + at;
        for (int x = 0; x < kTileSide; x += 16) hwy::Prefetch(values + x);
      }
    }
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

}  // namespace scumble::internal
#endif
