// Charcoal and chalk on grey-brown paper, three times the same sphere. In the light the paper is the half-tone and
// white chalk models everything above it. In half-light there is little chalk and more of the paper. In the shade
// charcoal nearly covers it, and a cool grey chalk is the light of the sky.
#include "exemplars/paint/engine/drawing.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kLaid, 5.0f, {0.60f, 0.555f, 0.49f}, 0.05f};
constexpr glm::vec3 kCharcoal{0.10f, 0.088f, 0.085f};
constexpr glm::vec3 kChalk{0.985f, 0.965f, 0.92f};
constexpr glm::vec3 kCoolChalk{0.37f, 0.42f, 0.50f};

enum Pass : std::uint64_t { kTone = kFirstStream, kSmudge, kRim, kAccents, kFirstRound, kFirstChalk = 100 };

// The target darkness, of which the bare paper has 0.44.
Touch Target(Light light) {
  // In the light chalk reaches what faces the viewer, or walls would be bare paper like the ground behind them.
  const glm::vec2 chalk = light == Light::kKey ? glm::vec2(0.85f, 0.40f) : glm::vec2(1.0f, 0.50f);
  return [light, chalk](glm::vec2 at) {
    const float value = ShadingAt(at, light).value;
    return 0.10f + 0.34f * Ramp(chalk.x, chalk.y, value) + 0.24f * Ramp(0.52f, 0.24f, value) +
           0.20f * Ramp(0.28f, 0.04f, value);
  };
}

// The side of the stick, and a finger that rubs it in: most of the work in the shade, little in the light.
Status LayTone(Drawing& drawing, const Studio& studio, const Touch& target) {
  const bool shade = studio.light == Light::kSky;
  SCUMBLE_ASSIGN(Brush stick, Brush::Load(studio.brushes, "tanda/charcoal-04"));
  stick.Radius(6.0f).Color(kCharcoal);
  Chance chance(studio.seed, kTone);
  Round round{kAlongShade, shade ? 0.90f : 0.85f, shade ? 0.20f : 0.16f, {}};
  round.hatch.patches = shade ? 3000 : 1500;
  round.hatch.spacing = 11.0f;
  round.hatch.length_min = 60.0f;
  round.hatch.length_max = 150.0f;
  HatchRound(drawing, stick, chance, target, round);

  const Touch rub = [&](glm::vec2 at) { return (shade ? 0.15f : 0.35f) * Ramp(0.45f, 0.80f, target(at)); };
  return Smudge(drawing, studio, kSmudge, kAlongShade, rub);
}

// The corner of the stick: strokes that stay visible. In the shade they cross and lie closer.
Status LayStrokes(Drawing& drawing, const Studio& studio, const Touch& target) {
  const bool shade = studio.light == Light::kSky;
  SCUMBLE_ASSIGN(Brush corner, Brush::Load(studio.brushes, "tanda/charcoal-04"));
  corner.Radius(2.8f).Color(kCharcoal);
  HatchOptions hatch;
  hatch.patches = shade ? 520 : 330;
  hatch.spacing = shade ? 7.0f : 9.0f;
  hatch.length_min = 60.0f;
  hatch.length_max = 140.0f;
  constexpr glm::vec3 kTurns[] = {kDiagonal, kAlongShade, kAlongShade, kAcross};
  const float last = shade ? 0.38f : 0.48f;
  HatchRounds(drawing, corner, studio.seed, kFirstRound, target,
              {.count = 12, .axes = kTurns, .share = {0.92f, 1.03f}, .heaviest = {0.24f, last}, .hatch = hatch});

  SCUMBLE_ASSIGN(Brush point, Brush::Load(studio.brushes, "classic/charcoal"));
  point.Radius(3.0f).Color(kCharcoal);
  hatch.patches = 240;
  hatch.length_max = 100.0f;
  for (int round = 0; round < (shade ? 2 : 4); ++round) {
    Chance chance(studio.seed, Hash(kAccents, round));
    HatchRound(drawing, point, chance, target, {kTurns[(round + 1) % 4], 1.03f, 0.60f, hatch});
  }
  Chance rim(studio.seed, kRim);
  const Touch contour = [&](glm::vec2 at) { return 0.10f + 0.5f * Ramp(0.3f, 0.8f, target(at)); };
  point.Paint(drawing.canvas(), PlanRim(rim, contour, {.lines = 30, .inset = 8.0f, .deviation = 3.5f}));
  return Ok();
}

// Chalk goes where the drawing is still too dark.
Status LayChalk(Drawing& drawing, const Studio& studio, const Touch& target) {
  const bool shade = studio.light == Light::kSky;
  SCUMBLE_ASSIGN(Brush chalk, Brush::Load(studio.brushes, "tanda/charcoal-04"));
  chalk.Radius(2.8f).Color(shade ? kCoolChalk : kChalk);
  HatchOptions hatch;
  hatch.patches = shade ? 260 : 340;
  hatch.strokes_min = 4;
  hatch.strokes_max = 9;
  hatch.spacing = 8.0f;
  hatch.length_min = 55.0f;
  hatch.length_max = 120.0f;
  constexpr glm::vec3 kTurns[] = {kDiagonal, kAcross, kDiagonal, kAlongShade};
  const int rounds = shade ? 6 : 10;
  for (int round = 0; round < rounds; ++round) {
    Chance chance(studio.seed, kFirstChalk + static_cast<std::uint64_t>(round));
    const float progress = static_cast<float>(round) / static_cast<float>(rounds - 1);
    // In the shade the chalk only shows the sky: its target is slightly lighter than the charcoal.
    const Touch wanted = [&](glm::vec2 at) {
      return target(at) - (shade ? 0.08f * Ramp(0.40f, 0.95f, ShadingAt(at, Light::kSky).light) : 0.0f);
    };
    const Touch touch = drawing.Missing(wanted, -3.0f, glm::mix(0.30f, shade ? 0.30f : 0.62f, progress));
    const Touch held = [&](glm::vec2 at) {
      const bool light_side = shade || target(at) < 0.43f;
      return light_side ? touch(at) : 0.0f;
    };
    chalk.Paint(drawing.canvas(), PlanHatching(chance, AroundAxis, kTurns[round % 4], held, hatch));
  }
  return Ok();
}

}  // namespace

Expected<Picture> PaintChiaroscuro(const Studio& studio) {
  const Touch target = Target(studio.light);
  Drawing dark(PrepareGround({studio.size}, kPaper, studio.seed), {.bite = 0.8f, .softness = 0.34f, .density = 1.05f});
  SCUMBLE_RETURN_IF_ERROR(LayTone(dark, studio, target));
  SCUMBLE_RETURN_IF_ERROR(LayStrokes(dark, studio, target));
  Drawing light(dark.AsGround(), {.bite = 0.75f, .softness = 0.30f, .density = 1.05f});
  SCUMBLE_RETURN_IF_ERROR(LayChalk(light, studio, target));
  return ToPicture(light.Look());
}

Expected<Picture> ChiaroscuroPaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
