#include "finish/ink_layer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace scumble::internal {
namespace {

using Color = std::array<double, 3>;

constexpr double kPromise = 1.0 / 255.0;  // more shows

Color ColorOf(const std::uint16_t* texel) { return {texel[0] / 65535.0, texel[1] / 65535.0, texel[2] / 65535.0}; }

// A pixel of the layer: how much of it shows over `below`, whose share of the sum is `rest` · (1 - share). That is its
// alpha where the layer raises it, and 1 where it does not.
struct InkedPixel {
  Color below{}, target{};
  double rest = 1.0, target_alpha = 1.0;

  Color Over(const Color& ink, double share) const {
    const double sum = share + rest * (1.0 - share);
    Color color = below;
    for (std::size_t c = 0; c < 3 && sum > 0.0; ++c)
      color[c] = (ink[c] * share + below[c] * rest * (1.0 - share)) / sum;
    return color;
  }
  double Error(const Color& ink, double share) const {
    const Color got = Over(ink, share);
    double error = 0.0;
    for (std::size_t c = 0; c < 3; ++c) error = std::max(error, std::abs(got[c] - target[c]));
    return error;
  }
  double AlphaOver(double share) const { return share + rest * (1.0 - share); }
  // What the sum is off by as it shows.
  double Off(const Color& color, double share) const {
    const double alpha = rest == 1.0 ? target_alpha : AlphaOver(share);
    double off = std::abs(alpha - target_alpha);
    for (std::size_t c = 0; c < 3; ++c) off = std::max(off, std::abs(color[c] * alpha - target[c] * target_alpha));
    return off;
  }
  // The share in steps. If the nearest one is off in alpha by more than half a step, as alpha below is rounded, too,
  // the share is rounded the other way.
  double SteppedShare(double share, double most) const {
    const auto off = [&](double of_share) { return std::abs(AlphaOver(of_share) - target_alpha); };
    const double nearest = std::floor(share * most + 0.5) / most;
    if (rest == 1.0 || off(nearest) <= 0.5 / most) return nearest;
    const double other = nearest > share ? std::floor(share * most) / most : std::ceil(share * most) / most;
    return off(other) < off(nearest) ? other : nearest;
  }
  // The ink of this share that leads to the target, if there were colours above 1 and below 0.
  Color InkFor(double share) const {
    Color ink = target;
    for (std::size_t c = 0; c < 3; ++c) ink[c] += (target[c] - below[c]) * rest * (1.0 - share) / share;
    return ink;
  }
  // The least share whose ink is a colour.
  double LeastShare() const {
    double reach = 1e9;  // how many times the way from `below` to the target leads on to the edge of all colours
    for (std::size_t c = 0; c < 3; ++c) {
      const double way = target[c] - below[c];
      if (way != 0.0) reach = std::min(reach, (way > 0.0 ? 1.0 - target[c] : target[c]) / std::abs(way));
    }
    return rest / (rest + reach);
  }
  // The share of this ink that comes nearest to the target.
  double ShareOf(const Color& ink) const {
    double along = 0.0, length = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      along += (target[c] - below[c]) * (ink[c] - below[c]);
      length += (ink[c] - below[c]) * (ink[c] - below[c]);
    }
    return length > 0.0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
  }
};

struct Solved {
  Color ink{};
  double share = 0.0;
};

// In steps of 1 / `most`.
Solved Solve(const InkedPixel& pixel, const std::optional<Color>& ink, std::optional<double> given, double most) {
  // In 8 bits so little that with the picture's own rounding it stays below a step; in 16, what sums of floats leave.
  const double near_enough = most < 256.0 ? 0.45 / most : 2.0 / most;
  const auto stepped = [&](double value) { return std::floor(std::clamp(value, 0.0, 1.0) * most + 0.5) / most; };
  const bool raises = pixel.rest < 1.0;
  double share = pixel.SteppedShare(given ? *given : ink ? pixel.ShareOf(*ink) : pixel.LeastShare(), most);
  if (ink && pixel.Error(*ink, share) <= near_enough) return {*ink, share};
  const auto best = [&](double of_share) {
    Color color = pixel.InkFor(of_share);
    for (double& channel : color) channel = stepped(channel);
    return color;
  };
  if (share > 0.0) {
    const Color color = best(share);
    if (raises || pixel.Error(color, share) <= near_enough) return {color, share};
  } else if (raises || pixel.Error({}, 0.0) <= near_enough) {
    return {};
  }
  share = std::min(1.0, std::max(share, std::ceil(pixel.LeastShare() * most) / most));
  return share > 0.0 ? Solved{best(share), share} : Solved{};
}

}  // namespace

bool LaysInk(const FinishPass& pass) {
  const auto* edges = std::get_if<EdgesPass>(&pass.effect);
  return std::holds_alternative<OutlinePass>(pass.effect) || std::holds_alternative<HatchPass>(pass.effect) ||
         (edges && edges->draw == EdgesPass::Draw::kInk);
}

InkLayer InkBetween(const InkChange& change, int most, Picture& below) {
  InkLayer layer{Picture(below.width, below.height), false};
  const std::size_t count = below.rgba.size() / 4;
  const auto is_inked = [&](std::size_t i) {
    return !std::equal(&change.before.rgba[4 * i], &change.before.rgba[4 * i] + 4, &change.after.rgba[4 * i]);
  };
  std::atomic<bool> raises = false, is_open = false;  // alpha; and some ink is where not all is covered
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1 << 14), [&](const auto& part) {
    for (std::size_t i = part.begin(); i != part.end(); ++i) {
      if (!is_inked(i)) continue;
      if (change.before.rgba[4 * i + 3] != change.after.rgba[4 * i + 3]) raises = true;
      if (change.target.rgba[4 * i + 3] != 65535) is_open = true;
    }
  });
  layer.atop = is_open && !raises;
  std::atomic<bool> misses = false;
  std::optional<Color> ink;
  if (change.ink) ink = ColorOf(change.ink->data());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1 << 12), [&](const auto& part) {
    for (std::size_t i = part.begin(); i != part.end(); ++i) {
      if (!is_inked(i)) continue;
      std::uint16_t* const under = &below.rgba[4 * i];
      const double alpha = under[3] / 65535.0;
      const InkedPixel pixel{ColorOf(under), ColorOf(&change.target.rgba[4 * i]), layer.atop ? 1.0 : alpha,
                             change.target.rgba[4 * i + 3] / 65535.0};
      std::optional<double> share;
      if (!change.shares.empty()) share = change.shares[i] / 65535.0;
      const Solved solved = Solve(pixel, ink, share, most);
      if (!(solved.share > 0.0)) {
        if (pixel.Off(pixel.below, 0.0) > kPromise) misses = true;
        continue;
      }
      std::uint16_t* const texel = &layer.picture.rgba[4 * i];
      const Color color = pixel.Over(solved.ink, solved.share);
      if (pixel.Off(color, solved.share) > kPromise) misses = true;
      for (std::size_t c = 0; c < 3; ++c) {
        texel[c] = static_cast<std::uint16_t>(std::floor(solved.ink[c] * most + 0.5) * (65535 / most));
        under[c] = static_cast<std::uint16_t>(color[c] * 65535.0 + 0.5);
      }
      texel[3] = static_cast<std::uint16_t>(std::floor(solved.share * most + 0.5) * (65535 / most));
      if (!layer.atop)
        under[3] = static_cast<std::uint16_t>((solved.share + alpha * (1.0 - solved.share)) * 65535.0 + 0.5);
    }
  });
  layer.reaches_target = !misses;
  return layer;
}

}  // namespace scumble::internal
