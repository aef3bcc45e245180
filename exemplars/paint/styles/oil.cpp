// Oil, alla prima: warm light, cool shade; big brushes first.
#include <array>

#include "exemplars/paint/engine/impasto.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr std::array<BrushLayer, 4> kLayers{{
    {34.0f, 38.0f, 50.0f, 90.0f, 150.0f, 0.30f, 0.16f, 4.0f, false},
    {21.0f, 22.0f, 32.0f, 60.0f, 110.0f, 0.28f, 0.22f, 2.6f, false},
    {16.0f, 15.0f, 21.0f, 40.0f, 80.0f, 0.28f, 0.24f, 2.2f, false},
    {15.0f, 9.0f, 13.0f, 26.0f, 50.0f, 0.22f, 0.18f, 2.0f, true},
}};

// Ochre over terracotta, plum in the core, blue-green where light comes back.
constexpr Palette kPalette{.high{1.00f, 0.94f, 0.74f},
                           .light{0.95f, 0.70f, 0.33f},
                           .middle{0.82f, 0.40f, 0.19f},
                           .turn{0.52f, 0.19f, 0.21f},
                           .core{0.17f, 0.09f, 0.20f},
                           .reflected{0.25f, 0.37f, 0.46f},
                           .warm{{{0.86f, 0.42f, 0.42f}, {0.98f, 0.84f, 0.42f}}},
                           .cool{{{0.16f, 0.36f, 0.40f}, {0.46f, 0.10f, 0.20f}}}};

}  // namespace

Expected<Picture> PaintOil(const Studio& studio) {
  SCUMBLE_ASSIGN(Impasto painting, Impasto::Begin({studio.size}, studio, {0.42f, 0.30f, 0.24f}));
  painting.WorkOver(kPalette, kLayers);
  painting.PlaceHighlight({1.0f, 0.955f, 0.84f}, 40);
  return ToPicture(painting.Finish());
}

Expected<Picture> OilGround(const Studio& studio) {
  constexpr glm::vec3 kGrey{0.561f, 0.639f, 0.651f};
  SCUMBLE_ASSIGN(Impasto ground, Impasto::Begin(TileFor(studio.size), studio, 0.96f * kGrey));
  ground.BrushGround(kGrey);
  return ToPicture(ground.Finish(0.5f));
}

}  // namespace scumble::paint
