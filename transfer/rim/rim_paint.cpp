#include "transfer/rim/rim_paint.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/filter/resample.h"
#include "core/painting/bare_paper.h"

namespace scumble {
namespace {

// The band around the rim, as a share of the radius.
constexpr double kBand = 0.035;
// Where the sphere touches the picture's sides, the paint outside it is taken from 30 degrees farther on: cosine and
// sine. It is blended into the picture's own paint over a share of the band.
constexpr double kOnCosine = 0.8660254037844386, kOnSine = 0.5, kBlendWidth = 0.25;
// The ring inside the rim that must be painted, and how much.
constexpr double kRingFrom = 0.93, kLeastPaintOnRing = 0.05;

using Texel = std::array<std::uint16_t, 4>;

double Length(double x, double y) { return std::sqrt(x * x + y * y); }

// a + (b - a) · share, colours weighted by alpha.
Texel Mixed(const std::uint16_t* a, const std::uint16_t* b, double share) {
  const double alpha_a = a[3] * (1.0 - share), alpha_b = b[3] * share, alpha = alpha_a + alpha_b;
  Texel mixed{};
  if (!(alpha > 0.0)) return mixed;
  for (int c = 0; c < 3; ++c) mixed[c] = static_cast<std::uint16_t>((a[c] * alpha_a + b[c] * alpha_b) / alpha + 0.5);
  mixed[3] = static_cast<std::uint16_t>(alpha + 0.5);
  return mixed;
}

// The paint of a ring without its paper, from and to these distances from the picture's middle, in pixels. Paint
// elsewhere stays as it is.
Picture LiftedRing(Picture picture, const BarePaper& paper, double from, double to) {
  const double half = 0.5 * picture.width;
  tbb::parallel_for(0, picture.height, [&](int y) {
    for (int x = 0; x < picture.width; ++x) {
      const double r = Length(x + 0.5 - half, y + 0.5 - half);
      if (r >= from && r <= to) LiftPaint(paper, picture.At(x, y));
    }
  });
  return picture;
}

}  // namespace

RimPaint::RimPaint(const Picture& picture, int size)
    : size_(size), band_(std::max(1, static_cast<int>(std::ceil(kBand * 0.5 * size)))), margin_(band_ + 2) {
  const BarePaper paper = FindBarePaper(picture);
  const int side = size + 2 * margin_;
  const double half = 0.5 * size;
  // Paint deeper inside is never used.
  const double from = half - 2.0 * band_ - 2.0;
  // Paint is lifted before it is resized: paper mixed into strokes of less than a pixel would pass for its own grain.
  constexpr double kFilterReach = 4.0;  // of the resized picture's pixels, beyond what is used
  const double unit = std::max(1.0, static_cast<double>(picture.width) / size);
  const double ratio = static_cast<double>(picture.width) / size;
  const Picture lifted = Resample(
      LiftedRing(picture, paper, ratio * from - kFilterReach * unit, ratio * (half + margin_) + kFilterReach * unit),
      size, size);
  const auto inside = [&](double x, double y) {
    const int u = std::clamp(static_cast<int>(std::floor(x + half)), 0, size - 1);
    const int v = std::clamp(static_cast<int>(std::floor(y + half)), 0, size - 1);
    return lifted.At(u, v);
  };
  const double ring = std::min(kRingFrom * half, half - 1.0);  // of a small sphere, too, some pixels lie on it
  paint_ = Picture(side, side);
  double paint = 0.0, count = 0.0;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double dx = x + 0.5 - 0.5 * side, dy = y + 0.5 - 0.5 * side, r = Length(dx, dy);
      if (r < from + 1.0 || r > half + band_ + 1.0) continue;
      Texel texel{};
      const double to_side = half - std::max(std::fabs(dx), std::fabs(dy));
      const double shown = r <= half ? 1.0 : std::clamp(to_side / std::max(1.0, kBlendWidth * band_), 0.0, 1.0);
      if (shown >= 1.0)
        std::copy_n(inside(dx, dy), 4, texel.begin());
      else
        texel = Mixed(inside(dx * kOnCosine - dy * kOnSine, dx * kOnSine + dy * kOnCosine), inside(dx, dy), shown);
      std::copy_n(texel.begin(), 4, paint_.At(x, y));
      if (r >= ring && r <= half) paint += texel[3] / 65535.0, count += 1.0;
    }
  }
  has_edge_ = paper.kind != BarePaper::Kind::kCovered && count > 0.0 && paint / count > kLeastPaintOnRing;
}

const std::uint16_t* RimPaint::At(int x, int y) const {
  static constexpr std::uint16_t kNothing[4] = {0, 0, 0, 0};
  if (static_cast<unsigned>(x) >= static_cast<unsigned>(paint_.width)) return kNothing;
  if (static_cast<unsigned>(y) >= static_cast<unsigned>(paint_.height)) return kNothing;
  return paint_.At(x, y);
}

void RimPaint::Add(float x, float y, std::uint64_t weight, Sum& sum) const {
  // In steps of 1/256 from the centre of the first texel.
  const float half = 0.5f * static_cast<float>(paint_.width) - 0.5f;
  const int u = static_cast<int>(std::floor((x + half) * 256.0f + 0.5f));
  const int v = static_cast<int>(std::floor((y + half) * 256.0f + 0.5f));
  for (int k = 0; k < 4; ++k) {
    const int right = k % 2, down = k / 2;
    const int across = right ? u & 255 : 256 - (u & 255), along = down ? v & 255 : 256 - (v & 255);
    const std::uint64_t share = weight * static_cast<std::uint64_t>(across * along);
    if (share == 0) continue;
    const std::uint16_t* texel = At((u >> 8) + right, (v >> 8) + down);
    for (int c = 0; c < 3; ++c) sum.color[c] += share * (std::uint64_t{texel[3]} * texel[c]);
    sum.opacity += share * texel[3], sum.weight += share;
  }
}

}  // namespace scumble
