// Charcoal and white chalk on warm toned paper: the side of the stick first, smudged by a finger, then the corner of
// the stick for the shade, and chalk in the light.
#include "exemplars/paint/engine/drawing.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kLaid, 5.0f, {0.85f, 0.775f, 0.66f}, 0.055f};
constexpr glm::vec3 kCharcoal{0.11f, 0.095f, 0.09f};
constexpr glm::vec3 kChalk{0.985f, 0.97f, 0.93f};

enum Pass : std::uint64_t { kTone = kFirstStream, kSmudge, kRim, kLights, kAccents, kFirstRound };

// Target darkness: bare paper in the light, nearly black in the core of the shade.
float Target(glm::vec2 at) {
  const float value = ShadingAt(at).value;
  return 0.20f + 0.36f * Ramp(0.88f, 0.34f, value) + 0.29f * Ramp(0.42f, 0.05f, value);
}

// The side of the stick, wide and pale, and a finger that rubs it in.
Status LayTone(Drawing& drawing, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush stick, Brush::Load(studio.brushes, "tanda/charcoal-04"));
  stick.Radius(6.0f).Color(kCharcoal);
  Chance chance(studio.seed, kTone);
  Round round{kAlongShade, 0.80f, 0.16f, {}};
  round.hatch.patches = 1500;
  round.hatch.spacing = 11.0f;
  round.hatch.length_min = 60.0f;
  round.hatch.length_max = 150.0f;
  HatchRound(drawing, stick, chance, Target, round);

  const Touch rub = [](glm::vec2 at) { return 0.35f * Ramp(0.35f, 0.75f, DarknessAt(at)); };
  return Smudge(drawing, studio, kSmudge, kAlongShade, rub);
}

// The corner of the stick: strokes that stay visible; each round goes where the last one left the drawing too light.
Status LayStrokes(Drawing& drawing, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush corner, Brush::Load(studio.brushes, "tanda/charcoal-04"));
  corner.Radius(2.6f).Color(kCharcoal);
  SCUMBLE_ASSIGN(Brush point, Brush::Load(studio.brushes, "classic/charcoal"));
  point.Radius(3.0f).Color(kCharcoal);

  HatchOptions hatch;
  hatch.patches = 330;
  hatch.spacing = 9.0f;
  hatch.length_min = 55.0f;
  hatch.length_max = 130.0f;
  constexpr glm::vec3 kTurns[] = {kDiagonal, kAlongShade, kAlongShade, kAcross};
  HatchRounds(drawing, corner, studio.seed, kFirstRound, Target,
              {.count = 12, .axes = kTurns, .share = {0.88f, 1.02f}, .heaviest = {0.22f, 0.45f}, .hatch = hatch});
  hatch.patches = 260;
  hatch.spacing = 7.0f;
  hatch.length_max = 100.0f;
  for (int round = 0; round < 6; ++round) {
    Chance chance(studio.seed, Hash(kAccents, round));
    HatchRound(drawing, point, chance, Target, {kTurns[(round + 1) % 4], 1.03f, 0.62f, hatch});
  }

  Chance rim(studio.seed, kRim);
  const Touch contour = [](glm::vec2 at) { return 0.15f + 0.5f * Ramp(0.2f, 0.8f, DarknessAt(at)); };
  point.Paint(drawing.canvas(), PlanRim(rim, contour, {.lines = 30, .inset = 8.0f, .deviation = 3.5f}));
  return Ok();
}

Status LayChalk(Drawing& drawing, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush chalk, Brush::Load(studio.brushes, "deevad/chalk"));
  chalk.Radius(3.6f).Color(kChalk);
  Chance chance(studio.seed, kLights);
  HatchOptions hatch;
  hatch.patches = 1600;
  hatch.strokes_min = 2;
  hatch.strokes_max = 6;
  hatch.spacing = 13.0f;
  hatch.length_min = 60.0f;
  hatch.length_max = 120.0f;
  const Touch touch = [](glm::vec2 at) {
    const Shading shading = ShadingAt(at);
    return 0.22f * Ramp(0.72f, 0.97f, shading.light) + 0.42f * Ramp(0.35f, 0.95f, shading.highlight);
  };
  chalk.Paint(drawing.canvas(), PlanHatching(chance, AroundAxis, kDiagonal, touch, hatch));
  return Ok();
}

}  // namespace

Expected<Picture> PaintCharcoal(const Studio& studio) {
  Drawing dark(PrepareGround({studio.size}, kPaper, studio.seed), {.bite = 0.8f, .softness = 0.34f, .density = 1.05f});
  SCUMBLE_RETURN_IF_ERROR(LayTone(dark, studio));
  SCUMBLE_RETURN_IF_ERROR(LayStrokes(dark, studio));
  Drawing light(dark.AsGround(), {.bite = 0.85f, .softness = 0.25f, .density = 1.0f});
  SCUMBLE_RETURN_IF_ERROR(LayChalk(light, studio));
  return ToPicture(light.Look());
}

Expected<Picture> CharcoalPaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
