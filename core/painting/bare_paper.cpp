#include "core/painting/bare_paper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/image/color.h"
#include "core/image/oklab.h"

namespace scumble {
namespace {

// Distances in Oklab: below the first is the paper's own grain, above the second is full paint.
constexpr float kGrain = 0.06f, kFullPaint = 0.30f;
constexpr float kUneven = 0.15f;  // paper may be lit this much otherwise from corner to corner
constexpr double kCornersFrom = 1.15, kMostPaintInCorners = 0.25;

glm::vec3 Linear(const std::uint16_t* texel) {
  return {Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])};
}

float SmoothStep(float from, float to, float value) {
  const float t = std::clamp((value - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

bool InCorner(const Picture& picture, int x, int y) {
  // In a picture that is no square, of the ellipse that fills it.
  const double aspect = static_cast<double>(picture.width) / picture.height;
  const double dx = 2.0 * x + 1 - picture.width, dy = (2.0 * y + 1 - picture.height) * aspect;
  return std::sqrt(dx * dx + dy * dy) >= kCornersFrom * picture.width;
}

template <class Visit>
void ForEachInCorners(const Picture& picture, const Visit& visit) {
  for (int y = 0; y < picture.height; ++y) {
    int left = 0, right = picture.width;
    for (; left < picture.width && InCorner(picture, left, y); ++left) visit(left, y);
    for (; right > left && InCorner(picture, right - 1, y); --right) visit(right - 1, y);
  }
}

glm::vec3 Median(std::vector<glm::vec3> colors) {
  glm::vec3 median(0.0f);
  const auto middle = colors.begin() + std::ptrdiff_t(colors.size() / 2);
  for (int c = 0; c < 3; ++c) {
    std::nth_element(colors.begin(), middle, colors.end(), [c](glm::vec3 a, glm::vec3 b) { return a[c] < b[c]; });
    median[c] = (*middle)[c];
  }
  return median;
}

// Of a linear colour and one of Oklab.
float Difference(glm::vec3 color, glm::vec3 oklab) {
  const glm::vec3 off = OklabFromLinear(color) - oklab;
  return std::sqrt(off.x * off.x + off.y * off.y + off.z * off.z);
}

// 0 for paper, 1 for paint that hides it.
float Opacity(glm::vec3 color, const BarePaper& paper) {
  return SmoothStep(kGrain, kFullPaint, Difference(color, paper.oklab));
}

// The sum of opacities of paint on that paper.
double PaintOn(const BarePaper& paper, const std::vector<glm::vec3>& colors) {
  double paint = 0.0;
  for (const glm::vec3 color : colors) paint += Opacity(color, paper);
  return paint;
}

// The colours of the opaque pixels in each corner.
std::array<std::vector<glm::vec3>, 4> OpaqueCorners(const Picture& picture) {
  std::array<std::vector<glm::vec3>, 4> corners;
  ForEachInCorners(picture, [&](int x, int y) {
    const std::uint16_t* texel = picture.At(x, y);
    if (texel[3] <= 32767) return;
    corners[(2 * x < picture.width ? 0 : 1) + (2 * y < picture.height ? 0 : 2)].push_back(Linear(texel));
  });
  return corners;
}

// The sum of alpha over the corners, and their pixels.
struct Corners {
  double alpha = 0.0, count = 0.0;
  explicit Corners(const Picture& picture) {
    ForEachInCorners(picture, [&](int x, int y) { alpha += picture.At(x, y)[3] / 65535.0, count += 1.0; });
  }
  bool AreClear() const { return count > 0.0 && alpha < kMostPaintInCorners * count; }
};

}  // namespace

BarePaper BarePaper::OfColor(glm::vec3 color) { return {Kind::kPaper, color, OklabFromLinear(color)}; }

bool HasClearCorners(const Picture& picture) { return Corners(picture).AreClear(); }

bool HasUnevenCorners(const Picture& picture) {
  std::array<BarePaper, 4> papers;
  const std::array<std::vector<glm::vec3>, 4> corners = OpaqueCorners(picture);
  for (std::size_t k = 0; k < 4; ++k) {
    if (corners[k].empty()) return false;
    papers[k] = BarePaper::OfColor(Median(corners[k]));
    if (PaintOn(papers[k], corners[k]) >= kMostPaintInCorners * static_cast<double>(corners[k].size())) return false;
  }
  return std::ranges::any_of(papers,
                             [&](const BarePaper& paper) { return Difference(paper.color, papers[0].oklab) > kGrain; });
}

BarePaper FindBarePaper(const Picture& picture) {
  const Corners corners(picture);
  if (!(corners.count > 0.0)) return {};
  if (corners.AreClear()) return {BarePaper::Kind::kTransparent, glm::vec3(0.0f)};
  const double count = corners.count;
  std::vector<glm::vec3> colors;
  const std::array<std::vector<glm::vec3>, 4> by_corner = OpaqueCorners(picture);
  for (const std::vector<glm::vec3>& corner : by_corner) colors.insert(colors.end(), corner.begin(), corner.end());
  // A sheet that is half transparent is no paper.
  if (static_cast<double>(colors.size()) < (1.0 - kMostPaintInCorners) * count) return {};
  const BarePaper paper = BarePaper::OfColor(Median(colors));
  for (const std::vector<glm::vec3>& corner : by_corner) {
    if (!corner.empty() && Difference(Median(corner), paper.oklab) > kUneven) return {};
  }
  if (PaintOn(paper, colors) >= kMostPaintInCorners * static_cast<double>(colors.size())) return {};
  return paper;
}

void LiftPaint(const BarePaper& paper, std::uint16_t* texel) {
  if (paper.kind != BarePaper::Kind::kPaper) return;
  const glm::vec3 color = Linear(texel);
  const float by_distance = Opacity(color, paper);
  if (!(by_distance > 0.0f)) {
    texel[3] = 0;
    return;
  }
  // The least opacity at which black or white paint over the paper still makes this colour.
  float least = 0.0f;
  for (int c = 0; c < 3; ++c) {
    const float off = color[c] - paper.color[c], room = off < 0.0f ? paper.color[c] : 1.0f - paper.color[c];
    if (room > 0.0f) least = std::max(least, std::min(1.0f, std::fabs(off) / room));
  }
  // Beyond the grain, opacity rises to that value steadily, so that no grey speck appears abruptly.
  const float opacity = std::max(by_distance, least * std::min(1.0f, 4.0f * by_distance));
  for (int c = 0; c < 3; ++c) {
    texel[c] = Srgb16FromLinear(paper.color[c] + (color[c] - paper.color[c]) / opacity);
  }
  texel[3] = static_cast<std::uint16_t>(static_cast<float>(texel[3]) * opacity + 0.5f);
}

}  // namespace scumble
