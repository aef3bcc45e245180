// Soft pastel on dark blue-violet sanded paper, three times the same sphere. Broad strokes with the side of the stick,
// a finger here and there, then crisp strokes of other colours laid over them; the dark paper flickers between all of
// them.
#include <array>
#include <cmath>
#include <span>

#include "exemplars/paint/engine/colouring.h"
#include "exemplars/paint/engine/drawing.h"
#include "exemplars/paint/engine/impasto.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kLaid, 4.0f, {0.165f, 0.145f, 0.235f}, 0.05f};

constexpr float kBlockSpacing = 23.0f;
// How uneven the hand is.
constexpr float kUnevenness = 0.30f;
constexpr int kFacets = 4;
// A facet's radius as a share of the stroke's width, so that neighbours overlap.
constexpr float kFacet = 0.17f;

enum Pass : std::uint64_t { kClouds = kFirstStream, kFinger, kHighlight, kSide = 6, kBody = 100, kSparks = 300 };

// What the three sheets differ in.
struct Plan {
  Palette palette;
  std::span<const glm::vec3> box;     // sticks
  std::span<const glm::vec3> sparks;  // the purest of them, for the last strokes
  std::array<glm::vec3, 4> axes;
  float side_width;
  float closed;  // share of the middle of the sphere that the first strokes cover
  float body_width;
  int body_rounds;
  glm::vec3 depth;  // of the first layer, against what is wanted
  float cover;      // how far that layer closes over the paper
};

constexpr glm::vec3 kLitBox[] = {
    {1.00f, 0.91f, 0.70f}, {0.99f, 0.80f, 0.61f}, {0.97f, 0.71f, 0.68f}, {0.95f, 0.82f, 0.52f}, {0.94f, 0.57f, 0.46f},
    {0.86f, 0.36f, 0.50f}, {0.60f, 0.28f, 0.58f}, {0.22f, 0.28f, 0.66f}, {0.32f, 0.20f, 0.52f}, {0.16f, 0.52f, 0.62f},
};
constexpr glm::vec3 kLitSparks[] = {
    {1.00f, 0.92f, 0.64f}, {1.00f, 0.76f, 0.74f}, {0.98f, 0.63f, 0.42f}, {0.30f, 0.76f, 0.74f}, {0.28f, 0.40f, 0.86f},
};
constexpr glm::vec3 kHalfBox[] = {
    {0.88f, 0.68f, 0.46f}, {0.82f, 0.52f, 0.50f}, {0.50f, 0.58f, 0.50f}, {0.68f, 0.38f, 0.50f},
    {0.52f, 0.34f, 0.60f}, {0.30f, 0.50f, 0.58f}, {0.22f, 0.28f, 0.60f}, {0.32f, 0.18f, 0.46f},
};
constexpr glm::vec3 kHalfSparks[] = {
    {0.94f, 0.66f, 0.46f}, {0.86f, 0.48f, 0.60f}, {0.40f, 0.64f, 0.66f}, {0.58f, 0.44f, 0.80f}};
constexpr glm::vec3 kShadeBox[] = {
    {0.34f, 0.46f, 0.74f}, {0.22f, 0.30f, 0.64f}, {0.18f, 0.46f, 0.56f},
    {0.36f, 0.26f, 0.58f}, {0.24f, 0.16f, 0.42f}, {0.46f, 0.22f, 0.42f},
};
constexpr glm::vec3 kShadeSparks[] = {{0.30f, 0.66f, 0.74f}, {0.46f, 0.44f, 0.86f}, {0.66f, 0.30f, 0.50f}};

constexpr Plan kLit{.palette{.high{1.00f, 0.95f, 0.74f},
                             .light{0.99f, 0.80f, 0.58f},
                             .middle{0.93f, 0.54f, 0.46f},
                             .turn{0.62f, 0.30f, 0.54f},
                             .core{0.24f, 0.20f, 0.54f},
                             .reflected{0.20f, 0.48f, 0.64f},
                             .warm{{{0.98f, 0.71f, 0.68f}, {0.96f, 0.83f, 0.52f}}},
                             .cool{{{0.16f, 0.46f, 0.64f}, {0.50f, 0.22f, 0.54f}}}},
                    .box = kLitBox,
                    .sparks = kLitSparks,
                    .axes{{kAlongShade, kDiagonal, kAgainst, kAcross}},
                    .side_width = 30.0f,
                    .closed = 0.8f,
                    .body_width = 17.0f,
                    .body_rounds = 3,
                    .depth{0.93f, 0.80f, 0.86f},
                    .cover = 1.0f};
constexpr Plan kHalf{.palette{.high{0.86f, 0.64f, 0.44f},
                              .light{0.78f, 0.54f, 0.46f},
                              .middle{0.62f, 0.40f, 0.52f},
                              .turn{0.40f, 0.27f, 0.52f},
                              .core{0.19f, 0.20f, 0.46f},
                              .reflected{0.20f, 0.42f, 0.52f},
                              .warm{{{0.52f, 0.56f, 0.50f}, {0.84f, 0.50f, 0.52f}}},
                              .cool{{{0.22f, 0.46f, 0.56f}, {0.44f, 0.22f, 0.52f}}}},
                     .box = kHalfBox,
                     .sparks = kHalfSparks,
                     .axes{{kDiagonal, kDiagonal, kAlongShade, kDiagonal}},
                     .side_width = 28.0f,
                     .closed = 0.8f,
                     .body_width = 15.0f,
                     .body_rounds = 3,
                     .depth{0.80f, 0.72f, 0.84f},
                     .cover = 0.95f};
constexpr Plan kShade{.palette{.high{0.36f, 0.50f, 0.76f},
                               .light{0.28f, 0.38f, 0.70f},
                               .middle{0.22f, 0.28f, 0.60f},
                               .turn{0.26f, 0.20f, 0.50f},
                               .core{0.20f, 0.15f, 0.36f},
                               .reflected{0.44f, 0.22f, 0.40f},
                               .warm{{{0.20f, 0.48f, 0.58f}, {0.36f, 0.30f, 0.66f}}},
                               .cool{{{0.16f, 0.40f, 0.46f}, {0.38f, 0.18f, 0.44f}}}},
                      .box = kShadeBox,
                      .sparks = kShadeSparks,
                      .axes{{kAcross, kAlongShade, kAcross, kAcross}},
                      .side_width = 34.0f,
                      .closed = 0.45f,
                      .body_width = 18.0f,
                      .body_rounds = 2,
                      .depth{0.8f, 0.8f, 0.9f},
                      .cover = 0.85f};

const Plan& PlanFor(Light light) { return light == Light::kKey ? kLit : light == Light::kGrazing ? kHalf : kShade; }

// Clouds of other hues drift over the form, so that neighbouring passages never have one colour.
TargetColors TargetColorsFor(const Plan& plan, const Studio& studio) {
  return MakeTargetColors([&](glm::vec2 at) {
    const auto cloud = [&](float width, std::uint64_t which) {
      return CloudNoise(at / width, 3, Hash(Hash(studio.seed, kClouds), which)) - 0.5f;
    };
    Shading shading = ShadingAt(at, studio.light);
    shading.light = glm::clamp(shading.light + 0.18f * cloud(75.0f, 1), 0.0f, 1.0f);
    const bool first = cloud(65.0f, 2) > 0.0f;
    const glm::vec3 other =
        glm::mix(plan.palette.cool[first ? 0 : 1], plan.palette.warm[first ? 0 : 1], Ramp(0.10f, 0.5f, shading.light));
    return glm::mix(plan.palette.At(shading), other, 0.65f * Ramp(0.02f, 0.22f, std::fabs(cloud(55.0f, 3))));
  });
}

// Puts the sphere in with the side of the stick: everywhere, and well past the rim, the stick that is nearest to the
// colour wanted, or nearly so.
void BlockIn(Colouring& drawing, Brush& brush, const Plan& plan, const Studio& studio,
             const TargetColors& target_colors) {
  Chance chance(studio.seed, kSide);
  std::vector<std::vector<Stroke>> strokes(plan.box.size());
  for (const glm::vec2 middle : SowEvenly(chance, kBlockSpacing)) {
    // Towards the rim strokes shorten, so there are more of them.
    const float rim = RimDistance(middle);
    if (rim > 1.12f || !chance.Happens(glm::mix(plan.closed, 1.0f, Ramp(0.6f, 0.9f, rim)))) continue;
    const glm::vec3 wanted = ColorIn(target_colors, middle);
    std::size_t nearest = 0;
    float least = 10.0f;
    for (std::size_t i = 0; i < plan.box.size(); ++i) {
      const float distance = glm::distance(plan.box[i], wanted) + chance.Bell(0.05f);
      if (distance < least) {
        least = distance;
        nearest = i;
      }
    }
    const Flow flow = AroundAxis(plan.axes[0] + chance.Bell3(0.2f));
    const Stroke path = TraceStroke(flow, middle, chance.Uniform(70.0f, 130.0f));
    const float press = chance.Uniform(0.5f, 0.8f);
    const auto pieces = Press(path, [=](glm::vec2) { return press; });
    strokes[nearest].insert(strokes[nearest].end(), pieces.begin(), pieces.end());
  }
  brush.Radius(kFacet * plan.side_width);
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    drawing.Draw(brush, {plan.box[i]}, Facets(chance, strokes[i], plan.side_width, kFacets, 0.0f),
                 {.media = {.bite = 0.7f, .softness = 0.25f}, .load = plan.cover, .crumble = 0.5f});
  }
}

// Each stick in turn, for as many rounds: look, then strokes where it helps.
struct Turn {
  std::span<const glm::vec3> sticks;
  std::uint64_t first_stream;
  int rounds;
  Hand hand;
  Settling settling;
  float width;  // of a stroke
};
void WorkOver(Colouring& drawing, Brush& brush, const Plan& plan, const Studio& studio,
              const TargetColors& target_colors, const Turn& turn, const HatchOptions& hatch) {
  const std::size_t count = turn.sticks.size();
  for (int round = 0; round < turn.rounds; ++round) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint64_t number = static_cast<std::uint64_t>(round) * count + i;
      Chance chance(studio.seed, turn.first_stream + number);
      // Not always from the lightest to the darkest.
      const Stick stick{turn.sticks[(i * 7 + static_cast<std::size_t>(round) * 3) % count]};
      const glm::vec3 axis = plan.axes[number % plan.axes.size()];
      const Touch touch = AwayFromPoles(drawing.Nearer(target_colors, stick, turn.hand), axis);
      const auto strokes = PlanHatching(chance, AroundAxis, axis, touch, hatch);
      drawing.Draw(brush, stick, Facets(chance, strokes, turn.width, kFacets, 2.6f * turn.width), turn.settling);
    }
  }
}

Status Work(Colouring& drawing, const Plan& plan, const Studio& studio) {
  const TargetColors target_colors = TargetColorsFor(plan, studio);
  // Light over dark: what is laid first is deeper than what is wanted.
  TargetColors deep = target_colors;
  for (glm::vec3& color : deep.pixels) color *= plan.depth;
  SCUMBLE_ASSIGN(Brush stick, Brush::Load(studio.brushes, "tanda/acrylic-05-paint"));

  BlockIn(drawing, stick, plan, studio, deep);

  SCUMBLE_ASSIGN(Brush finger, Brush::Load(studio.brushes, "deevad/blending"));
  finger.Radius(13.0f);
  Chance rub(studio.seed, kFinger);
  HatchOptions rubbed;
  rubbed.unevenness = kUnevenness;
  rubbed.patches = 150;
  rubbed.strokes_min = 2;
  rubbed.strokes_max = 4;
  rubbed.spacing = 28.0f;
  const Touch soft = [](glm::vec2 at) { return 0.5f * Ramp(1.10f, 1.06f, RimDistance(at)); };
  drawing.Rub(finger, PlanHatching(rub, AroundAxis, plan.axes[0], soft, rubbed));

  HatchOptions hatch;
  hatch.unevenness = kUnevenness;
  hatch.patches = 60;
  hatch.strokes_min = 3;
  hatch.strokes_max = 7;
  hatch.spacing = 1.3f * plan.body_width;
  hatch.length_min = 60.0f;
  hatch.length_max = 120.0f;
  stick.Radius(kFacet * plan.body_width);
  WorkOver(drawing, stick, plan, studio, target_colors,
           {.sticks = plan.box,
            .first_stream = kBody,
            .rounds = plan.body_rounds,
            .hand = {.lightest = 0.4f, .heaviest = 0.8f, .reach = 0.5f, .overhang = 1.08f},
            .settling = {.media = {.bite = 0.8f, .softness = 0.2f}, .load = 0.85f, .crumble = 0.5f},
            .width = plan.body_width},
           hatch);

  hatch.patches = 45;
  hatch.strokes_min = 3;
  hatch.strokes_max = 8;
  hatch.length_min = 80.0f;
  hatch.length_max = 150.0f;
  const float crisp = 0.6f * plan.body_width;
  hatch.spacing = 2.0f * crisp;
  stick.Radius(kFacet * crisp);
  WorkOver(drawing, stick, plan, studio, target_colors,
           {.sticks = plan.sparks,
            .first_stream = kSparks,
            .rounds = 2,
            .hand = {.lightest = 0.6f, .heaviest = 0.9f, .least = 0.04f, .reach = 0.45f, .overhang = 1.04f},
            .settling = {.media = {.bite = 0.85f, .softness = 0.16f}, .load = 0.8f, .crumble = 0.5f},
            .width = crisp},
           hatch);
  return Ok();
}

// Pressed on until the tooth is full.
Status LayHighlight(Colouring& drawing, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush butter, Brush::Load(studio.brushes, "tanda/acrylic-05-paint"));
  butter.Radius(7.0f);
  Chance chance(studio.seed, kHighlight);
  const glm::vec3 halfway = glm::normalize(kKeyLight + glm::vec3(0, 0, 1));
  std::vector<Stroke> strokes;
  for (int i = 0; i < 16; ++i) {
    const glm::vec3 normal = glm::normalize(halfway + chance.Bell3(0.05f));
    const Flow flow = AroundAxis(kKeyLight + chance.Bell3(0.2f));
    const Stroke path = TraceStroke(flow, PlaceOf(normal), chance.Uniform(30.0f, 56.0f));
    const auto pieces = Press(path, [](glm::vec2) { return 0.9f; });
    strokes.insert(strokes.end(), pieces.begin(), pieces.end());
  }
  drawing.Draw(butter, {{1.0f, 0.985f, 0.90f}}, strokes,
               {.media = {.bite = 0.4f, .softness = 0.3f, .density = 1.1f}, .crumble = 0.5f});
  return Ok();
}

}  // namespace

Expected<Picture> PaintPastel(const Studio& studio) {
  const Plan& plan = PlanFor(studio.light);
  Colouring drawing(PrepareGround({studio.size}, kPaper, studio.seed));
  SCUMBLE_RETURN_IF_ERROR(Work(drawing, plan, studio));
  if (studio.light == Light::kKey) SCUMBLE_RETURN_IF_ERROR(LayHighlight(drawing, studio));
  return ToPicture(drawing.picture());
}

Expected<Picture> PastelPaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
