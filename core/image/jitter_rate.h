// How often what is left to chance is drawn again.
#pragma once

#include <cmath>
#include <cstdint>

namespace scumble {

inline constexpr double kMostJitterFps = 1000.0;

// Which draw a frame has, of jitter_fps draws a second: floor(frame · jitter_fps / fps) in integers, fps = numerator /
// denominator. It is equal for a frame however a range is cut. 0 for jitter_fps 0 (frozen), the frame itself for -1.
// jitter_fps is rounded to thousandths.
inline std::int64_t JitterStep(double jitter_fps, std::int64_t frame, std::int64_t fps_numerator,
                               std::int64_t fps_denominator) {
  if (jitter_fps == 0.0) return 0;
  if (jitter_fps < 0.0) return frame;
  // 128 bits: frame numbers that contain a date, times a rate in thousandths, exceed 64.
  __extension__ using Int128 = __int128;
  const Int128 numerator = static_cast<Int128>(frame) * std::llround(jitter_fps * 1000.0) * fps_denominator;
  const Int128 denominator = static_cast<Int128>(fps_numerator) * 1000;
  const Int128 quotient = numerator / denominator;
  return static_cast<std::int64_t>(numerator % denominator < 0 ? quotient - 1 : quotient);
}

}  // namespace scumble
