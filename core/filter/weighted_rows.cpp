#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/filter/weighted_rows.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <hwy/highway.h>

#include <algorithm>

#include "core/filter/weighted_rows.h"

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Where all pixels are opaque, all four channels are plain sums of less than 32 bits; where all are transparent, there
// is nothing to sum. From `begin` on this does blocks of such pixels; returns the channel where another kind begins.
std::size_t SumBlocks(std::span<const std::int32_t> weights, std::span<const std::uint16_t* const> rows,
                      std::size_t begin, std::size_t end, std::uint16_t* out) {
  const hn::CappedTag<std::int32_t, 16> sums;
  const hn::Rebind<std::uint16_t, decltype(sums)> channels;
  const std::size_t lanes = hn::Lanes(sums);
  if (lanes % 4 != 0) return begin;  // blocks are of whole pixels
  const auto opaque = hn::Set(channels, 65535), alpha = hn::Set(channels, 3);
  const auto is_color = hn::Ne(hn::And(hn::Iota(channels, 0), alpha), alpha);
  for (; begin + lanes <= end; begin += lanes) {
    auto all = opaque, any = hn::Zero(channels);
    auto sum = hn::Set(sums, 1 << (kWeightBits - 1));
    for (std::size_t t = 0; t < weights.size(); ++t) {
      const auto row = hn::LoadU(channels, rows[t] + begin);
      all = hn::And(all, row), any = hn::Or(any, row);
      sum = hn::Add(sum, hn::Mul(hn::PromoteTo(sums, row), hn::Set(sums, weights[t])));
    }
    const bool sums_hold = hn::AllTrue(channels, hn::Or(is_color, hn::Eq(all, opaque)));
    if (!sums_hold && !hn::AllTrue(channels, hn::Or(is_color, hn::Eq(any, hn::Zero(channels))))) break;
    const auto value = hn::DemoteTo(channels, hn::ShiftRight<kWeightBits>(sum));
    hn::StoreU(sums_hold ? value : hn::Zero(channels), channels, out + begin);
  }
  return begin;
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {
namespace {

HWY_EXPORT(SumBlocks);

std::uint16_t Clamp16(std::int64_t value) {
  return static_cast<std::uint16_t>(std::clamp<std::int64_t>(value, 0, 65535));
}

// One pixel, whatever its alpha.
void SumPixel(std::span<const std::int32_t> weights, std::span<const std::uint16_t* const> rows, std::size_t at,
              std::uint16_t* out) {
  std::int64_t sums[3] = {0, 0, 0}, alpha = 0;
  for (std::size_t t = 0; t < weights.size(); ++t) {
    const std::uint16_t* const pixel = rows[t] + at;
    const std::int64_t weight = std::int64_t(weights[t]) * pixel[3];
    alpha += weight;
    for (int c = 0; c < 3; ++c) sums[c] += weight * pixel[c];  // not divided yet, so that no precision is lost
  }
  out[at + 3] = Clamp16((alpha + (1 << (kWeightBits - 1))) >> kWeightBits);
  for (std::size_t c = 0; c < 3; ++c) out[at + c] = alpha > 0 ? Clamp16((sums[c] + alpha / 2) / alpha) : 0;
}

}  // namespace

void SumRows(std::span<const std::int32_t> weights, std::span<const std::uint16_t* const> rows, int width,
             std::uint16_t* out) {
  const std::size_t end = 4 * std::size_t(width);
  constexpr std::size_t kBeforeNext = 16;  // channels one by one before blocks are tried again
  for (std::size_t at = 0; at < end;) {
    at = HWY_DYNAMIC_DISPATCH(SumBlocks)(weights, rows, at, end, out);
    for (const std::size_t next = std::min(end, at + kBeforeNext); at < next; at += 4) SumPixel(weights, rows, at, out);
  }
}

}  // namespace scumble::internal
#endif
