#include "exemplars/paint/engine/drawing.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/image/color.h"
#include "exemplars/paint/sphere.h"

namespace scumble::paint {
namespace {
constexpr float kToneBlur = 13.0f;   // radius of the blur
constexpr float kEagerness = 4.0f;   // an error of a tenth in tone gets 0.4 of full pressure
constexpr float kOverhang = 1.045f;  // strokes fade out at this many radii
}  // namespace

Drawing::Drawing(Ground ground, const DryMedia& media)
    : ground_(std::move(ground)), media_(media), canvas_(ground_.paper.sheet) {}

Colors Drawing::Look() const {
  Colors picture = ground_.paper;
  RubInto(picture, canvas_.Read(), ground_.tooth, media_);
  return picture;
}

Touch Drawing::Missing(const Touch& target, float eagerness, float heaviest) const {
  const Colors picture = Look();
  Field darkness(picture.sheet);
  for (std::size_t i = 0; i < darkness.pixels.size(); ++i) {
    const glm::vec3 color = picture.pixels[i];
    darkness.pixels[i] = 1.0f - Luminance(color.r, color.g, color.b);
  }
  const auto seen = std::make_shared<const Field>(Blur(darkness, kToneBlur));
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

void HatchRounds(Drawing& drawing, Brush& brush, std::uint64_t seed, std::uint64_t first_stream, const Touch& target,
                 const Rounds& rounds) {
  for (int i = 0; i < rounds.count; ++i) {
    Chance chance(seed, first_stream + static_cast<std::uint64_t>(i));
    const float progress = rounds.count > 1 ? static_cast<float>(i) / static_cast<float>(rounds.count - 1) : 1.0f;
    HatchRound(drawing, brush, chance, target,
               {rounds.axes[static_cast<std::size_t>(i) % rounds.axes.size()],
                glm::mix(rounds.share.x, rounds.share.y, progress),
                glm::mix(rounds.heaviest.x, rounds.heaviest.y, progress), rounds.hatch});
  }
}

Status Smudge(Drawing& drawing, const Studio& studio, std::uint64_t stream, glm::vec3 axis, const Touch& touch) {
  SCUMBLE_ASSIGN(Brush finger, Brush::Load(studio.brushes, "deevad/blending"));
  finger.Radius(15.0f);
  Chance chance(studio.seed, stream);
  HatchOptions hatch;
  hatch.patches = 160;
  hatch.strokes_min = 2;
  hatch.strokes_max = 4;
  hatch.spacing = 24.0f;
  hatch.length_min = 60.0f;
  finger.Paint(drawing.canvas(), PlanHatching(chance, AroundAxis, axis, touch, hatch));
  return Ok();
}

}  // namespace scumble::paint
