// Soft pastel on sand-coloured paper, from a set-up: a turquoise sphere, rose floor, lilac wall. Sticks are laid broad
// and side by side, first the local colours, then light and shade over them, then the sharp ends: paper shows between
// them.
#include <cmath>

#include "exemplars/paint/engine/drawing.h"
#include "exemplars/paint/engine/patches.h"
#include "exemplars/paint/scene.h"
#include "exemplars/paint/sphere.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kLaid, 5.5f, {0.76f, 0.69f, 0.58f}, 0.05f};
constexpr const char* kStick = "tanda/charcoal-04";
constexpr const char* kTip = "classic/charcoal";

// The use of one stick in the picture.
struct Turn {
  const char* preset;
  float radius;
  glm::vec3 color;
  float heaviest;  // pressure
  Flow flow;
  PatchOptions patches;
  Touch where;  // 0 … 1
};

class Sticks {
 public:
  Sticks(Drawing& drawing, const Studio& studio, std::uint64_t first)
      : drawing_(drawing), studio_(studio), stream_(first) {}

  Status Lay(const Turn& turn) {
    SCUMBLE_ASSIGN(Brush stick, Brush::Load(studio_.brushes, turn.preset));
    stick.Radius(turn.radius);
    Chance plan(studio_.seed, stream_++);
    Chance hand(studio_.seed, Hash(stream_, 77));
    LayPatches(plan, turn.flow, turn.patches, [&](const Stroke& path, glm::vec2 patch) {
      // Density follows the tone, not only pressure: where little is needed there are few strokes.
      if (!hand.Happens(1.3f * turn.where(patch))) return;
      const float shift = hand.Bell(0.035f);
      stick.Color(glm::clamp(turn.color * glm::vec3(1.0f + shift, 1.0f + hand.Bell(0.02f), 1.0f - shift), 0.0f, 1.0f));
      stick.Paint(drawing_.canvas(), Press(path, turn.where, turn.heaviest * (1.0f + hand.Bell(0.15f)), 0.12f));
    });
    return Ok();
  }

 private:
  Drawing& drawing_;
  const Studio& studio_;
  std::uint64_t stream_;
};

PatchOptions Broad(float length) {
  return {.spacing = 34.0f,
          .touches_min = 3,
          .touches_max = 5,
          .apart = 13.0f,
          .length_min = 0.7f * length,
          .length_max = 1.3f * length,
          .slant = 0.22f};
}
PatchOptions Narrow(float length) {
  return {.spacing = 33.0f,
          .touches_min = 2,
          .touches_max = 4,
          .apart = 11.0f,
          .length_min = 0.7f * length,
          .length_max = 1.3f * length,
          .slant = 0.30f};
}

struct Places {
  const Scene& scene;

  float Sphere(glm::vec2 at) const { return Ramp(1.005f, 0.985f, scene.SphereDistance(at)); }
  float Wall(glm::vec2 at) const { return scene.SphereDistance(at) > 0.98f && !scene.IsFloor(at) ? 1.0f : 0.0f; }
  float Floor(glm::vec2 at) const { return scene.SphereDistance(at) > 0.98f && scene.IsFloor(at) ? 1.0f : 0.0f; }
  // A touch that depends on the values there.
  template <class Where>
  Touch OnSphere(Where where) const {
    return [this, where](glm::vec2 at) { return Sphere(at) > 0.0f ? Sphere(at) * where(scene.OnSphere(at)) : 0.0f; };
  }
  template <class Where>
  Touch OnWall(Where where) const {
    return [this, where](glm::vec2 at) { return Wall(at) > 0.0f ? where(scene.Behind(at)) : 0.0f; };
  }
  template <class Where>
  Touch OnFloor(Where where) const {
    return [this, where](glm::vec2 at) { return Floor(at) > 0.0f ? where(scene.Behind(at)) : 0.0f; };
  }
};

Status LayGroundColors(Drawing& drawing, const Studio& studio, const Places& at) {
  Sticks sticks(drawing, studio, kFirstStream);
  const Scene& scene = at.scene;
  const Flow down = Scene::Slanting(1.15f), up = Scene::Slanting(-0.95f), across = scene.AcrossFloor();
  const Flow round = scene.OverSphere(AroundAxis({-0.62f, 0.66f, 0.10f}));
  PatchOptions close = Broad(70);
  close.spacing = 25.0f;
  SCUMBLE_RETURN_IF_ERROR(sticks.Lay(
      {kStick, 7.0f, {0.56f, 0.53f, 0.72f}, 0.55f, down, Broad(95), at.OnWall([](const Seen&) { return 1.0f; })}));
  SCUMBLE_RETURN_IF_ERROR(
      sticks.Lay({kStick, 6.0f, {0.70f, 0.68f, 0.84f}, 0.50f, up, Broad(85), at.OnWall([](const Seen& s) {
                    return Ramp(0.15f, 0.55f, s.light);
                  })}));
  SCUMBLE_RETURN_IF_ERROR(
      sticks.Lay({kStick, 7.0f, {0.92f, 0.66f, 0.60f}, 0.60f, across, Broad(110), at.OnFloor([](const Seen& s) {
                    return Ramp(0.9f, 0.5f, s.cast);
                  })}));
  SCUMBLE_RETURN_IF_ERROR(sticks.Lay(
      {kStick, 6.5f, {0.33f, 0.27f, 0.58f}, 0.75f, scene.AlongShadow(), Broad(80), at.OnFloor([](const Seen& s) {
         return Ramp(0.20f, 0.75f, s.cast);
       })}));
  SCUMBLE_RETURN_IF_ERROR(sticks.Lay(
      {kStick, 6.0f, {0.20f, 0.55f, 0.58f}, 0.75f, round, close, at.OnSphere([](const Seen&) { return 1.0f; })}));
  return sticks.Lay({kStick, 6.0f, {0.16f, 0.17f, 0.44f}, 0.8f, round, Broad(60), at.OnSphere([](const Seen& s) {
                       return Ramp(0.26f, 0.04f, s.light);
                     })});
}

Status Model(Drawing& drawing, const Studio& studio, const Places& at) {
  Sticks sticks(drawing, studio, 40);
  const Scene& scene = at.scene;
  const Flow slant = scene.OverSphere(AroundAxis({-0.85f, 0.35f, 0.0f}));
  const Flow round = scene.OverSphere(AroundAxis({-0.55f, 0.75f, -0.10f}));
  const Flow across = scene.AcrossFloor();
  PatchOptions sparse = Narrow(70);
  sparse.spacing = 46.0f;
  SCUMBLE_RETURN_IF_ERROR(
      sticks.Lay({kTip, 4.0f, {0.98f, 0.86f, 0.70f}, 0.60f, across, Narrow(95), at.OnFloor([](const Seen& s) {
                    return Ramp(0.35f, 0.85f, s.light);
                  })}));
  SCUMBLE_RETURN_IF_ERROR(
      sticks.Lay({kTip, 3.2f, {0.85f, 0.49f, 0.46f}, 0.55f, across, sparse, at.OnFloor([](const Seen& s) {
                    return 0.6f * Ramp(0.5f, 0.1f, s.cast);
                  })}));
  SCUMBLE_RETURN_IF_ERROR(
      sticks.Lay({kTip, 3.2f, {0.53f, 0.50f, 0.82f}, 0.50f, Scene::Slanting(1.15f), sparse, at.OnWall([](const Seen&) {
                    return 0.5f;
                  })}));
  SCUMBLE_RETURN_IF_ERROR(
      sticks.Lay({kTip, 3.8f, {0.60f, 0.38f, 0.62f}, 0.60f, across, Narrow(60), at.OnFloor([](const Seen& s) {
                    return 0.9f * Ramp(0.05f, 0.25f, s.cast) * Ramp(0.75f, 0.4f, s.cast);
                  })}));
  SCUMBLE_RETURN_IF_ERROR(sticks.Lay(
      {kTip, 3.8f, {0.44f, 0.47f, 0.78f}, 0.55f, Scene::Slanting(0.75f), Narrow(70), at.OnWall([](const Seen& s) {
         return 0.8f * Ramp(0.40f, 0.15f, s.light);
       })}));
  SCUMBLE_RETURN_IF_ERROR(sticks.Lay(
      {kTip, 3.8f, {0.90f, 0.82f, 0.86f}, 0.50f, Scene::Slanting(-0.7f), Narrow(70), at.OnWall([](const Seen& s) {
         return 0.8f * Ramp(0.35f, 0.65f, s.light);
       })}));
  SCUMBLE_RETURN_IF_ERROR(
      sticks.Lay({kTip, 3.8f, {0.40f, 0.74f, 0.68f}, 0.70f, round, Narrow(55), at.OnSphere([](const Seen& s) {
                    return Ramp(0.28f, 0.62f, s.light);
                  })}));
  SCUMBLE_RETURN_IF_ERROR(
      sticks.Lay({kTip, 3.8f, {0.70f, 0.88f, 0.68f}, 0.75f, slant, Narrow(50), at.OnSphere([](const Seen& s) {
                    return Ramp(0.58f, 0.90f, s.light);
                  })}));
  SCUMBLE_RETURN_IF_ERROR(
      sticks.Lay({kTip, 3.4f, {0.27f, 0.22f, 0.58f}, 0.75f, slant, Narrow(48), at.OnSphere([](const Seen& s) {
                    return Ramp(0.24f, 0.08f, s.light);
                  })}));
  return sticks.Lay({kTip, 3.4f, {0.84f, 0.48f, 0.52f}, 0.70f, round, Narrow(44), at.OnSphere([](const Seen& s) {
                       return 0.85f * Ramp(0.45f, 0.85f, s.bounce) * Ramp(0.20f, 0.03f, s.light);
                     })});
}

Status SetAccents(Drawing& drawing, const Studio& studio, const Places& at) {
  Sticks sticks(drawing, studio, 80);
  const Scene& scene = at.scene;
  const Flow slant = scene.OverSphere(AroundAxis({-0.85f, 0.35f, 0.0f}));
  const Flow outline = scene.OverSphere(AroundAxis({0.0f, 0.0f, 1.0f}));
  PatchOptions few = Narrow(60);
  few.spacing = 52.0f;
  SCUMBLE_RETURN_IF_ERROR(
      sticks.Lay({kTip, 3.2f, {1.0f, 0.95f, 0.82f}, 0.60f, scene.AcrossFloor(), few, at.OnFloor([](const Seen& s) {
                    return 0.7f * Ramp(0.75f, 0.98f, s.light);
                  })}));
  SCUMBLE_RETURN_IF_ERROR(
      sticks.Lay({kTip, 2.6f, {0.98f, 0.95f, 0.66f}, 0.60f, slant, Narrow(56), at.OnSphere([](const Seen& s) {
                    return 0.8f * Ramp(0.76f, 0.98f, s.light);
                  })}));
  SCUMBLE_RETURN_IF_ERROR(
      sticks.Lay({kStick, 4.0f, {0.17f, 0.13f, 0.38f}, 0.70f, scene.AlongShadow(), Broad(60), [&](glm::vec2 p) {
                    return at.Floor(p) * scene.Contact(p) * Ramp(0.5f, 0.9f, scene.Behind(p).cast);
                  }}));
  SCUMBLE_RETURN_IF_ERROR(sticks.Lay({kTip,
                                      1.9f,
                                      {0.18f, 0.16f, 0.42f},
                                      0.42f,
                                      outline,
                                      {.spacing = 26.0f,
                                       .touches_min = 1,
                                       .touches_max = 1,
                                       .length_min = 50.0f,
                                       .length_max = 110.0f,
                                       .slant = 0.04f},
                                      [&](glm::vec2 p) {
                                        const float off = std::fabs(scene.SphereDistance(p) - 0.988f);
                                        return Ramp(0.020f, 0.006f, off) * Ramp(0.65f, 0.2f, scene.OnSphere(p).light);
                                      }}));
  return sticks.Lay(
      {kTip,
       3.6f,
       {1.0f, 0.99f, 0.95f},
       1.0f,
       slant,
       {.spacing = 12.0f, .touches_min = 1, .touches_max = 2, .apart = 7.0f, .length_min = 18.0f, .length_max = 34.0f},
       at.OnSphere([](const Seen& s) { return Ramp(0.35f, 0.75f, s.highlight); })});
}

}  // namespace

Expected<Picture> PaintScenePastel(const Studio& studio) {
  SCUMBLE_ASSIGN(const Scene scene, Scene::Load(studio.scene));
  const Places places{scene};
  Drawing ground(PrepareGround({studio.size}, kPaper, studio.seed),
                 {.bite = 0.75f, .softness = 0.30f, .density = 1.1f});
  SCUMBLE_RETURN_IF_ERROR(LayGroundColors(ground, studio, places));
  Drawing model(ground.AsGround(), {.bite = 0.52f, .softness = 0.26f, .density = 1.15f});
  SCUMBLE_RETURN_IF_ERROR(Model(model, studio, places));
  Drawing accents(model.AsGround(), {.bite = 0.60f, .softness = 0.28f, .density = 1.2f});
  SCUMBLE_RETURN_IF_ERROR(SetAccents(accents, studio, places));
  return ToPicture(accents.Look());
}

Expected<Picture> ScenePastelPaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
