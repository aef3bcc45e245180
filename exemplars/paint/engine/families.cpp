#include "exemplars/paint/engine/families.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/image/hash.h"
#include "exemplars/paint/sphere.h"

namespace scumble::paint {
namespace {

constexpr float kPointStep = 4.0f;  // units between the points of a line
constexpr float kBend = 150.0f;     // units over which neighbours bend together
constexpr float kOverRim = 1.02f;   // lines that swell have faded out at this many radii

// The visible arc of a circle of latitude, from rim to rim or all round, and straight on past the rim.
std::vector<glm::vec2> VisibleArc(glm::vec3 axis, float latitude, float overhang) {
  // On a circle of latitude, the place that is nearest to the viewer is in the plane of axis and view.
  const glm::vec3 view(0, 0, 1);
  glm::vec3 nearest = view - axis * glm::dot(view, axis);
  nearest = glm::length(nearest) > 1e-3f ? glm::normalize(nearest) : glm::vec3(1, 0, 0);
  const glm::vec3 aside = glm::cross(axis, nearest);
  const float sine = std::sin(latitude);
  const float cosine = std::cos(latitude);
  const auto at = [&](float angle) {
    return axis * cosine + (nearest * std::cos(angle) + aside * std::sin(angle)) * sine;
  };
  if (at(0.0f).z <= 0.0f) return {};
  const float turn = kPointStep / (kRadius * sine);
  const auto walk = [&](float sign) {
    std::vector<glm::vec2> part;
    float angle = 0.0f;
    for (; angle < std::numbers::pi_v<float>; angle += turn) {
      const glm::vec3 normal = at(sign * angle);
      if (normal.z < 0.0f) break;
      part.push_back(PlaceOf(normal));
    }
    if (angle < std::numbers::pi_v<float> && part.size() >= 2) {
      const glm::vec2 last = part.back();
      // Near the rim steps shorten, so the heading is that of the last few.
      const glm::vec2 before = part[part.size() - std::min<std::size_t>(part.size(), 4)];
      const glm::vec2 heading = (last - before) / std::max(glm::distance(last, before), 1e-4f);
      for (float way = kPointStep; way <= overhang; way += kPointStep) part.push_back(last + heading * way);
    }
    return part;
  };
  std::vector<glm::vec2> line = walk(-1.0f);
  std::reverse(line.begin(), line.end());
  const std::vector<glm::vec2> onward = walk(1.0f);
  line.insert(line.end(), onward.begin() + (onward.empty() ? 0 : 1), onward.end());
  return line;
}

// The distance of a family's neighbours in the picture, as a share of their distance on the sphere: 1 where the surface
// faces the viewer or falls away along the lines, 0 where it falls away across them.
float Openness(glm::vec3 axis, glm::vec2 at) {
  const glm::vec3 normal = NormalAt(at);
  const float depth = std::max(normal.z, 0.02f);
  const glm::vec2 slope = glm::vec2(axis) - glm::vec2(normal) * (axis.z / depth);
  const float height = glm::dot(axis, normal);
  const float sine = std::sqrt(std::max(1.0f - height * height, 0.0f));
  return std::min(1.0f, sine / std::max(glm::length(slope), 1e-4f));
}

// Where lines would crowd, only every second continues, then every fourth and so on, and lower pressure corrects the
// remaining crowding: the tone stays about the same. Just before the rim, where lines of latitude turn along it, all of
// them end.
float ShareOfPressure(int line, float openness) {
  constexpr float kTurning = 0.22f;
  if (openness < kTurning) return 0.0f;
  int every = 1;
  float room = openness;
  for (; room < 0.75f; room *= 2.0f) every *= 2;
  return line % every == 0 ? std::sqrt(std::min(room, 1.0f)) : 0.0f;
}

// Cuts a line into strokes of the hand and presses them.
void BreakUp(Chance& chance, const std::vector<glm::vec2>& line, const Touch& touch, const FamilyOptions& options,
             std::vector<Stroke>& strokes) {
  const auto points = [](float units) { return static_cast<int>(std::lround(units / kPointStep)); };
  const int count = static_cast<int>(line.size());
  // The first stroke begins somewhere before the line, so that no seam runs along the rim.
  int begin = -points(chance.Uniform(0.0f, options.length_max));
  while (begin < count) {
    const int length = std::max(8, points(chance.Uniform(options.length_min, options.length_max)));
    const float gain = 1.0f + chance.Bell(options.pressure);
    const float from = chance.Bell(options.drift);
    const float to = chance.Bell(options.drift);
    Stroke stroke;
    for (int i = std::max(begin, 0); i < std::min(begin + length, count); ++i) {
      const glm::vec2 before = line[static_cast<std::size_t>(std::max(i - 1, 0))];
      const glm::vec2 after = line[static_cast<std::size_t>(std::min(i + 1, count - 1))];
      const glm::vec2 along = (after - before) / std::max(glm::distance(after, before), 1e-4f);
      const float shift = glm::mix(from, to, static_cast<float>(i - begin) / static_cast<float>(length));
      stroke.push_back({line[static_cast<std::size_t>(i)] + glm::vec2(-along.y, along.x) * shift, 1.0f});
    }
    if (chance.Happens(0.5f)) std::reverse(stroke.begin(), stroke.end());
    const auto pieces = Press(stroke, touch, gain, options.taper);
    strokes.insert(strokes.end(), pieces.begin(), pieces.end());
    begin += std::max(4, length - points(options.overlap + chance.Bell(0.4f * std::fabs(options.overlap))));
  }
}

}  // namespace

std::vector<Stroke> PlanFamily(Chance& chance, glm::vec3 axis, const Touch& touch, const FamilyOptions& options) {
  const glm::vec3 unit = glm::normalize(axis);
  const auto bend = static_cast<std::uint64_t>(chance.Whole(0, 1 << 30));
  std::vector<Stroke> strokes;
  const float step = options.spacing / kRadius;
  float latitude = step * chance.Uniform(0.3f, 0.7f);
  for (int number = 0; latitude < std::numbers::pi_v<float>;
       ++number, latitude += step * std::max(0.4f, 1.0f + chance.Bell(options.unevenness))) {
    if (std::min(latitude, std::numbers::pi_v<float> - latitude) < options.cap) continue;
    std::vector<glm::vec2> line = VisibleArc(unit, latitude, options.overhang);
    for (glm::vec2& at : line) {
      const glm::vec2 place = at / kBend;
      at += 2.0f * options.wander * (glm::vec2(SmoothNoise(place, bend), SmoothNoise(place, bend + 1)) - 0.5f);
    }
    // Neighbours do not all end at one place.
    const float patience = 1.0f + chance.Bell(0.12f);
    const Touch uncrowded = [&](glm::vec2 at) {
      return ShareOfPressure(number, patience * Openness(unit, at)) * touch(at);
    };
    BreakUp(chance, line, uncrowded, options, strokes);
  }
  return strokes;
}

std::vector<Stroke> PlanSwelling(std::uint64_t seed, std::uint64_t stream, const Touch& darkness,
                                 const Swelling& swelling, const SwellingHand& hand) {
  Chance chance(seed, stream);
  const std::uint64_t ragged = Hash(seed, stream, 1);
  const Touch touch = [&](glm::vec2 at) {
    const float dark = darkness(at) + hand.ragged * (CloudNoise(at / hand.cloud, 2, ragged) - 0.5f);
    if (dark < swelling.begins) return 0.0f;
    const float pressure = glm::mix(swelling.lightest, swelling.heaviest, Ramp(swelling.begins, swelling.full, dark));
    return pressure * Ramp(kOverRim, kOverRim - 0.02f, RimDistance(at));
  };
  FamilyOptions family = hand.family;
  family.spacing = swelling.spacing;
  return PlanFamily(chance, swelling.axis, touch, family);
}

std::vector<Stroke> PlanDots(Chance& chance, const Flow& flow, const Touch& density, const DotOptions& options) {
  std::vector<Stroke> dots;
  for (const glm::vec2 at : SowEvenly(chance, options.spacing)) {
    const bool wanted = chance.Happens(density(at));
    const float length = chance.Uniform(options.length_min, options.length_max);
    const float pressure = chance.Uniform(options.pressure_min, options.pressure_max);
    if (!wanted) continue;
    const glm::vec2 heading = flow(at);
    const glm::vec2 reach = heading * (0.5f * length / std::max(glm::length(heading), 1e-3f));
    dots.push_back({{at - reach, 0.6f * pressure}, {at, pressure}, {at + reach, 0.3f * pressure}});
  }
  return dots;
}

}  // namespace scumble::paint
