#include "exemplars/paint/engine/strokes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "exemplars/paint/sphere.h"

namespace scumble::paint {
namespace {

constexpr float kStrokeStep = 4.0f;           // units between the points of a stroke
constexpr float kLeastForeshortening = 0.3f;  // strokes never shrink below this share at the rim
constexpr std::size_t kShortest = 6;          // points: scraps between two lifts would read as blots
constexpr float kLift = 0.02f;                // pressures below it lift the tool

// The picture of a tangent vector: y points down there.
glm::vec2 Flatten(glm::vec3 tangent) {
  const glm::vec2 flat(tangent.x, -tangent.y);
  const float length = glm::length(flat);
  // Seen end-on, a tangent has no direction in the picture; the pole of a flow has none at all.
  if (length < 1e-4f) return {kLeastForeshortening, 0.0f};
  return length < kLeastForeshortening ? flat * (kLeastForeshortening / length) : flat;
}

glm::vec3 UnitOr(glm::vec3 v, glm::vec3 fallback) {
  const float length = glm::length(v);
  return length > 1e-4f ? v / length : fallback;
}

glm::vec2 Sideways(glm::vec2 direction) {
  const float length = std::max(glm::length(direction), 1e-6f);
  return glm::vec2(-direction.y, direction.x) / length;
}

}  // namespace

Flow AroundAxis(glm::vec3 axis) {
  const glm::vec3 unit = glm::normalize(axis);
  return [unit](glm::vec2 at) { return Flatten(UnitOr(glm::cross(unit, NormalAt(at)), {1, 0, 0})); };
}

Flow TowardsAxis(glm::vec3 axis) {
  const glm::vec3 unit = glm::normalize(axis);
  return [unit](glm::vec2 at) {
    const glm::vec3 normal = NormalAt(at);
    return Flatten(UnitOr(unit - normal * glm::dot(unit, normal), {1, 0, 0}));
  };
}

Stroke TraceStroke(const Flow& flow, glm::vec2 middle, float length, float offset) {
  const glm::vec2 start = middle + Sideways(flow(middle)) * offset;
  const int half = std::max(2, static_cast<int>(std::lround(length / (2.0f * kStrokeStep))));
  const auto walk = [&](float sign) {
    Stroke part;
    glm::vec2 at = start;
    glm::vec2 heading = flow(start) * sign;
    for (int i = 0; i < half; ++i) {
      glm::vec2 next = flow(at);
      // A flow may turn round at its pole; the hand does not.
      if (glm::dot(next, heading) < 0.0f) next = -next;
      heading = next;
      at += heading * kStrokeStep;
      part.push_back({at, 1.0f});
    }
    return part;
  };
  Stroke stroke = walk(-1.0f);
  std::reverse(stroke.begin(), stroke.end());
  stroke.push_back({start, 1.0f});
  const Stroke onward = walk(1.0f);
  stroke.insert(stroke.end(), onward.begin(), onward.end());
  return stroke;
}

glm::vec2 Beside(const Stroke& stroke, std::size_t i, float offset) {
  const glm::vec2 before = stroke[i > 0 ? i - 1 : 0].at;
  const glm::vec2 after = stroke[std::min(stroke.size() - 1, i + 1)].at;
  const glm::vec2 along = (after - before) / std::max(glm::distance(after, before), 1e-5f);
  return stroke[i].at + glm::vec2(-along.y, along.x) * offset;
}

std::vector<Stroke> Press(const Stroke& stroke, const Touch& touch, float gain, float taper) {
  std::vector<Stroke> pieces;
  Stroke piece;
  const auto finish = [&] {
    if (piece.size() >= kShortest) {
      for (std::size_t i = 0; i < piece.size(); ++i) {
        const float u = static_cast<float>(i) / static_cast<float>(piece.size() - 1);
        piece[i].pressure *= Ramp(-0.02f, taper, u) * Ramp(1.02f, 1.0f - taper, u);
      }
      pieces.push_back(piece);
    }
    piece.clear();
  };
  for (const StrokePoint& point : stroke) {
    const float pressure = point.pressure * touch(point.at) * gain;
    if (pressure < kLift) {
      finish();
    } else {
      piece.push_back({point.at, std::min(pressure, 1.0f)});
    }
  }
  finish();
  return pieces;
}

std::vector<Stroke> PlanHatching(Chance& chance, Flow (*flow_of)(glm::vec3), glm::vec3 axis, const Touch& touch,
                                 const HatchOptions& options) {
  std::vector<Stroke> strokes;
  for (int patch = 0; patch < options.patches; ++patch) {
    // Braces fix the order of the random numbers.
    const glm::vec2 centre{chance.Uniform(-20.0f, kSide + 20.0f), chance.Uniform(-20.0f, kSide + 20.0f)};
    const float weight = std::min(1.0f, 1.4f * touch(centre));
    if (RimDistance(centre) > 1.06f || !chance.Happens(weight)) continue;
    const Flow flow = flow_of(axis + chance.Bell3(options.sway));
    const glm::vec2 aside = Sideways(flow(centre));
    const float length = chance.Uniform(options.length_min, options.length_max);
    const int count = chance.Whole(options.strokes_min, options.strokes_max);
    const float gain = 1.0f + chance.Bell(0.5f * options.unevenness);
    const float slant = chance.Bell(0.35f);
    for (int i = 0; i < count; ++i) {
      const float across = (static_cast<float>(i) - 0.5f * static_cast<float>(count)) * options.spacing +
                           chance.Bell(options.unevenness * options.spacing);
      // The ends of a patch step along a slanting line, and none ends where its neighbour does.
      const float along = slant * across + chance.Bell(options.unevenness * 0.3f * length);
      const glm::vec2 middle = centre + aside * across + flow(centre) * along;
      const Stroke line = TraceStroke(flow, middle, length * (1.0f + chance.Bell(0.6f * options.unevenness)));
      const auto pieces = Press(line, touch, gain * (1.0f + chance.Bell(options.unevenness)));
      strokes.insert(strokes.end(), pieces.begin(), pieces.end());
    }
  }
  return strokes;
}

std::vector<glm::vec2> SowEvenly(Chance& chance, float spacing, float side, float margin) {
  std::vector<glm::vec2> places;
  for (float y = -margin; y < side + margin; y += spacing) {
    for (float x = -margin; x < side + margin; x += spacing) {
      const float dx = chance.Uniform(0.0f, spacing);
      places.emplace_back(x + dx, y + chance.Uniform(0.0f, spacing));
    }
  }
  for (std::size_t i = places.size(); i > 1; --i) {
    std::swap(places[i - 1], places[static_cast<std::size_t>(chance.Whole(0, static_cast<int>(i) - 1))]);
  }
  return places;
}

std::vector<Stroke> PlanRim(Chance& chance, const Touch& touch, const RimOptions& options) {
  std::vector<Stroke> strokes;
  for (int line = 0; line < options.lines; ++line) {
    const float begin = chance.Uniform(0.0f, 2.0f * std::numbers::pi_v<float>);
    const float length = chance.Uniform(options.length_min, options.length_max);
    const float inset = options.inset + chance.Bell(options.deviation);
    const float drift = chance.Bell(options.deviation);
    const int steps = std::max(4, static_cast<int>(length * kRadius / kStrokeStep));
    Stroke stroke;
    for (int i = 0; i <= steps; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(steps);
      const float angle = begin + length * u;
      const float radius = kRadius - inset - drift * (u - 0.5f) * 2.0f;
      stroke.push_back({glm::vec2(kRadius) + radius * glm::vec2(std::cos(angle), std::sin(angle)), 1.0f});
    }
    const auto pieces = Press(stroke, touch, 1.0f + chance.Bell(0.2f));
    strokes.insert(strokes.end(), pieces.begin(), pieces.end());
  }
  return strokes;
}

}  // namespace scumble::paint
