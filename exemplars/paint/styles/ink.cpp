// Pen and ink on white paper, three times the same sphere: swelling lines along the form, a second and a third family
// laid across them towards the shade, dots towards the light.
#include <span>

#include "exemplars/paint/engine/drawing.h"
#include "exemplars/paint/engine/families.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kFine, 3.0f, {0.985f, 0.98f, 0.965f}, 0.012f};
constexpr glm::vec3 kInk{0.085f, 0.06f, 0.055f};

enum Pass : std::uint64_t { kDots = kFirstStream, kContour, kFirstFamily };

// Directions of the families. The first runs round the highlight, so that it is nearly level on floors and upright on
// side walls. Poles stay in the light or on the rim.
constexpr glm::vec3 kFormLines{-0.36f, 0.46f, 0.81f};
constexpr glm::vec3 kCrossLines{0.63f, 0.77f, -0.05f};
constexpr glm::vec3 kUprightLines{-0.95f, 0.10f, 0.28f};
// In the shade there is no white in which rings could close: they do so below, where the hatching is densest.
constexpr glm::vec3 kUnderLines{-0.15f, -0.55f, 0.82f};
constexpr glm::vec3 kSlantLines{-0.60f, 0.79f, 0.12f};

constexpr Swelling kLit[] = {
    {kFormLines, 17.0f, 0.35f, 0.98f, 0.06f, 0.73f},
    {kCrossLines, 17.0f, 0.56f, 1.02f, 0.06f, 0.74f},
    {kUprightLines, 16.0f, 0.74f, 1.02f, 0.06f, 0.66f},
};
constexpr Swelling kHalf[] = {
    {kFormLines, 17.0f, 0.375f, 0.96f, 0.08f, 0.78f},
    {kCrossLines, 18.0f, 0.53f, 0.96f, 0.06f, 0.72f},
    {kUprightLines, 16.0f, 0.76f, 1.0f, 0.06f, 0.62f},
};
constexpr Swelling kShade[] = {
    {kUnderLines, 16.5f, 0.30f, 1.0f, 0.16f, 0.74f},
    {kSlantLines, 16.5f, 0.40f, 1.0f, 0.16f, 0.70f},
    {kUprightLines, 16.0f, 0.79f, 1.02f, 0.06f, 0.66f},
};

std::span<const Swelling> FamiliesFor(Light light) {
  switch (light) {
    case Light::kGrazing:
      return kHalf;
    case Light::kSky:
    case Light::kCrevice:
      return kShade;
    case Light::kKey:
      break;
  }
  return kLit;
}

Expected<Brush> Pen(const Studio& studio, float radius) {
  SCUMBLE_ASSIGN(Brush pen, Brush::Load(studio.brushes, "deevad/soft-dip-pen"));
  pen.Radius(radius).Color(kInk).Set(MYPAINT_BRUSH_SETTING_HARDNESS, 0.85f).Set(MYPAINT_BRUSH_SETTING_OPAQUE, 2.0f);
  return pen;
}

// Where the first family has run out, a little into it and not far beyond.
Status SetDots(Drawing& drawing, const Studio& studio, const Touch& darkness) {
  SCUMBLE_ASSIGN(Brush pen, Pen(studio, 1.7f));
  Chance chance(studio.seed, kDots);
  const float begins = FamiliesFor(studio.light).front().begins;
  const Touch density = [&](glm::vec2 at) {
    if (RimDistance(at) > 0.98f) return 0.0f;
    return Ramp(begins - 0.13f, begins, darkness(at)) * Ramp(begins + 0.06f, begins, darkness(at));
  };
  pen.Paint(drawing.canvas(), PlanDots(chance, AroundAxis(kFormLines), density, {.spacing = 13.0f}));
  return Ok();
}

// Right on the rim, so that nothing of it is carried into floors that are seen nearly edge-on: a fine line with gaps
// all round, and a heavy one over it on the shade's side.
Status DrawContour(Drawing& drawing, const Studio& studio, const Touch& darkness) {
  SCUMBLE_ASSIGN(Brush fine, Pen(studio, 1.7f));
  SCUMBLE_ASSIGN(Brush broad, Pen(studio, 2.4f));
  Chance chance(studio.seed, kContour);
  const std::uint64_t clouds = Hash(studio.seed, kContour, 1);
  const Touch searching = [&](glm::vec2 at) {
    const float cloud = CloudNoise(at / 130.0f, 2, clouds);
    return cloud < 0.27f ? 0.0f : 0.6f * Ramp(0.22f, 0.75f, cloud);
  };
  const Touch swelling = [&](glm::vec2 at) {
    const float dark = darkness(at);
    if (dark < 0.45f) return 0.0f;
    return 0.1f + 0.75f * Ramp(0.45f, 0.95f, dark) * (0.5f + CloudNoise(at / 60.0f, 2, clouds));
  };
  RimOptions rim{.lines = 12, .inset = 2.5f, .deviation = 1.4f, .length_min = 0.8f, .length_max = 1.9f};
  fine.Paint(drawing.canvas(), PlanRim(chance, searching, rim));
  rim.lines = 28;
  broad.Paint(drawing.canvas(), PlanRim(chance, swelling, rim));
  return Ok();
}

}  // namespace

Expected<Picture> PaintInk(const Studio& studio) {
  Drawing drawing(PrepareGround({studio.size}, kPaper, studio.seed),
                  {.bite = 0.06f, .softness = 0.40f, .density = 1.1f});
  SCUMBLE_ASSIGN(Brush pen, Pen(studio, 2.4f));
  const Touch darkness = [&](glm::vec2 at) { return DarknessAt(at, studio.light); };
  const SwellingHand hand{.family = {.unevenness = 0.13f,
                                     .length_min = 220.0f,
                                     .length_max = 560.0f,
                                     .overlap = 34.0f,
                                     .drift = 1.2f,
                                     .cap = 0.08f,
                                     .overhang = 0.0f}};
  std::uint64_t stream = kFirstFamily;
  for (const Swelling& family : FamiliesFor(studio.light)) {
    pen.Paint(drawing.canvas(), PlanSwelling(studio.seed, stream++, darkness, family, hand));
  }
  SCUMBLE_RETURN_IF_ERROR(SetDots(drawing, studio, darkness));
  SCUMBLE_RETURN_IF_ERROR(DrawContour(drawing, studio, darkness));
  return ToPicture(drawing.Look());
}

Expected<Picture> InkPaper(const Studio& studio) { return PaperTile(studio, kPaper); }

}  // namespace scumble::paint
