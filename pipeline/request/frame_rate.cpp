#include "pipeline/frame_rate.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace scumble {

Expected<FrameRate> ParseFrameRate(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto number = [](const std::string& part) {
    double value = 0;
    const auto [end, failure] = std::from_chars(part.data(), part.data() + part.size(), value);
    return failure == std::errc() && end == part.data() + part.size() ? value : 0.0;
  };
  const double above = number(text.substr(0, slash));
  const double below = slash == std::string::npos ? 1.0 : number(text.substr(slash + 1));
  if (!(above >= 0.001 && above <= 1e5 && below >= 1.0 && below <= 1e5)) {
    return UsageError("--fps " + text + ": expected frames a second, as 24, 23.976 or 24000/1001");
  }
  return FrameRate{static_cast<std::int64_t>(above * 1000.0 + 0.5), static_cast<std::int64_t>(below * 1000.0 + 0.5)};
}

FrameRate NearestFrameRate(double fps) {
  const auto distance = [fps](const FrameRate& rate) {
    return std::fabs(double(rate.numerator) / double(rate.denominator) - fps);
  };
  const FrameRate plain{static_cast<std::int64_t>(fps * 1000.0 + 0.5), 1000};
  if (fps > 100.0) return plain;  // N · 1000 would be more than ParseFrameRate takes
  const FrameRate television{static_cast<std::int64_t>(fps * 1.001 + 0.5) * 1'000'000, 1'001'000};
  return television.numerator > 0 && distance(television) < distance(plain) ? television : plain;
}

std::string FrameRateToText(const FrameRate& rate) {
  const auto number = [](std::int64_t thousandths) { return fmt::format("{}", double(thousandths) / 1000.0); };
  return number(rate.numerator) + (rate.denominator == 1000 ? "" : "/" + number(rate.denominator));
}

double SecondsAt(int frame, const FrameRate& rate) {
  const double seconds = static_cast<double>(frame * rate.denominator) / static_cast<double>(rate.numerator);
  return static_cast<double>(static_cast<float>(seconds));
}

}  // namespace scumble
