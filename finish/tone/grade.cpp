#include <algorithm>

#include "core/filter/wide_loops.h"
#include "finish/tone/point_effect.h"

namespace scumble::internal {

LabColor ToOklab(const Rgb16& color) {
  const std::uint16_t texel[4] = {color[0], color[1], color[2], 65535};
  OklabBlock block;
  OklabFromTexels(texel, 1, block);
  return {block.lightness[0], block.a[0], block.b[0]};
}

namespace {

SCUMBLE_WIDE_LOOPS void Grade(float saturation, float contrast, float lift, std::size_t count, OklabBlock& block) {
  for (std::size_t i = 0; i < count; ++i) {
    const float graded = 0.5f + (block.lightness[i] - 0.5f) * contrast + lift;
    block.lightness[i] = graded < 0.0f ? 0.0f : 1.0f < graded ? 1.0f : graded;
    block.a[i] *= saturation;
    block.b[i] *= saturation;
  }
}

}  // namespace

PointEffect MakeGrade(const GradePass& pass) {
  const auto saturation = static_cast<float>(pass.saturation), contrast = static_cast<float>(pass.contrast),
             lift = static_cast<float>(pass.lift);
  return [=](std::size_t, std::size_t count, OklabBlock& block) { Grade(saturation, contrast, lift, count, block); };
}

PointEffect MakeFill(const FillPass& pass) {
  const LabColor color = ToOklab(pass.color);
  return [=](std::size_t, std::size_t count, OklabBlock& block) {
    std::fill_n(block.lightness.begin(), count, color.lightness);
    std::fill_n(block.a.begin(), count, color.a);
    std::fill_n(block.b.begin(), count, color.b);
  };
}

}  // namespace scumble::internal
