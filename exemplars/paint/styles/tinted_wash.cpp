// Washes of ink on rough paper, for tinting: a few broad glazes that a large brush lays in sweeps across the sphere,
// with hard dried edges and pools. Pale throughout: a tint is visible in light parts.
#include <array>

#include "exemplars/paint/engine/glaze.h"
#include "exemplars/paint/engine/paper.h"
#include "exemplars/paint/neutral.h"
#include "exemplars/paint/sphere.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kColdPress, 8.5f, {0.985f, 0.985f, 0.985f}, 0.045f};

constexpr glm::vec3 kSweep{-0.40f, 0.88f, 0.20f};
constexpr glm::vec3 kDown{-0.90f, 0.35f, 0.10f};
constexpr glm::vec3 kRound{-0.62f, 0.74f, 0.25f};

struct Wash {
  float through;  // light
  float below, ragged, spacing, radius, edge, wetness;
  glm::vec3 axis;

  Glaze AsGlaze() const {
    const bool loose = spacing > radius;
    return {.pigment = glm::vec3(through),
            .drift = glm::vec3(through + 0.12f * (1.0f - through)),
            .below = below,
            .ragged = ragged,
            .spacing = spacing,
            .radius = radius,
            .density = 0.85f,
            .edge = edge,
            .wetness = wetness,
            .length = loose ? 20.0f : 9.0f,
            .lobes = 170.0f,
            // The remainder of a loose sweep at a border would dry as a blot.
            .shortest = loose ? 9.0f : 3.0f};
  }
};

// Washes are flooded; in the shade a few loose sweeps break its border.
constexpr std::array<Wash, 7> kWashes{{
    {0.88f, 0.93f, 0.10f, 13.0f, 24.0f, 0.50f, 0.45f, kSweep},
    {0.82f, 0.74f, 0.17f, 12.0f, 22.0f, 0.70f, 0.30f, kSweep},
    {0.80f, 0.60f, 0.20f, 12.0f, 20.0f, 0.60f, 0.45f, kDown},
    {0.74f, 0.44f, 0.16f, 12.0f, 20.0f, 0.70f, 0.30f, kSweep},
    {0.72f, 0.28f, 0.12f, 11.0f, 16.0f, 0.60f, 0.50f, kSweep},
    {0.78f, 0.22f, 0.06f, 44.0f, 11.0f, 0.90f, 0.20f, kRound},
    {0.66f, 0.15f, 0.07f, 11.0f, 14.0f, 0.70f, 0.40f, kSweep},
}};

}  // namespace

Expected<Picture> PaintTintedWash(const Studio& studio) {
  SCUMBLE_ASSIGN(Brush brush, Brush::Load(studio.brushes, "deevad/brush"));
  brush.Color(glm::vec3(0.2f));
  auto [tooth, picture] = PrepareGround({studio.size}, kPaper, studio.seed);
  const Touch value = [](glm::vec2 at) { return ShadingAt(at).value; };
  std::uint64_t pass = kFirstStream;
  for (const Wash& wash : kWashes) {
    LayGlaze(picture, brush, tooth, wash.AsGlaze(), {value, SwayingRound(wash.axis, 0.10f)}, studio.seed, pass++);
  }
  return ToPicture(Neutral(std::move(picture)));
}

Expected<Picture> TintedWashPaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
