// Oil from a set-up: wall, floor and cast shadow first, with a wide brush, then the sphere over them, its edge cut in
// with touches around it. Orange on ochre; unlit parts turn to violet, and the floor reflects light into the sphere's
// shade.
#include <cmath>

#include "exemplars/paint/engine/impasto.h"
#include "exemplars/paint/engine/patches.h"
#include "exemplars/paint/scene.h"
#include "exemplars/paint/sphere.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

// Impasto uses the lower streams for its own passes.
enum Pass : std::uint64_t { kWallPass = 200, kFloorPass, kShadowPass, kBallPass, kEdgePass, kLightPass };

glm::vec3 OfWall(const Seen& seen) {
  glm::vec3 color =
      glm::mix(glm::vec3(0.27f, 0.31f, 0.36f), glm::vec3(0.44f, 0.50f, 0.50f), Ramp(0.10f, 0.42f, seen.light));
  return glm::mix(color, glm::vec3(0.68f, 0.69f, 0.60f), Ramp(0.38f, 0.75f, seen.light));
}

glm::vec3 OfFloor(const Seen& seen, float contact) {
  const glm::vec3 lit =
      glm::mix(glm::vec3(0.71f, 0.56f, 0.39f), glm::vec3(0.93f, 0.80f, 0.56f), Ramp(0.35f, 0.95f, seen.light));
  glm::vec3 color = glm::mix(lit, glm::vec3(0.60f, 0.42f, 0.44f), Ramp(0.08f, 0.45f, seen.cast));
  color = glm::mix(color, glm::vec3(0.32f, 0.24f, 0.42f), Ramp(0.35f, 0.85f, seen.cast));
  return glm::mix(color, glm::vec3(0.17f, 0.09f, 0.15f), 0.9f * contact * Ramp(0.5f, 0.95f, seen.cast));
}

glm::vec3 OfSphere(const Seen& seen) {
  glm::vec3 color =
      glm::mix(glm::vec3(0.25f, 0.10f, 0.23f), glm::vec3(0.56f, 0.17f, 0.19f), Ramp(0.0f, 0.20f, seen.light));
  color = glm::mix(color, glm::vec3(0.85f, 0.34f, 0.15f), Ramp(0.14f, 0.46f, seen.light));
  color = glm::mix(color, glm::vec3(0.96f, 0.60f, 0.24f), Ramp(0.42f, 0.85f, seen.light));
  color = glm::mix(color, glm::vec3(1.0f, 0.80f, 0.45f), Ramp(0.82f, 1.0f, seen.light));
  // Ochre from the floor.
  return glm::mix(color, glm::vec3(0.66f, 0.36f, 0.22f),
                  0.75f * Ramp(0.40f, 1.0f, seen.bounce) * Ramp(0.20f, 0.0f, seen.light));
}

// One tone a patch, broken from touch to touch.
struct Hand {
  Impasto& painting;
  Chance chance;
  float broken;

  void Touch(const Stroke& path, const Impasto::Tuft& tuft, glm::vec3 color) {
    const float warmth = chance.Bell(broken);
    const float light = 1.0f + chance.Bell(0.8f * broken);
    painting.DragBristles(chance, path, tuft,
                          glm::clamp(color * light * glm::vec3(1.0f + warmth, 1.0f, 1.0f - 1.3f * warmth), 0.0f, 1.0f));
  }
};

void PaintWall(Impasto& painting, const Scene& scene, std::uint64_t seed) {
  Hand hand{painting, Chance(seed, Hash(kWallPass, 1)), 0.035f};
  int layer = 0;
  for (const float size : {1.5f, 1.0f, 0.85f}) {
    Chance plan(seed, Hash(kWallPass, 2, layer));
    // Crossing slants, as a wide brush scrubs in a background.
    const Flow flow = Scene::Slanting(layer == 1 ? -0.65f : 0.85f);
    const PatchOptions patches{.spacing = 44.0f * size,
                               .touches_min = 2,
                               .touches_max = 4,
                               .apart = 18.0f * size,
                               .length_min = 60.0f * size,
                               .length_max = 105.0f * size,
                               .slant = 0.5f};
    LayPatches(plan, flow, patches, [&](const Stroke& path, glm::vec2 patch) {
      if (patch.y > scene.horizon() + 10.0f || scene.SphereDistance(patch) < 0.86f) return;
      hand.Touch(path, {22.0f * size, 2.7f, 0.25f, 0.9f}, OfWall(scene.Behind(patch)));
    });
    ++layer;
  }
}

void PaintFloor(Impasto& painting, const Scene& scene, std::uint64_t seed) {
  Hand hand{painting, Chance(seed, Hash(kFloorPass, 1)), 0.04f};
  int layer = 0;
  for (const float size : {1.4f, 1.0f, 0.85f}) {
    Chance plan(seed, Hash(kFloorPass, 2, layer++));
    const PatchOptions patches{.spacing = 38.0f * size,
                               .touches_min = 1,
                               .touches_max = 2,
                               .apart = 15.0f * size,
                               .length_min = 60.0f * size,
                               .length_max = 120.0f * size,
                               .slant = 0.10f};
    LayPatches(plan, scene.AcrossFloor(), patches, [&](const Stroke& path, glm::vec2 patch) {
      if (patch.y < scene.horizon() - 2.0f || scene.SphereDistance(patch) < 0.80f) return;
      const float near = glm::mix(0.55f, 1.15f, scene.Nearness(patch));
      const Seen seen = scene.Behind(patch);
      const float load = glm::mix(0.75f, 0.15f, seen.cast);
      hand.Touch(path, {18.0f * size * near, 2.4f, load, 0.9f}, OfFloor(seen, scene.Contact(patch)));
    });
  }
  // The shadow again, thin, in its direction, so that strokes draw its edge and not the pixels of the guides.
  Hand shadow{painting, Chance(seed, Hash(kShadowPass, 1)), 0.035f};
  Chance plan(seed, Hash(kShadowPass, 2));
  const PatchOptions patches{.spacing = 30.0f,
                             .touches_min = 1,
                             .touches_max = 3,
                             .apart = 13.0f,
                             .length_min = 45.0f,
                             .length_max = 85.0f,
                             .slant = 0.14f};
  LayPatches(plan, scene.AlongShadow(), patches, [&](const Stroke& path, glm::vec2 patch) {
    const Seen seen = scene.Behind(patch);
    if (patch.y < scene.horizon() || scene.SphereDistance(patch) < 0.85f || seen.cast < 0.12f) return;
    shadow.Touch(path, {14.0f, 2.2f, 0.12f, 1.1f}, OfFloor(seen, scene.Contact(patch)));
  });
}

// The edge is cut in along the outline, a stroke at a time.
void CutInEdge(Impasto& painting, const Scene& scene, std::uint64_t seed, int round, float narrow, float wide) {
  Hand edge{painting, Chance(seed, Hash(kEdgePass, 2 * round)), 0.04f};
  const Flow outline = scene.OverSphere(AroundAxis({0.0f, 0.0f, 1.0f}));
  Chance plan(seed, Hash(kEdgePass, 2 * round + 1));
  for (const glm::vec2 middle : SowEvenly(plan, 13.0f)) {
    const float distance = scene.SphereDistance(middle);
    if (distance < 0.93f || distance > 0.985f) continue;
    edge.Touch(TraceStroke(outline, middle, plan.Uniform(26.0f, 56.0f)), {plan.Uniform(narrow, wide), 2.0f, 0.4f, 1.0f},
               OfSphere(scene.OnSphere(middle)));
  }
}

void PaintBall(Impasto& painting, const Scene& scene, std::uint64_t seed) {
  const Touch inside = [&](glm::vec2 at) { return scene.SphereDistance(at) < 0.995f ? 1.0f : 0.0f; };
  Hand hand{painting, Chance(seed, Hash(kBallPass, 1)), 0.045f};
  int layer = 0;
  CutInEdge(painting, scene, seed, 0, 15.0f, 19.0f);
  for (const float size : {1.6f, 1.0f, 0.75f}) {
    Chance plan(seed, Hash(kBallPass, 2, layer));
    const Flow flow = scene.OverSphere(AroundAxis(kKeyLight + glm::vec3(-0.25f, 0.10f, -0.45f)));
    // The first cover hides the wall completely.
    const PatchOptions patches{.spacing = (layer == 0 ? 20.0f : 27.0f) * size,
                               .touches_min = 1,
                               .touches_max = 3,
                               .apart = 12.0f * size,
                               .length_min = 40.0f * size,
                               .length_max = 72.0f * size,
                               .slant = layer == 1 ? 0.5f : 0.3f};
    LayPatches(plan, flow, patches, [&](const Stroke& path, glm::vec2 patch) {
      if (scene.SphereDistance(patch) > 0.99f - 0.035f * size) return;
      const Seen seen = scene.OnSphere(patch);
      const float load = 0.30f + 0.65f * Ramp(0.1f, 0.9f, seen.light);
      const glm::vec3 color = OfSphere(seen);
      for (const Stroke& piece : Press(path, inside, 1.0f, 0.02f))
        hand.Touch(piece, {15.0f * size, 2.3f, load, 1.0f}, color);
    });
    ++layer;
  }
  CutInEdge(painting, scene, seed, 1, 7.0f, 11.0f);
  // The mirror image of the light, thick and last.
  Hand light{painting, Chance(seed, Hash(kLightPass, 1)), 0.012f};
  Chance dabs(seed, Hash(kLightPass, 2));
  const Flow flow = scene.OverSphere(AroundAxis(kKeyLight + glm::vec3(0.1f, -0.1f, -0.4f)));
  for (const glm::vec2 middle : SowEvenly(dabs, 13.0f)) {
    if (scene.SphereDistance(middle) > 0.9f) continue;
    const float mirrored = scene.OnSphere(middle).highlight;
    if (!dabs.Happens(1.2f * Ramp(0.30f, 0.85f, mirrored))) continue;
    light.Touch(TraceStroke(flow, middle, dabs.Uniform(16.0f, 34.0f)), {dabs.Uniform(8.0f, 13.0f), 2.2f, 1.0f, 0.4f},
                glm::mix(glm::vec3(1.0f, 0.86f, 0.60f), glm::vec3(1.0f, 0.975f, 0.90f), Ramp(0.4f, 0.9f, mirrored)));
  }
}

}  // namespace

Expected<Picture> PaintSceneOil(const Studio& studio) {
  SCUMBLE_ASSIGN(const Scene scene, Scene::Load(studio.scene));
  SCUMBLE_ASSIGN(Impasto painting, Impasto::Begin({studio.size}, studio, {0.56f, 0.44f, 0.36f}));
  PaintWall(painting, scene, studio.seed);
  PaintFloor(painting, scene, studio.seed);
  PaintBall(painting, scene, studio.seed);
  return ToPicture(painting.Finish(0.85f));
}

Expected<Picture> SceneOilGround(const Studio& studio) {
  constexpr glm::vec3 kWall{0.56f, 0.58f, 0.54f};
  SCUMBLE_ASSIGN(Impasto ground, Impasto::Begin(TileFor(studio.size), studio, 0.96f * kWall));
  ground.BrushGround(kWall);
  return ToPicture(ground.Finish(0.5f));
}

}  // namespace scumble::paint
