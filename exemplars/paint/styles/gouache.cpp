// Gouache: a poster in a few flat, opaque tones, four times the same sphere. One tone covers the sheet; the others are
// laid over it with a flat brush that stops at the tone's border: with most of its hair at once, or running dry across
// the paper's tooth.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "exemplars/paint/engine/flat_brush.h"
#include "exemplars/paint/engine/media.h"
#include "exemplars/paint/engine/paper.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kCard{Tooth::kColdPress, 5.5f, {0.93f, 0.885f, 0.80f}, 0.03f};

enum Pass : std::uint64_t { kFirstFlat = kFirstStream, kWobble = 40 };

// The shape of a tone.
enum class Shape {
  kAll,        // the whole sheet
  kAbove,      // where the value is above the border
  kBelow,      // where it is below
  kReflected,  // where reflected light is stronger than the border
  kHighlight,  // around the mirrored light, within the border in units of the normal
};

struct Flat {
  glm::vec3 color;
  Shape shape = Shape::kAll;
  float border = 0.0f;
  float wobble = 0.03f;  // deviation of a hand from the border, in its units
  glm::vec3 lean{0.0f};  // of the strokes' axis, away from the light
};

// Strokes of a tone go round an axis whose pole lies on the rim or in a tone that is painted over it: no circles close
// in sight.
// Cream, mustard and coral against petrol and teal.
constexpr std::array<Flat, 7> kLit{{
    {{0.905f, 0.440f, 0.325f}},
    {{0.940f, 0.720f, 0.330f}, Shape::kAbove, 0.61f, 0.040f, {-0.5f, -0.3f, -0.6f}},
    {{0.975f, 0.885f, 0.680f}, Shape::kAbove, 0.84f, 0.03f, {0.6f, 0.2f, -0.5f}},
    {{0.640f, 0.225f, 0.290f}, Shape::kBelow, 0.42f, 0.04f, {0.4f, 0.4f, 0.0f}},
    {{0.105f, 0.285f, 0.355f}, Shape::kBelow, 0.27f, 0.04f, {-0.3f, -0.4f, -0.5f}},
    {{0.165f, 0.500f, 0.510f}, Shape::kReflected, 0.50f, 0.06f, {0.3f, 0.2f, 0.1f}},
    {{1.000f, 0.975f, 0.900f}, Shape::kHighlight, 0.11f, 0.022f, {0.6f, 0.2f, -0.5f}},
}};
// Old rose between a dusty coral and plum, sage in the bounce. No lighter than the sunlit side where the two meet.
constexpr std::array<Flat, 7> kHalf{{
    {{0.560f, 0.270f, 0.345f}},
    {{0.690f, 0.350f, 0.360f}, Shape::kAbove, 0.35f, 0.025f, {-0.5f, 0.2f, -1.0f}},
    {{0.825f, 0.510f, 0.375f}, Shape::kAbove, 0.59f, 0.012f, {0.6f, 0.2f, -1.0f}},
    {{0.895f, 0.670f, 0.440f}, Shape::kAbove, 0.635f, 0.006f, {-0.5f, 0.4f, -1.0f}},
    {{0.385f, 0.190f, 0.320f}, Shape::kBelow, 0.27f, 0.03f, {0.4f, 0.5f, 0.0f}},
    {{0.120f, 0.290f, 0.355f}, Shape::kBelow, 0.16f, 0.03f, {-0.4f, -0.4f, -0.6f}},
    {{0.240f, 0.470f, 0.450f}, Shape::kReflected, 0.50f, 0.06f, {0.3f, 0.2f, 0.1f}},
}};
// The sky's teal over petrol, plum below.
constexpr std::array<Flat, 5> kShade{{
    {{0.110f, 0.315f, 0.380f}},
    {{0.150f, 0.425f, 0.450f}, Shape::kAbove, 0.178f, 0.009f, {0.6f, 0.2f, -0.5f}},
    {{0.270f, 0.560f, 0.550f}, Shape::kAbove, 0.255f, 0.012f, {-0.6f, -0.2f, -0.5f}},
    {{0.085f, 0.200f, 0.300f}, Shape::kBelow, 0.135f, 0.010f, {-0.4f, 0.3f, -0.3f}},
    {{0.365f, 0.215f, 0.340f}, Shape::kReflected, 0.60f, 0.07f, {0.3f, -0.3f, 0.1f}},
}};
// Aubergine, a last petrol from above, embers of the coral below.
constexpr std::array<Flat, 6> kDeep{{
    {{0.225f, 0.130f, 0.255f}},
    {{0.335f, 0.190f, 0.340f}, Shape::kAbove, 0.064f, 0.008f, {0.5f, 0.3f, 0.2f}},
    {{0.500f, 0.240f, 0.285f}, Shape::kAbove, 0.115f, 0.012f, {-0.4f, 0.4f, 0.2f}},
    {{0.660f, 0.360f, 0.310f}, Shape::kAbove, 0.135f, 0.006f, {0.4f, 0.4f, 0.2f}},
    {{0.145f, 0.100f, 0.205f}, Shape::kBelow, 0.046f, 0.003f, {0.4f, -0.4f, 0.2f}},
    {{0.095f, 0.190f, 0.260f}, Shape::kBelow, 0.028f, 0.002f, {-0.4f, 0.2f, 0.2f}},
}};

std::span<const Flat> FlatsOf(Light light) {
  switch (light) {
    case Light::kGrazing:
      return kHalf;
    case Light::kSky:
      return kShade;
    case Light::kCrevice:
      return kDeep;
    case Light::kKey:
      break;
  }
  return kLit;
}

// Distance from the mirrored light, in units of the normal; a slanting oval about it is equally far.
float FromHighlight(glm::vec3 normal) {
  const glm::vec3 away = normal - glm::normalize(kKeyLight + glm::vec3(0, 0, 1));
  return glm::length(glm::vec2(0.7f * (0.8f * away.x + 0.6f * away.y), 1.4f * (0.8f * away.y - 0.6f * away.x)));
}

// Lightness for a poster: in the light level surfaces are lighter than upright ones, so that floors and walls, which
// face one direction only, each stay well inside a tone.
float ValueAt(glm::vec2 at, Light light) {
  const float sky = light == Light::kKey || light == Light::kGrazing ? 0.06f : 0.0f;
  return ShadingAt(at, light).value + sky * NormalAt(at).y;
}

// How far inside the tone's shape a place lies, in units of its border.
float Inside(const Flat& flat, glm::vec2 at, Light light) {
  switch (flat.shape) {
    case Shape::kAbove:
      return ValueAt(at, light) - flat.border;
    case Shape::kBelow:
      return flat.border - ValueAt(at, light);
    case Shape::kReflected:
      return ShadingAt(at, light).reflected - flat.border;
    case Shape::kHighlight:
      return flat.border - FromHighlight(NormalAt(at));
    case Shape::kAll:
      break;
  }
  return 1.0f;
}

struct Brushes {
  FlatBrush full;  // loaded: covers, and lifts all at once
  FlatBrush dry;   // nearly empty: single hairs that catch on the paper
};

// What the full brush takes up; the highlight is set with a smaller one.
Load FullLoad(Chance& chance, const Flat& flat) {
  const bool small = flat.shape == Shape::kHighlight;
  Load load;
  load.color = flat.color * (1.0f + chance.Bell(0.012f));
  load.width = small ? chance.Uniform(12.0f, 18.0f) : chance.Uniform(34.0f, 52.0f);
  load.bristle = small ? 2.6f : 3.6f;
  load.ragged = small ? 4.0f : 20.0f;
  load.tremble = small ? 1.0f : 4.0f;
  load.streaks = 0.18f;
  load.height = 0.45f + chance.Bell(0.03f);
  load.ridge = 0.05f;
  return load;
}

// A look at what was missed: it would come again on every wall. In a small picture a bristle is finer than a pixel and
// covers none in full; there nothing can be told from a gap.
template <class MakeFlow>
void FillGaps(Canvas& colors, Canvas& heights, Brushes& brushes, Chance& chance, const Flat& flat, const Touch& inside,
              const MakeFlow& flow) {
  constexpr float kLeastPixelsPerUnit = 0.5f;
  if (colors.pixels_per_unit() < kLeastPixelsPerUnit) return;
  const bool small = flat.shape == Shape::kHighlight;
  const Touch held = [&](glm::vec2 at) { return inside(at) > 0.0f ? 1.0f : 0.0f; };
  const Layer seen = colors.Read();
  for (const glm::vec2 middle : SowEvenly(chance, 5.0f, kSide, 0.0f)) {
    const glm::vec2 pixel = glm::min(middle, kSide - 1.0f) * colors.pixels_per_unit();
    if (inside(middle) < 0.4f * flat.wobble || seen.At(static_cast<int>(pixel.x), static_cast<int>(pixel.y)).w > 0.9f)
      continue;
    Load load = FullLoad(chance, flat);
    load.width *= 0.6f;
    load.ragged *= 0.4f;
    const Stroke path = ShortPath(chance, middle, flow()(middle), small ? 24.0f : 70.0f);
    brushes.full.Drag(colors, &heights, chance, path, load, held);
  }
}

// Strokes that stop where the tone ends, then a few that are begun inside it and run dry beyond.
void LayFlat(Canvas& colors, Canvas& heights, Brushes& brushes, const Studio& studio, const Flat& flat,
             std::uint64_t pass) {
  Chance chance(studio.seed, kFirstFlat + pass);
  const std::uint64_t wobble = Hash(studio.seed, kWobble + pass);
  const Touch inside = [&](glm::vec2 at) {
    // Turned, so that the noise's grid draws no upright and level borders.
    const glm::vec2 turned(0.83f * at.x + 0.55f * at.y, 0.83f * at.y - 0.55f * at.x);
    return Inside(flat, at, studio.light) + 2.0f * flat.wobble * (CloudNoise(turned / 130.0f, 3, wobble) - 0.5f);
  };
  const Touch held = [&](glm::vec2 at) { return inside(at) > 0.0f ? 1.0f : 0.0f; };
  const auto flow = [&] { return AroundAxis(Towards(studio.light) + flat.lean + chance.Bell3(0.10f)); };
  const bool small = flat.shape == Shape::kHighlight;
  const float spacing = flat.shape == Shape::kAll ? 42.0f : small ? 12.0f : 33.0f;
  for (const glm::vec2 middle : SowEvenly(chance, spacing, kSide, 40.0f)) {
    if (inside(middle) < 0.0f) continue;
    const float length = small ? chance.Uniform(40.0f, 70.0f) : chance.Uniform(130.0f, 250.0f);
    Stroke path = TraceStroke(flow(), middle, length);
    if (chance.Happens(0.5f)) std::reverse(path.begin(), path.end());
    brushes.full.Drag(colors, &heights, chance, path, FullLoad(chance, flat), held);
  }
  if (flat.shape == Shape::kAll) return;
  FillGaps(colors, heights, brushes, chance, flat, inside, flow);
  if (small) return;

  for (const glm::vec2 middle : SowEvenly(chance, 27.0f, kSide, 40.0f)) {
    if (std::fabs(inside(middle)) > 0.5f * flat.wobble || chance.Happens(0.25f)) continue;
    Stroke path = TraceStroke(flow(), middle, chance.Uniform(90.0f, 190.0f));
    // Begun where the tone is, lifted beyond.
    if (inside(path.front().at) < inside(path.back().at)) std::reverse(path.begin(), path.end());
    Load load;
    load.color = flat.color;
    load.width = chance.Uniform(20.0f, 44.0f);
    load.bristle = chance.Uniform(1.8f, 2.6f);
    load.ragged = 70.0f;
    load.streaks = 0.3f;
    load.height = 0.47f;
    load.ridge = 0.03f;
    load.press = {0.5f, 0.05f};
    brushes.dry.Drag(colors, &heights, chance, path, load);
  }
}

}  // namespace

Expected<Picture> PaintGouache(const Studio& studio) {
  const Sheet sheet{studio.size};
  SCUMBLE_ASSIGN(FlatBrush full, FlatBrush::Cut(studio, "ramon/100%_Opaque"));
  SCUMBLE_ASSIGN(FlatBrush dry, FlatBrush::Cut(studio, "tanda/oil-01-paint"));
  Brushes brushes{std::move(full), std::move(dry)};
  const std::span<const Flat> flats = FlatsOf(studio.light);
  // The card is stained with the first tone: its bare colour would glare between the strokes.
  Stock stained = kCard;
  stained.color = 0.97f * flats[0].color;
  auto [tooth, picture] = PrepareGround(sheet, stained, studio.seed);
  Canvas heights(sheet);
  heights.Fill(glm::vec3(0.3f));
  std::uint64_t pass = 0;
  for (const Flat& flat : flats) {
    Canvas colors(sheet);
    LayFlat(colors, heights, brushes, studio, flat, pass++);
    RubInto(picture, colors.Read(), tooth, {.bite = 0.55f, .softness = 0.25f, .density = 1.15f});
  }
  LightRelief(picture, Plane(heights.Read(), 0), {.shade = 0.14f, .sheen = 0.0f});
  return ToPicture(picture);
}

Expected<Picture> GouacheGround(const Studio& studio) { return PaperTile(studio, kCard); }

}  // namespace scumble::paint
