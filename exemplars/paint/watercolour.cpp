// Watercolour: glazes from light to dark. Each glaze is a sparse scatter of wet strokes; as they dry, pigment gathers
// at their edges and in the paper's hollows, and light passes through every layer to the paper and back.
#include <algorithm>
#include <array>
#include <cmath>

#include "exemplars/paint/brush.h"
#include "exemplars/paint/media.h"
#include "exemplars/paint/paper.h"
#include "exemplars/paint/sphere.h"
#include "exemplars/paint/strokes.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kColdPress, 6.5f, {0.985f, 0.975f, 0.95f}, 0.035f};

constexpr std::uint64_t kFirstGlaze = kFirstStream;

struct Glaze {
  glm::vec3 pigment;  // what one full layer lets through
  glm::vec3 drift;    // the pigment it runs into
  float below;        // painted where the value is below this
  float ragged;       // how far chance moves that border
  float spacing;      // of the strokes: below their width they flow together into a wash
  float radius;
  float density;
  float edge;     // gathering at the edges
  float wetness;  // share of the edges that bleed away
};
// Washes that flow together alternate with strokes that stay apart.
constexpr std::array<Glaze, 11> kGlazes{{
    {{0.99f, 0.95f, 0.82f}, {1.00f, 0.90f, 0.80f}, 0.98f, 0.05f, 7.0f, 12.0f, 0.80f, 0.5f, 0.8f},
    {{0.98f, 0.87f, 0.66f}, {0.97f, 0.82f, 0.70f}, 0.91f, 0.14f, 20.0f, 10.0f, 0.40f, 0.7f, 0.6f},
    {{0.74f, 0.90f, 0.86f}, {0.84f, 0.90f, 0.74f}, 0.82f, 0.14f, 7.0f, 12.0f, 0.50f, 0.7f, 0.7f},
    {{0.62f, 0.85f, 0.86f}, {0.70f, 0.84f, 0.80f}, 0.75f, 0.16f, 19.0f, 9.0f, 0.40f, 0.8f, 0.5f},
    {{0.52f, 0.80f, 0.86f}, {0.56f, 0.82f, 0.78f}, 0.64f, 0.15f, 7.0f, 12.0f, 0.50f, 0.7f, 0.6f},
    {{0.52f, 0.72f, 0.86f}, {0.58f, 0.70f, 0.86f}, 0.56f, 0.15f, 17.0f, 9.0f, 0.42f, 0.8f, 0.5f},
    {{0.46f, 0.62f, 0.84f}, {0.44f, 0.70f, 0.82f}, 0.45f, 0.13f, 7.0f, 11.0f, 0.52f, 0.6f, 0.6f},
    {{0.52f, 0.56f, 0.82f}, {0.58f, 0.54f, 0.80f}, 0.36f, 0.11f, 15.0f, 9.0f, 0.40f, 0.7f, 0.5f},
    {{0.50f, 0.48f, 0.76f}, {0.42f, 0.54f, 0.78f}, 0.26f, 0.09f, 7.0f, 10.0f, 0.55f, 0.6f, 0.7f},
    {{0.56f, 0.44f, 0.70f}, {0.64f, 0.44f, 0.66f}, 0.17f, 0.06f, 12.0f, 9.0f, 0.50f, 0.6f, 0.6f},
    {{0.50f, 0.44f, 0.68f}, {0.50f, 0.44f, 0.68f}, 0.10f, 0.04f, 12.0f, 9.0f, 0.50f, 0.6f, 0.6f},
}};

std::vector<Stroke> PlanGlaze(const Glaze& glaze, Chance& chance, std::uint64_t stream) {
  std::vector<Stroke> strokes;
  const Touch touch = [&](glm::vec2 at) {
    const float border = glaze.below + glaze.ragged * 2.0f * (CloudNoise(at / 70.0f, 3, stream) - 0.5f);
    return ShadingAt(at).value < border ? 1.0f : 0.0f;
  };
  // A stroke covers about `length` along its way, so the middles are sown wider than the strokes lie apart.
  const float length = 8.0f * glaze.radius;
  for (const glm::vec2 middle : SowEvenly(chance, std::sqrt(glaze.spacing * length))) {
    const Flow flow = AroundAxis(glm::vec3(-0.62f, 0.66f, 0.42f) + chance.Bell3(0.15f));
    const Stroke line = TraceStroke(flow, middle, chance.Uniform(0.8f, 1.8f) * length);
    for (const Stroke& piece : Press(line, touch, chance.Uniform(0.42f, 0.62f), 0.2f)) {
      // Shorter than wide it would dry as a dot.
      if (glm::distance(piece.front().at, piece.back().at) > 2.6f * glaze.radius) strokes.push_back(piece);
    }
  }
  return strokes;
}

// Lets a painted layer dry: strokes become pigment.
void Dry(Colors& picture, const Layer& layer, const Field& tooth, const Glaze& glaze, std::uint64_t stream) {
  const Field wet = Plane(layer, 3);
  const Field crisp = Blur(wet, 1.0f);
  const Field bled = Blur(wet, 7.0f);
  const Field inner = Blur(wet, 3.0f);
  for (int y = 0; y < picture.size; ++y) {
    for (int x = 0; x < picture.size; ++x) {
      const std::size_t i = std::size_t(y) * picture.size + x;
      if (bled.pixels[i] < 0.004f) continue;
      const glm::vec2 at = picture.Place(x, y);
      const float bleeding = glaze.wetness * Ramp(0.40f, 0.62f, CloudNoise(at / 90.0f, 3, Hash(stream, 1)));
      const float wobble = 0.20f * (CloudNoise(at / 16.0f, 3, Hash(stream, 2)) - 0.5f);
      const float amount = glm::mix(crisp.pixels[i], bled.pixels[i], bleeding) + wobble * (1.0f - bleeding);
      const float cover = Ramp(glm::mix(0.34f, 0.0f, bleeding), glm::mix(0.50f, 1.0f, bleeding), amount);
      if (cover <= 0.0f) continue;
      const float gathered =
          glaze.edge * std::pow(1.0f - glm::clamp(inner.pixels[i], 0.0f, 1.0f), 1.4f) * (1.0f - bleeding) * 1.6f;
      const float pool = 0.55f + 0.9f * CloudNoise(at / 60.0f, 4, Hash(stream, 3));
      const float grain = 1.0f + 0.32f * (0.5f - tooth.pixels[i]);
      const float density = glaze.density * cover * (pool * grain + gathered);
      const float run = glm::clamp(1.8f * CloudNoise(at / 80.0f, 3, Hash(stream, 4)) - 0.4f, 0.0f, 1.0f);
      picture.pixels[i] *= glm::pow(glm::mix(glaze.pigment, glaze.drift, run), glm::vec3(density));
    }
  }
}

}  // namespace

Expected<Picture> PaintWatercolour(const Studio& studio) {
  SCUMBLE_ASSIGN(Brush brush, Brush::Load(studio.brushes, "deevad/brush"));
  brush.Color(glm::vec3(0.2f));
  auto [tooth, picture] = PrepareGround({studio.size}, kPaper, studio.seed);
  std::uint64_t pass = kFirstGlaze;
  for (const Glaze& glaze : kGlazes) {
    const std::uint64_t stream = Hash(studio.seed, pass);
    Chance chance(studio.seed, pass++);
    Canvas wet({studio.size});
    brush.Radius(glaze.radius);
    brush.Paint(wet, PlanGlaze(glaze, chance, stream));
    Dry(picture, wet.Read(), tooth, glaze, stream);
  }
  return ToPicture(picture);
}

Expected<Picture> WatercolourPaper(const Studio& studio) {
  return PaperTile(studio, kPaper);
}

}  // namespace scumble::paint
