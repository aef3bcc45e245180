#include "exemplars/paint/drawing.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "exemplars/paint/sphere.h"
#include "image/color.h"

namespace scumble::paint {
namespace {
constexpr float kSquint = 13.0f;     // radius of the blur
constexpr float kEagerness = 4.0f;   // a tenth too light is met with 0.4 of full pressure
constexpr float kOverhang = 1.045f;  // strokes fade out at this many radii
}  // namespace

Drawing::Drawing(Colors ground, Field tooth, const DryMedia& media)
    : ground_(std::move(ground)), tooth_(std::move(tooth)), media_(media), canvas_(ground_.sheet) {}

Colors Drawing::Look() const {
  Colors picture = ground_;
  RubInto(picture, canvas_.Read(), tooth_, media_);
  return picture;
}

Touch Drawing::Missing(const Touch& target, float eagerness, float heaviest) const {
  const Colors picture = Look();
  Field darkness(picture.sheet);
  for (std::size_t i = 0; i < darkness.pixels.size(); ++i) {
    const glm::vec3 color = picture.pixels[i];
    darkness.pixels[i] = 1.0f - Luminance(color.r, color.g, color.b);
  }
  const auto seen = std::make_shared<const Field>(Blur(darkness, kSquint));
  return [=](glm::vec2 at) {
    const float scale = static_cast<float>(seen->size) / kSide;
    const float there = seen->Near(static_cast<int>(at.x * scale), static_cast<int>(at.y * scale));
    const float pressure = std::min(eagerness * (target(at) - there), heaviest);
    return pressure * Ramp(kOverhang, kOverhang - 0.03f, RimDistance(at));
  };
}

void HatchRound(Drawing& drawing, Brush& brush, Chance& chance, const Touch& target, const Round& round) {
  const Touch partial = [&](glm::vec2 at) { return round.share * target(at); };
  const Touch touch = drawing.Missing(partial, kEagerness, round.heaviest);
  brush.Paint(drawing.canvas(), PlanHatching(chance, AroundAxis, round.axis, touch, round.hatch));
}

}  // namespace scumble::paint
