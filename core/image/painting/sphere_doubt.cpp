#include "core/image/painting/sphere_doubt.h"

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

}  // namespace

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
