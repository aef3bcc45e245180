// Oil in greys, for tinting by the colours of a scene's objects. A loaded flat brush lays patches of parallel touches
// that slant across the form, thick enough to cast shadows. It is light on the whole, so that a base colour is kept and
// only the core of the shade is darker.
#include <algorithm>
#include <array>
#include <cmath>

#include "exemplars/paint/engine/impasto.h"
#include "exemplars/paint/engine/patches.h"
#include "exemplars/paint/neutral.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

// Impasto uses the lower streams for its own passes.
constexpr std::uint64_t kFirstPatches = 200;

struct Stage {
  PatchOptions patches;
  float width, bristle;
  float broken;  // variation of the tone from patch to patch
  float share;   // minimum share of the patches that are painted; all are where tones change fast
};
constexpr std::array<Stage, 3> kStages{{
    {{.spacing = 48.0f, .touches_min = 3, .touches_max = 5, .apart = 26.0f, .length_min = 90.0f, .length_max = 140.0f},
     34.0f,
     4.0f,
     0.02f,
     1.0f},
    {{.spacing = 46.0f, .touches_min = 3, .touches_max = 5, .apart = 22.0f, .length_min = 75.0f, .length_max = 125.0f},
     25.0f,
     3.2f,
     0.05f,
     0.85f},
    {{.spacing = 46.0f, .touches_min = 2, .touches_max = 4, .apart = 17.0f, .length_min = 55.0f, .length_max = 95.0f},
     18.0f,
     2.6f,
     0.06f,
     0.35f},
}};

float Tone(const Shading& shading) {
  float tone = glm::mix(0.40f, 0.56f, Ramp(0.0f, 0.22f, shading.light));
  tone = glm::mix(tone, 0.76f, Ramp(0.12f, 0.50f, shading.light));
  tone = glm::mix(tone, 0.90f, Ramp(0.42f, 0.90f, shading.light));
  tone = glm::mix(tone, 0.58f, 0.9f * Ramp(0.10f, 0.95f, shading.reflected));
  return tone + 0.05f * Ramp(0.80f, 1.0f, shading.light);
}

}  // namespace

Expected<Picture> PaintTintedOil(const Studio& studio) {
  SCUMBLE_ASSIGN(Impasto painting, Impasto::Begin({studio.size}, studio, glm::vec3(0.70f)));
  // One slant for the whole sphere, as of a right hand, wound around the form. It is not much shorter at the rim, where
  // short touches would leave the undertone bare.
  const Flow slanting = [round = AroundAxis({-0.80f, 0.60f, 0.06f})](glm::vec2 at) {
    const glm::vec2 way = round(at);
    return way * std::max(1.0f, 0.65f / glm::length(way));
  };
  std::uint64_t pass = kFirstPatches;
  for (const Stage& stage : kStages) {
    Chance chance(studio.seed, pass++);
    Chance tones(studio.seed, Hash(pass, 1));
    glm::vec2 last(-1e9f);
    bool painted = false;
    float tone = 0.0f, load = 0.0f;
    LayPatches(chance, slanting, stage.patches, [&](const Stroke& path, glm::vec2 patch) {
      if (patch != last) {
        const Shading shading = ShadingAt(patch);
        const float turning =
            Ramp(0.40f, 0.05f, std::fabs(shading.light - 0.18f)) + 0.5f * Ramp(0.86f, 1.0f, RimDistance(patch));
        painted = tones.Happens(stage.share + turning);
        tone = Tone(shading) + tones.Bell(stage.broken);
        load = 0.55f + 0.45f * Ramp(0.05f, 0.7f, shading.light);
        last = patch;
      }
      const glm::vec3 grey(tone + tones.Bell(0.8f * stage.broken));
      if (painted) painting.DragBristles(chance, path, {stage.width, stage.bristle, load, 0.8f}, grey);
    });
  }
  painting.PlaceHighlight(glm::vec3(1.0f), 30);
  return ToPicture(Neutral(painting.Finish(1.15f)));
}

Expected<Picture> TintedOilGround(const Studio& studio) {
  SCUMBLE_ASSIGN(Impasto ground, Impasto::Begin(TileFor(studio.size), studio, glm::vec3(0.80f)));
  ground.BrushGround(glm::vec3(0.83f));
  return ToPicture(Neutral(ground.Finish(0.5f)));
}

}  // namespace scumble::paint
