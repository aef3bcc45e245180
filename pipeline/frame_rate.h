// Frames a second, and the time at which a frame is seen.
#pragma once

#include <cstdint>
#include <string>

#include "core/image/status.h"

namespace scumble {

// A fraction in thousandths above and below, so that 23.976 and 24000/1001 are exact.
struct FrameRate {
  std::int64_t numerator = 24000;
  std::int64_t denominator = 1000;

  bool operator==(const FrameRate&) const = default;
};

// Reads "24", "23.976" or "24000/1001"; up to 1e5 above, and from 1 to 1e5 below. A kUsage error names --fps.
Expected<FrameRate> ParseFrameRate(const std::string& text);

// The rate of frames a second from 0.001 to 1e5: N · 1000/1001 where that is nearer than thousandths, as for
// 24000.0 / 1001, and N at most 100.
FrameRate NearestFrameRate(double fps);

// The shortest text that ParseFrameRate reads as this rate.
std::string FrameRateToText(const FrameRate& rate);

// When a frame is seen: frame / rate in seconds, rounded to float, because that is how files keep the times of their
// keys. A pose that jumps at a frame's key has jumped in that frame.
double SecondsAt(int frame, const FrameRate& rate);

}  // namespace scumble
