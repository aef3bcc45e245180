#include "transfer/exemplar/illumination.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/image/color.h"
#include "core/image/exact_math.h"

namespace scumble {

Illumination::Illumination(std::span<const double> luminances, float weight, LuminanceError form)
    : luminances_(luminances.begin(), luminances.end()), weight_(weight), form_(form) {
  for (const float one : luminances_) brightest_ = std::max(brightest_, one);
  std::vector<float> rising = luminances_;
  std::ranges::sort(rising);
  for (std::size_t k = 1; k < rising.size(); ++k) {
    if (rising[k - 1] < rising[k]) borders_.push_back(0.5f * (rising[k - 1] + rising[k]));
  }
}

int Illumination::Choose(float luminance) const {
  luminance = Clamped(luminance);
  int best = 0;
  for (int k = 1; k < static_cast<int>(luminances_.size()); ++k) {
    if (std::fabs(luminance - luminances_[k]) < std::fabs(luminance - luminances_[best])) best = k;
  }
  return best;
}

float Illumination::Error(float luminance, int chosen) const {
  if (!active() || !(weight_ > 0.0f)) return 0.0f;
  if (form_ == LuminanceError::kPublished) {
    return weight_ * std::fabs((luminance >= 0.0f ? luminance : 0.0f) - luminances_[chosen]);
  }
  luminance = Clamped(luminance);
  const float off = std::fabs(luminance - luminances_[chosen]);
  const float excess = off - std::fabs(luminance - luminances_[Choose(luminance)]);
  // A weight of infinity cuts exactly where the best exemplar changes; infinity times 0 would be NaN.
  return excess > 0.0f ? weight_ * excess : 0.0f;
}

double MeasuredLuminance(const Picture& picture, double rim) {
  const double radius = 0.5 * picture.width - rim;
  std::vector<std::uint8_t> disc(std::size_t(picture.width) * picture.height);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double dx = x + 0.5 - 0.5 * picture.width, dy = y + 0.5 - 0.5 * picture.height;
      disc[std::size_t(y) * picture.width + x] = dx * dx + dy * dy <= radius * radius;
    }
  }
  return MeasuredLuminance(picture, disc);
}

double MeasuredLuminance(const Picture& picture, std::span<const std::uint8_t> mask) {
  double sum = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!mask[i]) continue;
    const std::uint16_t* texel = picture.rgba.data() + 4 * i;
    sum += static_cast<double>(texel[3]) *
           Luminance(Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2]));
    weight += texel[3];
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

namespace {

// The light of covered pixels as the bits of floats of 0 or more, which order as the values do.
class CoveredLight {
 public:
  CoveredLight(const GuideSet& guides, Layer layer) : coverage_(guides.Plane(Layer::kCoverage)) {
    for (int c = 0; c < 3; ++c) channels_[c] = guides.Plane(layer, ChannelCount(layer) == 3 ? c : 0);
    is_color_ = ChannelCount(layer) == 3;
  }

  // Calls the function that visit() returns with the bits of every covered pixel; from several threads, each with a
  // function of its own.
  template <class Visit>
  void ForEach(const Visit& visit) const {
    constexpr std::size_t kPixels = 1 << 15;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, coverage_.size(), kPixels), [&](const auto& range) {
      const auto own = visit();
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        if (coverage_[i] > 0.0f) own(BitsAt(i));
      }
    });
  }

 private:
  std::uint32_t BitsAt(std::size_t i) const {
    const float light = is_color_ ? Luminance(channels_[0][i], channels_[1][i], channels_[2][i]) : channels_[0][i];
    return light > 0.0f ? std::bit_cast<std::uint32_t>(light) : 0;
  }

  std::span<const float> coverage_;
  std::span<const float> channels_[3];
  bool is_color_ = false;
};

}  // namespace

// First a histogram of the upper bits, then one of the lower bits for those with the wanted upper bits.
double BrightPercentile(const GuideSet& guides, Layer layer) {
  constexpr int kLowerBits = 20;
  const CoveredLight light(guides, layer);
  struct Counts {
    std::array<std::size_t, (1u << (32 - kLowerBits))> of{};
  };
  tbb::enumerable_thread_specific<Counts> counted;
  light.ForEach([&] { return [&counts = counted.local().of](std::uint32_t bits) { ++counts[bits >> kLowerBits]; }; });
  Counts counts;
  std::size_t total = 0;
  for (const Counts& some : counted) {
    for (std::size_t i = 0; i < counts.of.size(); ++i) counts.of[i] += some.of[i], total += some.of[i];
  }
  if (total == 0) return 0.0;
  // Nearest rank: the smallest value that 90% of the pixels do not exceed.
  std::size_t rank = (total * 9 + 9) / 10 - 1;
  std::uint32_t upper = 0;
  while (rank >= counts.of[upper]) rank -= counts.of[upper++];
  tbb::enumerable_thread_specific<std::vector<std::uint32_t>> gathered;
  light.ForEach([&] {
    return [&values = gathered.local(), upper](std::uint32_t bits) {
      if (bits >> kLowerBits == upper) values.push_back(bits);
    };
  });
  std::vector<std::uint32_t> candidates;
  for (const auto& some : gathered) candidates.insert(candidates.end(), some.begin(), some.end());
  const auto place = candidates.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(candidates.begin(), place, candidates.end());
  return std::bit_cast<float>(*place);
}

double MeasureExposure(const GuideSet& guides, std::span<const float> luminances, Layer layer) {
  const float brightest = luminances.empty() ? 0.0f : *std::max_element(luminances.begin(), luminances.end());
  if (!(brightest > 0.0f)) return 0.0;
  const double bright = BrightPercentile(guides, layer);
  if (!(bright > 0.0 && std::isfinite(bright))) return 0.0;
  return std::round(100.0 * Log2(static_cast<double>(brightest) / bright)) / 100.0;
}

}  // namespace scumble
