// Pen and brown wash from a set-up: bistre washes for the unlit parts, pen lines over them that follow the form: around
// the sphere, across the floor, down the wall, and the cast shadow hatched in its direction.
#include <cmath>

#include "exemplars/paint/engine/glaze.h"
#include "exemplars/paint/engine/media.h"
#include "exemplars/paint/engine/paper.h"
#include "exemplars/paint/engine/patches.h"
#include "exemplars/paint/scene.h"
#include "exemplars/paint/sphere.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kColdPress, 6.0f, {0.975f, 0.95f, 0.89f}, 0.035f};
constexpr glm::vec3 kInk{0.16f, 0.10f, 0.07f};

enum Pass : std::uint64_t { kFirstWash = kFirstStream, kFirstLines = 40 };

// Target lightness of sphere, floor and wall alike.
float Value(const Scene& scene, glm::vec2 at) {
  if (scene.SphereDistance(at) < 1.0f) {
    const Seen seen = scene.OnSphere(at);
    return 0.04f + 0.88f * std::pow(seen.light, 0.9f) + 0.14f * seen.bounce + 0.3f * seen.highlight;
  }
  const Seen seen = scene.Behind(at);
  if (!scene.IsFloor(at)) return 0.70f + 0.12f * seen.light;
  const float lit = 0.84f + 0.18f * seen.light;
  return glm::mix(lit, 0.16f, Ramp(0.05f, 0.80f, seen.cast)) - 0.14f * scene.Contact(at) * Ramp(0.5f, 0.9f, seen.cast);
}

void LayWashes(Colors& picture, Brush& brush, const Field& tooth, const Scene& scene, std::uint64_t seed) {
  const Flow over = scene.OverSphere(AroundAxis({-0.62f, 0.66f, -0.1f}));
  const Flow across = scene.AcrossFloor();
  const GlazePlan plan{[&](glm::vec2 at) { return Value(scene, at); },
                       [&](Chance& chance) -> Flow {
                         const Flow wall = Scene::Slanting(0.9f + chance.Bell(0.25f));
                         return [=, &scene](glm::vec2 at) {
                           if (scene.SphereDistance(at) < 1.0f) return over(at);
                           return scene.IsFloor(at) ? across(at) : wall(at);
                         };
                       }};
  struct Wash {
    glm::vec3 pigment, drift;
    float below, ragged, spacing, radius, edge, wetness;
  };
  constexpr Wash kWashes[] = {
      {{0.90f, 0.80f, 0.62f}, {0.92f, 0.84f, 0.70f}, 0.80f, 0.12f, 9.0f, 15.0f, 0.45f, 0.55f},
      {{0.82f, 0.67f, 0.46f}, {0.78f, 0.66f, 0.52f}, 0.60f, 0.12f, 9.0f, 14.0f, 0.60f, 0.35f},
      {{0.72f, 0.55f, 0.38f}, {0.66f, 0.54f, 0.44f}, 0.40f, 0.10f, 8.0f, 12.0f, 0.70f, 0.35f},
      {{0.62f, 0.46f, 0.34f}, {0.56f, 0.44f, 0.38f}, 0.24f, 0.06f, 8.0f, 10.0f, 0.70f, 0.35f},
      {{0.55f, 0.40f, 0.30f}, {0.50f, 0.38f, 0.32f}, 0.10f, 0.03f, 7.0f, 9.0f, 0.60f, 0.45f},
  };
  std::uint64_t pass = kFirstWash;
  for (const Wash& wash : kWashes) {
    LayGlaze(picture, brush, tooth,
             {.pigment = wash.pigment,
              .drift = wash.drift,
              .below = wash.below,
              .ragged = wash.ragged,
              .spacing = wash.spacing,
              .radius = wash.radius,
              .density = 0.75f,
              .edge = wash.edge,
              .wetness = wash.wetness,
              .length = 6.0f,
              .shortest = 3.0f},
             plan, seed, pass++);
  }
}

// One family of pen lines.
struct Family {
  Flow flow;
  PatchOptions patches;
  Touch where;  // pressure
  float radius = 1.6f;
};

void DrawLines(Canvas& canvas, Brush& pen, const Family& family, std::uint64_t seed, std::uint64_t stream) {
  Chance plan(seed, stream);
  Chance hand(seed, Hash(stream, 1));
  pen.Radius(family.radius);
  LayPatches(plan, family.flow, family.patches, [&](const Stroke& path, glm::vec2) {
    pen.Paint(canvas, Press(path, family.where, 1.0f + hand.Bell(0.15f), 0.25f));
  });
}

PatchOptions Lines(float apart, float length, float spacing) {
  return {.spacing = spacing,
          .touches_min = 4,
          .touches_max = 8,
          .apart = apart,
          .length_min = 0.7f * length,
          .length_max = 1.3f * length,
          .slant = 0.10f,
          .unevenness = 0.18f};
}

void DrawAllLines(Canvas& canvas, Brush& pen, const Scene& scene, std::uint64_t seed) {
  const auto dark = [&](glm::vec2 at) { return 1.0f - Value(scene, at); };
  const Touch on_sphere = [&](glm::vec2 at) { return scene.SphereDistance(at) < 0.992f ? dark(at) : -1.0f; };
  const Touch on_floor = [&](glm::vec2 at) {
    return scene.SphereDistance(at) > 1.005f && scene.IsFloor(at) ? dark(at) : -1.0f;
  };
  const Touch on_wall = [&](glm::vec2 at) {
    return scene.SphereDistance(at) > 1.01f && at.y < scene.horizon() - 4.0f ? dark(at) : -1.0f;
  };
  const auto press = [](Touch darkness, float from, float to, float heaviest) -> Touch {
    return [=](glm::vec2 at) { return heaviest * Ramp(from, to, darkness(at)); };
  };
  const Family families[] = {
      {Scene::Slanting(1.30f), Lines(11.0f, 120.0f, 84.0f), press(on_wall, 0.16f, 0.32f, 0.42f), 1.2f},
      {Scene::Slanting(0.80f), Lines(11.0f, 80.0f, 84.0f), press(on_wall, 0.235f, 0.33f, 0.42f), 1.2f},
      {scene.AcrossFloor(), Lines(11.0f, 110.0f, 84.0f), press(on_floor, 0.025f, 0.35f, 0.50f), 1.3f},
      {scene.AlongShadow(), Lines(7.5f, 80.0f, 44.0f), press(on_floor, 0.32f, 0.75f, 0.70f)},
      {Scene::Slanting(0.55f), Lines(8.5f, 56.0f, 46.0f), press(on_floor, 0.62f, 0.95f, 0.65f)},
      {scene.OverSphere(AroundAxis({-0.62f, 0.66f, 0.02f})), Lines(8.0f, 100.0f, 46.0f),
       press(on_sphere, 0.09f, 0.62f, 0.62f), 1.4f},
      {scene.OverSphere(AroundAxis({0.55f, 0.80f, 0.05f})), Lines(8.5f, 60.0f, 48.0f),
       press(on_sphere, 0.50f, 0.88f, 0.62f), 1.5f},
      {scene.OverSphere(AroundAxis({-0.95f, 0.10f, -0.1f})), Lines(8.5f, 46.0f, 48.0f),
       press(on_sphere, 0.80f, 0.97f, 0.60f)},
  };
  std::uint64_t stream = kFirstLines;
  for (const Family& family : families) DrawLines(canvas, pen, family, seed, stream++);
  // The outline swells in the shade and breaks in the light; so does the line where the wall stands.
  const Family outline{
      scene.OverSphere(AroundAxis({0.0f, 0.0f, 1.0f})),
      {.spacing = 15.0f, .touches_min = 1, .touches_max = 1, .length_min = 70.0f, .length_max = 150.0f, .slant = 0.02f},
      [&](glm::vec2 at) {
        const float off = std::fabs(scene.SphereDistance(at) - 0.996f);
        return off > 0.012f ? 0.0f : 0.35f + 0.55f * Ramp(0.2f, 0.8f, 1.0f - Value(scene, at));
      }};
  DrawLines(canvas, pen, outline, seed, stream++);
  const Family horizon{Scene::Slanting(0.0f),
                       {.spacing = 22.0f,
                        .touches_min = 1,
                        .touches_max = 1,
                        .length_min = 90.0f,
                        .length_max = 200.0f,
                        .slant = 0.008f},
                       [&](glm::vec2 at) {
                         return std::fabs(at.y - scene.horizon()) < 4.0f && scene.SphereDistance(at) > 1.02f ? 0.45f
                                                                                                             : 0.0f;
                       }};
  DrawLines(canvas, pen, horizon, seed, stream);
}

}  // namespace

Expected<Picture> PaintSceneInk(const Studio& studio) {
  SCUMBLE_ASSIGN(const Scene scene, Scene::Load(studio.scene));
  SCUMBLE_ASSIGN(Brush brush, Brush::Load(studio.brushes, "deevad/brush"));
  brush.Color(glm::vec3(0.2f));
  auto [tooth, picture] = PrepareGround({studio.size}, kPaper, studio.seed);
  LayWashes(picture, brush, tooth, scene, studio.seed);
  SCUMBLE_ASSIGN(Brush pen, Brush::Load(studio.brushes, "classic/pen"));
  pen.Color(kInk);
  Canvas lines({studio.size});
  DrawAllLines(lines, pen, scene, studio.seed);
  RubInto(picture, lines.Read(), tooth, {.bite = 0.12f, .softness = 0.4f, .density = 1.0f});
  return ToPicture(picture);
}

Expected<Picture> SceneInkPaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
