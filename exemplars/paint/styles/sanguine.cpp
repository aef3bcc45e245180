// Red chalk on cream laid paper: rubbed half-tones, then open hatching, most of it along one diagonal of the hand; a
// deeper chalk for the core of the shade, and touches of white in the light.
#include "exemplars/paint/engine/drawing.h"
#include "exemplars/paint/engine/families.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kRibbed, 4.5f, {0.935f, 0.885f, 0.785f}, 0.045f};
constexpr glm::vec3 kRubbed{0.80f, 0.47f, 0.33f};
constexpr glm::vec3 kRed{0.71f, 0.27f, 0.14f};
constexpr glm::vec3 kDeep{0.45f, 0.11f, 0.05f};
constexpr glm::vec3 kWhite{0.995f, 0.985f, 0.955f};

enum Pass : std::uint64_t {
  kTone = kFirstStream,
  kSmudge,
  kContour,
  kAccents,
  kTouches,
  kFlat,
  kRedForm,
  kRedHand,
  kRedSteeper,
  kDeepHand,
  kDeepForm,
};

// The hand's own diagonal, nearly independent of the form, and lines that follow the form around the light.
constexpr glm::vec3 kHand{-0.68f, 0.72f, 0.12f};
constexpr glm::vec3 kSteeperHand{-0.82f, 0.55f, 0.16f};
constexpr glm::vec3 kForm{-0.42f, 0.50f, 0.76f};

float Dark(glm::vec2 at) { return DarknessAt(at); }

// A stick of that colour and breadth; less scattered than its preset, so that lines stay lines.
Expected<Brush> Stick(const Studio& studio, glm::vec3 color, float radius, float scatter) {
  SCUMBLE_ASSIGN(Brush stick, Brush::Load(studio.brushes, "tanda/charcoal-04"));
  stick.Radius(radius).Color(color).Set(MYPAINT_BRUSH_SETTING_OFFSET_BY_RANDOM, scatter);
  return stick;
}

// The side of the stick and a stump: the tone under the hatching, pressed into the hollows of the paper.
Status RubTone(Drawing& drawing, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush side, Stick(studio, kRubbed, 11.0f, 1.0f));
  Chance chance(studio.seed, kTone);
  const Touch touch = [](glm::vec2 at) {
    return 0.48f * Ramp(0.26f, 0.86f, Dark(at)) * Ramp(1.03f, 0.99f, RimDistance(at));
  };
  side.Paint(drawing.canvas(), PlanFamily(chance, kHand, touch, {.spacing = 13.0f, .overlap = 20.0f}));
  const Touch rub = [](glm::vec2 at) {
    return 0.35f * Ramp(0.33f, 0.55f, Dark(at)) * Ramp(1.0f, 0.97f, RimDistance(at));
  };
  return Smudge(drawing, studio, kSmudge, kHand, rub);
}

void Hatch(Drawing& drawing, Brush& chalk, const Studio& studio, std::uint64_t stream, const Swelling& family) {
  const SwellingHand hand{.ragged = 0.16f,
                          .cloud = 55.0f,
                          .family = {.unevenness = 0.16f,
                                     .length_min = 110.0f,
                                     .length_max = 300.0f,
                                     .overlap = 10.0f,
                                     .drift = 3.0f,
                                     .pressure = 0.16f}};
  chalk.Paint(drawing.canvas(), PlanSwelling(studio.seed, stream, Dark, family, hand));
}

// The flat of the stick, which leaves the paper's hollows bare.
Status LayFlat(Drawing& drawing, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush stick, Stick(studio, kRed, 6.5f, 1.0f));
  Hatch(drawing, stick, studio, kFlat, {kHand, 13.0f, 0.46f, 0.92f, 0.08f, 0.50f});
  return Ok();
}

Status HatchRed(Drawing& drawing, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush chalk, Stick(studio, kRed, 2.8f, 0.45f));
  Hatch(drawing, chalk, studio, kRedForm, {kForm, 20.0f, 0.34f, 0.9f, 0.07f, 0.60f});
  Hatch(drawing, chalk, studio, kRedHand, {kHand, 19.0f, 0.46f, 0.95f, 0.14f, 0.65f});
  Hatch(drawing, chalk, studio, kRedSteeper, {kSteeperHand, 19.0f, 0.66f, 0.95f, 0.12f, 0.55f});
  Chance chance(studio.seed, kContour);
  const Touch searching = [](glm::vec2 at) { return 0.22f + 0.35f * Ramp(0.3f, 0.9f, Dark(at)); };
  chalk.Paint(drawing.canvas(), PlanRim(chance, searching, {14, 3.5f, 2.2f, 0.6f, 1.5f}));
  return Ok();
}

// The deeper chalk, pressed hard: the core of the shade and the contour beside it.
Status HatchDeep(Drawing& drawing, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush chalk, Stick(studio, kDeep, 3.3f, 0.45f));
  Hatch(drawing, chalk, studio, kDeepHand, {kHand, 19.0f, 0.68f, 0.98f, 0.20f, 0.85f});
  Hatch(drawing, chalk, studio, kDeepForm, {kForm, 19.0f, 0.78f, 0.98f, 0.20f, 0.80f});
  Chance chance(studio.seed, kAccents);
  const Touch accent = [](glm::vec2 at) { return 0.58f * Ramp(0.60f, 0.92f, Dark(at)); };
  chalk.Radius(2.2f);
  chalk.Paint(drawing.canvas(), PlanRim(chance, accent, {.lines = 20, .inset = 3.0f, .deviation = 1.8f}));
  return Ok();
}

Status TouchLights(Drawing& drawing, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush chalk, Stick(studio, kWhite, 3.6f, 0.45f));
  Chance chance(studio.seed, kTouches);
  const Touch touch = [](glm::vec2 at) {
    const Shading shading = ShadingAt(at);
    return 0.34f * Ramp(0.86f, 0.97f, shading.light) + 0.75f * Ramp(0.05f, 0.6f, shading.highlight);
  };
  chalk.Paint(
      drawing.canvas(),
      PlanFamily(chance, kHand, touch, {.spacing = 15.0f, .length_min = 60.0f, .length_max = 150.0f, .overlap = 4.0f}));
  return Ok();
}

}  // namespace

Expected<Picture> PaintSanguine(const Studio& studio) {
  Drawing rubbed(PrepareGround({studio.size}, kPaper, studio.seed),
                 {.bite = 0.35f, .softness = 0.5f, .density = 0.8f, .stick = kRubbed});
  SCUMBLE_RETURN_IF_ERROR(RubTone(rubbed, studio));

  Drawing flat(rubbed.AsGround(), {.bite = 0.85f, .softness = 0.30f, .density = 0.9f, .stick = kRed});
  SCUMBLE_RETURN_IF_ERROR(LayFlat(flat, studio));
  Drawing red(flat.AsGround(), {.bite = 0.60f, .softness = 0.34f, .density = 1.05f, .stick = kRed});
  SCUMBLE_RETURN_IF_ERROR(HatchRed(red, studio));
  Drawing deep(red.AsGround(), {.bite = 0.55f, .softness = 0.34f, .density = 1.1f, .stick = kDeep});
  SCUMBLE_RETURN_IF_ERROR(HatchDeep(deep, studio));
  Drawing white(deep.AsGround(), {.bite = 0.65f, .softness = 0.30f, .density = 1.0f, .stick = kWhite});
  SCUMBLE_RETURN_IF_ERROR(TouchLights(white, studio));
  return ToPicture(white.Look());
}

Expected<Picture> SanguinePaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
