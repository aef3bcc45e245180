#include "exemplars/paint/engine/glaze.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "exemplars/paint/engine/media.h"

namespace scumble::paint {
namespace {

std::vector<Stroke> PlanGlaze(const Glaze& glaze, const GlazePlan& plan, Chance& chance, std::uint64_t stream) {
  std::vector<Stroke> strokes;
  const Touch touch = [&](glm::vec2 at) {
    const float border = glaze.below + glaze.ragged * 2.0f * (CloudNoise(at / glaze.lobes, 3, stream) - 0.5f);
    return plan.value(at) < border ? 1.0f : 0.0f;
  };
  // A stroke covers about `length` in its direction, so the middles are spaced wider than the strokes.
  const float length = glaze.length * glaze.radius;
  for (const glm::vec2 middle : SowEvenly(chance, std::sqrt(glaze.spacing * length))) {
    const Flow flow = plan.flow(chance);
    const Stroke line = TraceStroke(flow, middle, chance.Uniform(0.8f, 1.8f) * length);
    for (const Stroke& piece : Press(line, touch, chance.Uniform(0.42f, 0.62f), 0.2f)) {
      // A stroke shorter than wide would dry as a dot.
      if (glm::distance(piece.front().at, piece.back().at) > glaze.shortest * glaze.radius) strokes.push_back(piece);
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

std::function<Flow(Chance&)> SwayingRound(glm::vec3 axis, float deviation) {
  return [=](Chance& chance) { return AroundAxis(axis + chance.Bell3(deviation)); };
}

void LayGlaze(Colors& picture, Brush& brush, const Field& tooth, const Glaze& glaze, const GlazePlan& plan,
              std::uint64_t seed, std::uint64_t pass) {
  const std::uint64_t stream = Hash(seed, pass);
  Chance chance(seed, pass);
  Canvas wet(picture.sheet);
  brush.Radius(glaze.radius);
  brush.Paint(wet, PlanGlaze(glaze, plan, chance, stream));
  Dry(picture, wet.Read(), tooth, glaze, stream);
}

}  // namespace scumble::paint
