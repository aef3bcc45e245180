#include <algorithm>
#include <array>

#include "core/filter/wide_loops.h"
#include "finish/tone/point_effect.h"
#include "finish/tone/sigmoid.h"

namespace scumble::internal {
namespace {

// Steps of so little sharpness are straight lines, to half a code of 16 bits.
constexpr float kStraight = 0.01f;

// Soft steps of Winnemöller, Olsen and Gooch ("Real-Time Video Abstraction", 2006, section 3.2), with three changes:
// the sigmoid is no tanh (finish/tone/sigmoid.h), the first level is black and the last is white, and the curve of each
// step is stretched so that it meets the next one. It is continuous and rises; levels and the middles between them
// keep their lightness.
SCUMBLE_WIDE_LOOPS void TakeSoftSteps(int levels, float sharpness, std::size_t count, float* lightness) {
  const float steps = static_cast<float>(levels - 1), width = 1.0f / steps,
              half_per_sigmoid = 0.5f / Sigmoid(sharpness);
  const int last = levels - 2;
  for (std::size_t i = 0; i < count; ++i) {
    const float given = lightness[i] > 0.0f ? lightness[i] < 1.0f ? lightness[i] : 1.0f : 0.0f;
    const float at = given * steps;
    const int under = static_cast<int>(at), step = under < last ? under : last;
    const float middle = static_cast<float>(step) + 0.5f;
    lightness[i] = (middle + half_per_sigmoid * Sigmoid(2.0f * sharpness * (at - middle))) * width;
  }
}

}  // namespace

PointEffect MakeTones(const TonesPass& pass, std::span<const float> light) {
  return [levels = pass.bins, sharpness = static_cast<float>(pass.sharpness), light](
             std::size_t first, std::size_t count, OklabBlock& block) {
    if (!(sharpness > kStraight)) return;
    if (light.empty()) return TakeSoftSteps(levels, sharpness, count, block.lightness.data());
    // The paint takes what the step adds to the light.
    std::array<float, kOklabBlock> stepped;
    std::copy_n(light.data() + first, count, stepped.begin());
    TakeSoftSteps(levels, sharpness, count, stepped.data());
    for (std::size_t i = 0; i < count; ++i)
      block.lightness[i] = std::clamp(block.lightness[i] + (stepped[i] - light[first + i]), 0.0f, 1.0f);
  };
}

}  // namespace scumble::internal
