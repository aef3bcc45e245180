// A soft pencil on white paper, for tinting: open hatching, dark enough for deep base colours and wide enough that the
// paper shows between the lines. Tone comes from layers that cross and from pressure, never from rubbing.
#include "exemplars/paint/engine/drawing.h"
#include "exemplars/paint/neutral.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kFine, 4.5f, {0.985f, 0.985f, 0.985f}, 0.03f};
constexpr glm::vec3 kLead{0.24f, 0.24f, 0.24f};

enum Pass : std::uint64_t { kRim = kFirstStream, kAccents, kFirstHatch };

// Target darkness. Darker than the form, in the light too: without lines there is no colour.
float Target(glm::vec2 at) {
  const Shading shading = ShadingAt(at);
  return 0.16f * Ramp(0.97f, 0.80f, shading.value) + 0.24f * Ramp(0.88f, 0.34f, shading.value) +
         0.24f * Ramp(0.40f, 0.06f, shading.value) - 0.10f * Ramp(0.3f, 0.9f, shading.highlight);
}

// The first direction is the hand's own; the others cross it in the dark parts. Their poles lie on the rim, and the
// last one's away from the light.
constexpr glm::vec3 kHand{-0.86f, 0.50f, 0.0f};
constexpr glm::vec3 kSteep{-0.45f, 0.88f, 0.0f};
constexpr glm::vec3 kLevel{0.55f, 0.83f, 0.0f};

}  // namespace

Expected<Picture> PaintTintedPencil(const Studio& studio) {
  Drawing drawing(PrepareGround({studio.size}, kPaper, studio.seed),
                  {.bite = 0.45f, .softness = 0.36f, .density = 1.25f});
  SCUMBLE_ASSIGN(Brush pencil, Brush::Load(studio.brushes, "tanda/pencil-8b"));
  pencil.Radius(2.2f).Color(kLead);
  HatchOptions hatch;
  hatch.patches = 380;
  hatch.strokes_min = 6;
  hatch.strokes_max = 11;
  hatch.spacing = 9.5f;
  hatch.length_min = 90.0f;
  hatch.length_max = 190.0f;
  hatch.sway = 0.10f;
  hatch.unevenness = 0.22f;
  constexpr glm::vec3 kTurns[] = {kHand, kHand, kSteep, kHand, kLevel, kHand, kSteep};
  HatchRounds(drawing, pencil, studio.seed, kFirstHatch, Target,
              {.count = 9, .axes = kTurns, .share = {0.60f, 1.0f}, .heaviest = {0.40f, 0.66f}, .hatch = hatch});

  pencil.Radius(3.1f);
  hatch.patches = 240;
  hatch.length_max = 120.0f;
  const Touch core = [](glm::vec2 at) { return Target(at) * Ramp(0.58f, 0.74f, DarknessAt(at)); };
  for (int round = 0; round < 3; ++round) {
    Chance chance(studio.seed, Hash(kAccents, round));
    HatchRound(drawing, pencil, chance, core, {round == 1 ? kLevel : kHand, 1.0f, 0.6f, hatch});
  }
  pencil.Radius(2.2f);
  Chance rim(studio.seed, kRim);
  const Touch contour = [](glm::vec2 at) { return 0.35f + 0.4f * Ramp(0.2f, 0.9f, DarknessAt(at)); };
  pencil.Paint(
      drawing.canvas(),
      PlanRim(rim, contour, {.lines = 18, .inset = 6.0f, .deviation = 2.5f, .length_min = 0.7f, .length_max = 1.8f}));
  return ToPicture(Neutral(drawing.Look()));
}

Expected<Picture> TintedPencilPaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
