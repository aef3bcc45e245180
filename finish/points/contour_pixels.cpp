#include "finish/points/contour_pixels.h"

#include <algorithm>

#include "core/filter/wide_loops.h"
#include "core/image/scalar_lane.h"

namespace scumble::internal {
namespace {

constexpr float kLeastShare = 1.0f / 32.0f;  // less does not show

// Codes of 16 bits towards others, in linear light, as far as the share says.
SCUMBLE_WIDE_LOOPS void MixCodes(const float* shares, const std::uint16_t* others, std::size_t count,
                                 std::uint16_t* codes) {
  for (std::size_t i = 0; i < count; ++i) {
    const float from = scalar::LinearFromCode(codes[i]), to = scalar::LinearFromCode(others[i]);
    codes[i] = scalar::Rounded(scalar::ClampedCode(from + (to - from) * shares[i]));
  }
}

void Put(const Batch& batch, std::span<const Texel> made, Picture& picture) {
  std::vector<std::uint16_t> own, beyond;
  std::vector<float> shares;
  for (std::size_t i = 0; i < made.size(); ++i) {
    const auto texel = picture.rgba.begin() + 4 * std::ptrdiff_t(batch.parts[i].pixel);
    own.insert(own.end(), texel, texel + 3);
    beyond.insert(beyond.end(), made[i].begin(), made[i].begin() + 3);
    shares.insert(shares.end(), 3, batch.parts[i].share);
  }
  MixCodes(shares.data(), beyond.data(), own.size(), own.data());
  for (std::size_t i = 0; i < made.size(); ++i)
    std::copy_n(own.data() + 3 * i, 3, picture.rgba.data() + 4 * batch.parts[i].pixel);
}

bool MayChange(const FinishStep& step, std::size_t pixel) {
  return (step.only.empty() || step.only[pixel] != 0) && (step.share.empty() || step.share[pixel] != 0);
}

}  // namespace

ContourPixels::ContourPixels(std::span<const PointStep> steps, const FinishFrame& frame) : steps_(steps) {
  for (const PointStep& one : steps) {
    for (const HardLight& light : one.lights) {
      if (!IsOfGuides(*one.step)) contours_.push_back({one, LightContour(light, *frame.guides)});
    }
  }
}

void ContourPixels::PaintRow(const GivenRow& row, Picture& picture) const {
  std::array<Batch, 2> batches;  // mixed in one after the other
  std::vector<std::uint8_t> is_known(contours_.size() > 1 ? row.width() : 0);
  for (const Contour& contour : contours_) {
    contour.light.ForEachInRow(row.y, [&](int x, std::uint32_t sides) {
      const std::size_t pixel = row.first + std::size_t(x);
      if (!MayChange(*contour.step.step, pixel) || row.Of(pixel)[3] == 0) return;
      if (!is_known.empty() && is_known[std::size_t(x)] != 0) return;
      const auto both = contour.light.BeyondOf(x, row.y, sides);
      for (std::size_t k = 0; k < 2 && both[k].share >= kLeastShare; ++k) {
        if (!is_known.empty()) is_known[std::size_t(x)] = 1;
        batches[k].parts.push_back({pixel, both[k].pixel, both[k].share, row.Of(pixel)[3]});
        batches[k].paint.push_back(row.Of(pixel));
      }
    });
  }
  for (const Batch& batch : batches) Put(batch, PaintParts(steps_, batch), picture);
}

}  // namespace scumble::internal
