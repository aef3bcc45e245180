// Wax pencils on white paper: thin hatchings of many hues laid through one another, each a glaze over those before it.
#include <array>
#include <cmath>

#include "exemplars/paint/engine/colouring.h"
#include "exemplars/paint/engine/drawing.h"
#include "exemplars/paint/engine/impasto.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kFine, 4.2f, {0.985f, 0.98f, 0.965f}, 0.02f};

enum Pass : std::uint64_t { kClouds = kFirstStream, kHues, kStump, kSpared, kFirstPencil = 100 };

// A pencil of the box, and the light in which it is used: from `dark` to `bright`, the cosine towards the key light.
struct Pencil {
  glm::vec3 color;
  float dark, bright;
};
constexpr std::array<Pencil, 12> kBox{{
    {{1.00f, 0.92f, 0.50f}, -1.0f, 1.10f},   // lemon
    {{1.00f, 0.79f, 0.32f}, 0.20f, 0.92f},   // yellow
    {{1.00f, 0.76f, 0.70f}, 0.50f, 1.10f},   // flesh
    {{1.00f, 0.62f, 0.32f}, 0.22f, 0.80f},   // orange
    {{0.98f, 0.46f, 0.34f}, 0.14f, 0.56f},   // vermilion
    {{0.92f, 0.52f, 0.66f}, 0.00f, 0.70f},   // rose
    {{0.82f, 0.28f, 0.44f}, -0.10f, 0.40f},  // crimson
    {{0.60f, 0.40f, 0.76f}, -0.50f, 0.36f},  // violet
    {{0.34f, 0.40f, 0.80f}, -1.0f, 0.14f},   // ultramarine
    {{0.46f, 0.74f, 0.88f}, -1.0f, 0.20f},   // sky blue
    {{0.30f, 0.62f, 0.52f}, -1.0f, 0.10f},   // bottle green
    {{0.34f, 0.30f, 0.62f}, -0.6f, -0.05f},  // indigo
}};

constexpr Palette kPalette{.high{1.00f, 0.97f, 0.88f},
                           .light{1.00f, 0.89f, 0.58f},
                           .middle{0.98f, 0.68f, 0.40f},
                           .turn{0.90f, 0.42f, 0.50f},
                           .core{0.44f, 0.36f, 0.68f},
                           .reflected{0.46f, 0.72f, 0.66f},
                           .warm{{{0.98f, 0.84f, 0.46f}, {0.94f, 0.58f, 0.62f}}},
                           .cool{{{0.38f, 0.56f, 0.74f}, {0.62f, 0.36f, 0.66f}}}};

TargetColors TargetColorsFor(const Studio& studio, float share) {
  return MakeTargetColors([&](glm::vec2 at) {
    const float cloud = CloudNoise(at / 90.0f, 3, Hash(studio.seed, kClouds)) - 0.5f;
    Shading shading = ShadingAt(at);
    shading.light = glm::clamp(shading.light + 0.14f * cloud, 0.0f, 1.0f);
    // Passages of rose and of sky in what would be orange and violet throughout.
    const float hue = CloudNoise(at / 75.0f, 3, Hash(studio.seed, kHues)) - 0.5f;
    const std::size_t which = hue > 0.0f ? 0 : 1;
    const glm::vec3 other = glm::mix(kPalette.cool[which], kPalette.warm[which], Ramp(0.05f, 0.3f, shading.light));
    const glm::vec3 color = glm::mix(kPalette.At(shading), other,
                                     0.6f * Ramp(0.03f, 0.20f, std::fabs(hue)) * Ramp(1.0f, 0.8f, shading.light));
    return glm::mix(kPaper.color, color, share);
  });
}

constexpr Settling kWax{.media = {.bite = 0.5f, .softness = 0.4f}, .load = 0.85f};

constexpr glm::vec3 kTurns[] = {kAlongShade, kDiagonal, kAlongShade, kAgainst, {-0.4f, 0.85f, 0.3f}};

// Round the highlight the wax is rubbed until the tooth closes and it shines.
Status Burnish(Colouring& drawing, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush stump, Brush::Load(studio.brushes, "deevad/blending"));
  stump.Radius(6.0f);
  Chance chance(studio.seed, kStump);
  const HatchOptions hatch{.patches = 500, .spacing = 14.0f};
  const Touch touch = [](glm::vec2 at) {
    const float light = ShadingAt(at).light;
    return 0.25f * Ramp(0.84f, 0.96f, light);
  };
  drawing.Rub(stump, PlanHatching(chance, AroundAxis, kDiagonal, touch, hatch));
  return Ok();
}

}  // namespace

Expected<Picture> PaintColouredPencil(const Studio& studio) {
  Colouring drawing(PrepareGround({studio.size}, kPaper, studio.seed));
  SCUMBLE_ASSIGN(Brush side, Brush::Load(studio.brushes, "tanda/pencil-8b"));
  side.Radius(4.5f);
  SCUMBLE_ASSIGN(Brush point, Brush::Load(studio.brushes, "kaerhon_v1/classic_sk"));
  HatchOptions hatch;
  hatch.strokes_min = 6;
  hatch.strokes_max = 13;
  hatch.spacing = 7.0f;
  hatch.length_min = 70.0f;
  hatch.length_max = 150.0f;
  hatch.sway = 0.10f;
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    hatch.patches = round == 0 ? 300 : 170;
    const TargetColors target_colors = TargetColorsFor(studio, 0.6f + 0.4f * static_cast<float>(round) / (kRounds - 1));
    for (std::size_t i = 0; i < kBox.size(); ++i) {
      const std::uint64_t number = static_cast<std::uint64_t>(round) * kBox.size() + i;
      Chance chance(studio.seed, kFirstPencil + number);
      const Stick stick{kBox[i].color, true};
      const glm::vec3 axis = kTurns[number % std::size(kTurns)];
      const Touch nearer = AwayFromPoles(
          drawing.Nearer(target_colors, stick, {.lightest = 0.45f, .heaviest = 0.80f, .least = 0.02f}), axis);
      const Touch touch = [&](glm::vec2 at) {
        // The paper is the highlight.
        const float ragged = CloudNoise(at / 24.0f, 2, Hash(studio.seed, kSpared)) - 0.5f;
        const float spared = Ramp(0.75f, 0.35f, ShadingAt(at).highlight + 0.7f * ragged);
        const float facing = glm::dot(NormalAt(at), kKeyLight);
        return nearer(at) * spared * Ramp(kBox[i].bright, kBox[i].bright - 0.12f, facing) *
               Ramp(kBox[i].dark - 0.12f, kBox[i].dark, facing);
      };
      // The side of a blunt pencil at first, the point later.
      Brush& brush = round < 1 ? side : point.Radius(round == 1 ? 2.4f : 1.8f);
      drawing.Draw(brush, stick, PlanHatching(chance, AroundAxis, axis, touch, hatch), kWax);
    }
  }
  SCUMBLE_RETURN_IF_ERROR(Burnish(drawing, studio));
  return ToPicture(drawing.picture());
}

Expected<Picture> ColouredPencilPaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
