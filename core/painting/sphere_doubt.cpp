#include "core/painting/sphere_doubt.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/image/color.h"

namespace scumble {
namespace {

constexpr double kShadowReach = 1.7;    // of the radius: a shadow lies within, and a second sphere does not
constexpr double kLeastShadow = 0.04;   // of all directions, in which a shadow touches the sphere
constexpr double kTogether = 0.6;       // the mean of those directions' unit vectors, at least
constexpr double kBelow = 0.5;          // of that mean's length: how far it points down
constexpr double kMostlyDarker = 0.9;   // of the pixels beyond the circle
constexpr double kLeastUneven = 0.04;   // of the circle's area, beyond it
constexpr double kFaint = 0.5;          // mean opacity of uneven ground
constexpr float kDarkOnNothing = 0.2f;  // linear luminance of a shadow that lies on transparency
constexpr double kGapOfTouch = 2.0;     // pixels beyond the tolerance

// The paint beyond a radius.
struct Beyond {
  double count = 0.0, darker = 0.0, near = 0.0, opacity = 0.0;
};

Beyond PaintBeyond(const Picture& picture, const PaintMask& mask, const Circle& circle, double radius) {
  const BarePaper& ground = mask.ground();
  const bool is_paper = ground.kind == BarePaper::Kind::kPaper;
  const float least = is_paper ? Luminance(ground.color.x, ground.color.y, ground.color.z) : kDarkOnNothing;
  Beyond beyond;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (!mask.values()[std::size_t(y) * std::size_t(mask.width()) + std::size_t(x)]) continue;
      const double dx = x + 0.5 - circle.x, dy = y + 0.5 - circle.y, distance = std::sqrt(dx * dx + dy * dy);
      if (distance <= radius) continue;
      const std::uint16_t* const texel = picture.At(x, y);
      std::uint16_t lifted[4];
      std::copy_n(texel, 4, lifted);
      LiftPaint(ground, lifted);
      beyond.count += 1.0;
      beyond.opacity += lifted[3] / 65535.0;
      beyond.near += distance <= kShadowReach * circle.radius;
      beyond.darker += Luminance(Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])) < least;
    }
  }
  return beyond;
}

// Whether paint just beyond the circle lies together below it.
bool TouchesBelow(const PaintMask& mask, const Circle& circle, double radius) {
  glm::dvec2 sum(0.0);
  double count = 0.0;
  for (int i = 0; i < kOutlineDirections; ++i) {
    const glm::dvec2 direction = OutlineDirection(i);
    const double at_x = circle.x + radius * direction.x, at_y = circle.y + radius * direction.y;
    if (at_x < 0.0 || at_y < 0.0 || at_x >= mask.width() || at_y >= mask.height()) continue;
    const auto x = static_cast<std::size_t>(at_x), y = static_cast<std::size_t>(at_y);
    if (mask.values()[y * std::size_t(mask.width()) + x]) sum += direction, count += 1.0;
  }
  if (count < kLeastShadow * kOutlineDirections) return false;
  const double length = std::sqrt(glm::dot(sum, sum));
  return length > kTogether * count && sum.y > kBelow * length;
}

// The bands to either side of the circle whose colours are compared.
constexpr double kLeastStepGap = 2.0, kStepGap = 0.01;    // pixels, of the radius: from the circle to a band
constexpr double kLeastStepBand = 3.0, kStepBand = 0.02;  // pixels, of the radius: a band's width
constexpr int kStepSectors = 36;
constexpr double kLeastStep = 6.0 * 257.0;  // of 65535, between the means of the bands in a sector
constexpr double kLeastStepSectors = 0.2;   // of the sectors: on the side of the light, paint may be as light as paper

// Adds a picture's colours from `first` to `last` on a ray from the circle's middle.
void AddBand(const Picture& picture, const Circle& circle, int direction, double first, double last, glm::dvec4& sum) {
  const glm::dvec2 step = OutlineDirection(direction);
  for (double distance = first; distance <= last; distance += 1.0) {
    const double x = circle.x + distance * step.x, y = circle.y + distance * step.y;
    if (x < 0.0 || y < 0.0 || x >= picture.width || y >= picture.height) continue;
    const std::uint16_t* const texel = picture.At(static_cast<int>(x), static_cast<int>(y));
    sum += glm::dvec4(texel[0], texel[1], texel[2], 1.0);
  }
}

}  // namespace

bool HasColorStep(const Picture& picture, const Circle& circle) {
  const double gap = std::max(kLeastStepGap, kStepGap * circle.radius);
  const double band = std::max(kLeastStepBand, kStepBand * circle.radius);
  constexpr int kDirections = kOutlineDirections / kStepSectors;
  int seen = 0, steps = 0;
  for (int sector = 0; sector < kStepSectors; ++sector) {
    glm::dvec4 inside(0.0), outside(0.0), line(0.0);
    for (int i = sector * kDirections; i < (sector + 1) * kDirections; ++i) {
      AddBand(picture, circle, i, circle.radius - gap - band, circle.radius - gap, inside);
      AddBand(picture, circle, i, circle.radius + gap, circle.radius + gap + band, outside);
      AddBand(picture, circle, i, circle.radius - gap, circle.radius, line);
    }
    if (inside.w == 0.0 || outside.w == 0.0) continue;
    // A drawn line is a step by itself, where it is thinner than what lies between the bands.
    const auto is_step = [&](const glm::dvec4& from) {
      const glm::dvec3 apart = glm::abs(glm::dvec3(from) / from.w - glm::dvec3(outside) / outside.w);
      return from.w > 0.0 && std::max({apart.x, apart.y, apart.z}) >= kLeastStep;
    };
    ++seen, steps += is_step(inside) || is_step(line);
  }
  return steps >= kLeastStepSectors * seen;
}

SphereDoubt DoubtAbout(const Picture& picture, const PaintMask& mask, const Circle& circle, double tolerance) {
  const double radius = circle.radius + tolerance + kGapOfTouch;
  const Beyond beyond = PaintBeyond(picture, mask, circle, radius);
  if (!(beyond.count > 0.0)) return SphereDoubt::kNoCircle;
  const bool is_shadow = beyond.near > kMostlyDarker * beyond.count && beyond.darker > kMostlyDarker * beyond.count;
  if (is_shadow && TouchesBelow(mask, circle, radius)) return SphereDoubt::kShadow;
  const bool is_wide = beyond.count > kLeastUneven * std::numbers::pi * circle.radius * circle.radius;
  const bool is_faint = mask.ground().kind == BarePaper::Kind::kPaper && beyond.opacity < kFaint * beyond.count;
  return is_wide && is_faint ? SphereDoubt::kUnevenGround : SphereDoubt::kNoCircle;
}

}  // namespace scumble
