// Watercolour: glazes from light to dark. Each glaze is a sparse scatter of wet strokes; as they dry, pigment gathers
// at their edges and in the paper's hollows, and light passes through every layer to the paper and back.
#include <array>

#include "exemplars/paint/engine/glaze.h"
#include "exemplars/paint/engine/paper.h"
#include "exemplars/paint/sphere.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kColdPress, 6.5f, {0.985f, 0.975f, 0.95f}, 0.035f};

constexpr std::uint64_t kFirstGlaze = kFirstStream;

// Washes that flow together alternate with strokes that stay apart.
constexpr std::array<Glaze, 11> kGlazes{{
    {{0.99f, 0.95f, 0.82f}, {1.00f, 0.90f, 0.80f}, 0.98f, 0.05f, 11.0f, 20.0f, 0.80f, 0.5f, 0.8f},
    {{0.98f, 0.87f, 0.66f}, {0.97f, 0.82f, 0.70f}, 0.86f, 0.14f, 30.0f, 14.0f, 0.30f, 0.7f, 0.6f},
    {{0.74f, 0.90f, 0.86f}, {0.84f, 0.90f, 0.74f}, 0.75f, 0.14f, 11.0f, 20.0f, 0.36f, 0.7f, 0.7f},
    {{0.62f, 0.85f, 0.86f}, {0.70f, 0.84f, 0.80f}, 0.68f, 0.16f, 29.0f, 14.0f, 0.32f, 0.8f, 0.5f},
    {{0.52f, 0.80f, 0.86f}, {0.56f, 0.82f, 0.78f}, 0.60f, 0.15f, 11.0f, 20.0f, 0.44f, 0.7f, 0.6f},
    {{0.52f, 0.72f, 0.86f}, {0.58f, 0.70f, 0.86f}, 0.54f, 0.15f, 26.0f, 14.0f, 0.42f, 0.8f, 0.5f},
    {{0.46f, 0.62f, 0.84f}, {0.44f, 0.70f, 0.82f}, 0.45f, 0.13f, 11.0f, 18.0f, 0.52f, 0.6f, 0.6f},
    {{0.52f, 0.56f, 0.82f}, {0.58f, 0.54f, 0.80f}, 0.36f, 0.11f, 22.0f, 13.0f, 0.40f, 0.7f, 0.5f},
    {{0.50f, 0.48f, 0.76f}, {0.42f, 0.54f, 0.78f}, 0.26f, 0.09f, 10.0f, 15.0f, 0.55f, 0.6f, 0.7f},
    {{0.56f, 0.44f, 0.70f}, {0.64f, 0.44f, 0.66f}, 0.17f, 0.06f, 12.0f, 9.0f, 0.50f, 0.6f, 0.6f},
    {{0.50f, 0.44f, 0.68f}, {0.50f, 0.44f, 0.68f}, 0.10f, 0.04f, 12.0f, 9.0f, 0.50f, 0.6f, 0.6f},
}};

}  // namespace

Expected<Picture> PaintWatercolour(const Studio& studio) {
  SCUMBLE_ASSIGN(Brush brush, Brush::Load(studio.brushes, "deevad/brush"));
  brush.Color(glm::vec3(0.2f));
  auto [tooth, picture] = PrepareGround({studio.size}, kPaper, studio.seed);
  const GlazePlan plan{[](glm::vec2 at) { return ShadingAt(at).value; }, SwayingRound({-0.62f, 0.66f, 0.42f}, 0.15f)};
  std::uint64_t pass = kFirstGlaze;
  for (const Glaze& glaze : kGlazes) {
    LayGlaze(picture, brush, tooth, glaze, plan, studio.seed, pass++);
  }
  return ToPicture(picture);
}

Expected<Picture> WatercolourPaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
