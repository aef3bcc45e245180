// Ink over paint.
#pragma once

#include <algorithm>
#include <cstdint>

namespace scumble::internal {

// Porter and Duff's "over" with straight alpha, on sRGB codes, as drawing programs do it. A line between two pixels
// then looks as dark as one that lies on a pixel.
inline void LayInk(const std::uint16_t* ink, std::uint16_t* pixel) {
  if (ink[3] == 65535) return static_cast<void>(std::copy_n(ink, 4, pixel));
  const float share = static_cast<float>(ink[3]) / 65535.0f;
  const float below = static_cast<float>(pixel[3]) / 65535.0f * (1.0f - share), alpha = share + below;
  for (int c = 0; c < 3; ++c) {
    const float code = (static_cast<float>(ink[c]) * share + static_cast<float>(pixel[c]) * below) / alpha;
    pixel[c] = static_cast<std::uint16_t>(code + 0.5f);
  }
  pixel[3] = static_cast<std::uint16_t>(std::min(65535.0f, alpha * 65535.0f + 0.5f));
}

}  // namespace scumble::internal
