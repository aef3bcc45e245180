// Graphite on white drawing paper: patches of hatching laid over one another, a hard pencil first and a soft one for
// the core of the shade.
#include "exemplars/paint/engine/drawing.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kFine, 4.0f, {0.965f, 0.96f, 0.945f}, 0.04f};
constexpr glm::vec3 kHard{0.27f, 0.275f, 0.295f};
constexpr glm::vec3 kSoft{0.12f, 0.122f, 0.138f};

enum Pass : std::uint64_t { kRim = kFirstStream, kSoftPass, kFirstHatch };

// Darkness wanted: white paper in the light.
float Target(glm::vec2 at) {
  const float value = ShadingAt(at).value;
  return 0.04f + 0.44f * Ramp(0.94f, 0.30f, value) + 0.31f * Ramp(0.38f, 0.05f, value);
}

constexpr glm::vec3 kPencilDiagonal{-0.85f, 0.20f, 0.30f};
constexpr glm::vec3 kPencilAcross{0.20f, 0.90f, 0.25f};

Status DrawHatching(Drawing& drawing, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush pencil, Brush::Load(studio.brushes, "deevad/2B_pencil"));
  pencil.Radius(1.7f).Color(kHard);
  HatchOptions hatch;
  hatch.patches = 560;
  hatch.strokes_min = 7;
  hatch.strokes_max = 15;
  hatch.spacing = 5.5f;
  hatch.length_min = 60.0f;
  hatch.length_max = 140.0f;
  hatch.sway = 0.10f;
  constexpr glm::vec3 kTurns[] = {kAlongShade, kAlongShade, kPencilDiagonal, kAlongShade, kPencilAcross};
  HatchRounds(drawing, pencil, studio.seed, kFirstHatch, Target,
              {.count = 12, .axes = kTurns, .share = {0.60f, 1.0f}, .heaviest = {0.42f, 0.80f}, .hatch = hatch});
  return Ok();
}

Status DrawAccents(Drawing& drawing, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush soft, Brush::Load(studio.brushes, "tanda/pencil-8b"));
  soft.Radius(2.4f).Color(kSoft);
  HatchOptions hatch;
  hatch.patches = 420;
  hatch.spacing = 6.0f;
  hatch.length_min = 40.0f;
  hatch.length_max = 90.0f;
  // The soft pencil stays in the core of the shade; in half-tones its first touch would be a spot.
  const Touch core = [](glm::vec2 at) { return Target(at) * Ramp(0.60f, 0.75f, DarknessAt(at)); };
  for (int round = 0; round < 4; ++round) {
    Chance chance(studio.seed, Hash(kSoftPass, round));
    HatchRound(drawing, soft, chance, core, {round == 1 ? kPencilAcross : kAlongShade, 1.03f, 0.65f, hatch});
  }

  SCUMBLE_ASSIGN(Brush pencil, Brush::Load(studio.brushes, "deevad/2B_pencil"));
  pencil.Radius(1.9f).Color(kSoft);
  Chance rim(studio.seed, kRim);
  const Touch contour = [](glm::vec2 at) { return 0.40f + 0.45f * Ramp(0.2f, 0.9f, DarknessAt(at)); };
  pencil.Paint(
      drawing.canvas(),
      PlanRim(rim, contour, {.lines = 24, .inset = 6.5f, .deviation = 2.2f, .length_min = 0.8f, .length_max = 2.0f}));
  return Ok();
}

}  // namespace

Expected<Picture> PaintGraphite(const Studio& studio) {
  Drawing drawing(PrepareGround({studio.size}, kPaper, studio.seed),
                  {.bite = 0.55f, .softness = 0.40f, .density = 1.1f});
  SCUMBLE_RETURN_IF_ERROR(DrawHatching(drawing, studio));
  SCUMBLE_RETURN_IF_ERROR(DrawAccents(drawing, studio));
  return ToPicture(drawing.Look());
}

Expected<Picture> GraphitePaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
