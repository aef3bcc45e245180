// Oil out of doors, three times the same sphere: in the sun, turning from it, and under the open sky alone. The light
// is warm and thick, the shade cool and thin; colours lie broken side by side.
#include <array>

#include "exemplars/paint/engine/impasto.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

// Cream over ochre and rose, violet in the turn.
constexpr Palette kSun{.high{1.00f, 0.97f, 0.84f},
                       .light{0.98f, 0.86f, 0.58f},
                       .middle{0.91f, 0.68f, 0.44f},
                       .turn{0.70f, 0.48f, 0.48f},
                       .core{0.42f, 0.34f, 0.52f},
                       .reflected{0.50f, 0.50f, 0.62f},
                       .warm{{{0.96f, 0.66f, 0.50f}, {1.00f, 0.93f, 0.55f}}},
                       .cool{{{0.36f, 0.44f, 0.66f}, {0.62f, 0.36f, 0.52f}}}};
// The sun grazes: greyer, rose against green.
constexpr Palette kGrazed{.high{0.95f, 0.74f, 0.65f},
                          .light{0.87f, 0.64f, 0.52f},
                          .middle{0.76f, 0.51f, 0.48f},
                          .turn{0.59f, 0.40f, 0.51f},
                          .core{0.36f, 0.32f, 0.52f},
                          .reflected{0.44f, 0.46f, 0.60f},
                          .warm{{{0.84f, 0.54f, 0.46f}, {0.80f, 0.72f, 0.48f}}},
                          .cool{{{0.40f, 0.54f, 0.54f}, {0.48f, 0.36f, 0.60f}}}};
// No sun: blue from above, a warm breath from the ground.
constexpr Palette kSky{.high{0.52f, 0.58f, 0.76f},
                       .light{0.42f, 0.47f, 0.68f},
                       .middle{0.33f, 0.36f, 0.57f},
                       .turn{0.28f, 0.28f, 0.51f},
                       .core{0.20f, 0.18f, 0.36f},
                       .reflected{0.44f, 0.30f, 0.38f},
                       .warm{{{0.52f, 0.42f, 0.64f}, {0.38f, 0.56f, 0.72f}}},
                       .cool{{{0.16f, 0.30f, 0.48f}, {0.34f, 0.18f, 0.42f}}}};

// Short broad touches in the light; in the shade more of them, thinner and closer together.
constexpr std::array<BrushLayer, 3> kTouches{{
    {32.0f, 36.0f, 48.0f, 90.0f, 150.0f, 0.30f, 0.12f, 4.0f, false, 0.18f},
    {21.0f, 22.0f, 30.0f, 60.0f, 105.0f, 0.32f, 0.15f, 2.8f, false, 0.20f},
    {18.0f, 15.0f, 21.0f, 46.0f, 84.0f, 0.34f, 0.16f, 2.4f, false, 0.20f},
}};
constexpr std::array<BrushLayer, 4> kScumbles{{
    {32.0f, 36.0f, 48.0f, 90.0f, 150.0f, 0.25f, 0.12f, 4.0f, false, 0.10f},
    {21.0f, 20.0f, 28.0f, 60.0f, 100.0f, 0.25f, 0.18f, 2.8f, false, 0.10f},
    {17.0f, 13.0f, 18.0f, 48.0f, 84.0f, 0.25f, 0.21f, 2.4f, false, 0.12f},
    {17.0f, 10.0f, 14.0f, 40.0f, 70.0f, 0.25f, 0.21f, 2.2f, false, 0.12f},
}};

}  // namespace

Expected<Picture> PaintPleinAir(const Studio& studio) {
  constexpr glm::vec3 kUndertone{0.62f, 0.50f, 0.44f};
  const float thickness = studio.light == Light::kKey ? 1.0f : studio.light == Light::kGrazing ? 0.7f : 0.35f;
  SCUMBLE_ASSIGN(Impasto painting, Impasto::Begin({studio.size}, studio, kUndertone, thickness));
  switch (studio.light) {
    case Light::kKey:
      painting.WorkOver(kSun, kTouches);
      painting.PlaceHighlight({1.0f, 0.985f, 0.92f}, 26);
      break;
    case Light::kGrazing:
      painting.WorkOver(kGrazed, kTouches);
      break;
    default:
      painting.WorkOver(kSky, kScumbles);
      break;
  }
  return ToPicture(painting.Finish(0.8f));
}

Expected<Picture> PleinAirGround(const Studio& studio) {
  constexpr glm::vec3 kHaze{0.78f, 0.80f, 0.74f};
  SCUMBLE_ASSIGN(Impasto ground, Impasto::Begin(TileFor(studio.size), studio, 0.96f * kHaze));
  ground.BrushGround(kHaze);
  return ToPicture(ground.Finish(0.5f));
}

}  // namespace scumble::paint
