#include "exemplars/paint/engine/colouring.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "exemplars/paint/sphere.h"

namespace scumble::paint {
namespace {

constexpr float kSquint = 11.0f;  // radius of the blur
constexpr float kSteady = 8.0f;   // distance over which the hand's decisions are smoothed
constexpr float kCurl = 0.3f;     // radii: circles smaller than this are not drawn
constexpr float kPlan = 4.0f;     // units between the places of decisions

// The blurred picture, at the places of decisions.
Colors Squint(const Colors& picture, const Sheet& places) {
  Colors seen(places);
  const float to_pixels = static_cast<float>(picture.size) / static_cast<float>(places.pixels);
  for (int k = 0; k < 3; ++k) {
    Field plane(places);
    for (int y = 0; y < places.pixels; ++y) {
      for (int x = 0; x < places.pixels; ++x) {
        // The mean of the pixels there, of which there is at least one.
        const int left = static_cast<int>(static_cast<float>(x) * to_pixels);
        const int top = static_cast<int>(static_cast<float>(y) * to_pixels);
        const int side = std::max(1, static_cast<int>(to_pixels));
        float sum = 0.0f;
        for (int v = 0; v < side; ++v) {
          for (int u = 0; u < side; ++u) sum += picture.Near(left + u, top + v)[k];
        }
        plane.At(x, y) = sum / static_cast<float>(side * side);
      }
    }
    plane = Blur(plane, kSquint);
    for (std::size_t i = 0; i < plane.pixels.size(); ++i) seen.pixels[i][k] = plane.pixels[i];
  }
  return seen;
}

}  // namespace

TargetColors MakeTargetColors(const std::function<glm::vec3(glm::vec2 at)>& color_at) {
  TargetColors target_colors(Sheet{static_cast<int>(kSide / kPlan)});
  for (int y = 0; y < target_colors.size; ++y) {
    for (int x = 0; x < target_colors.size; ++x) target_colors.At(x, y) = color_at(target_colors.Place(x, y));
  }
  return target_colors;
}

Touch AwayFromPoles(const Touch& touch, glm::vec3 axis) {
  const glm::vec3 unit = glm::normalize(axis);
  return
      [=](glm::vec2 at) { return touch(at) * Ramp(kCurl, kCurl + 0.15f, glm::length(glm::cross(NormalAt(at), unit))); };
}

glm::vec3 ColorIn(const TargetColors& target_colors, glm::vec2 at) {
  return target_colors.Near(static_cast<int>(at.x / kPlan), static_cast<int>(at.y / kPlan));
}

std::vector<Stroke> Facets(Chance& chance, const std::vector<Stroke>& strokes, float width, int facets,
                           float shortest) {
  std::vector<Stroke> lines;
  for (const Stroke& stroke : strokes) {
    if (glm::distance(stroke.front().at, stroke.back().at) < shortest) continue;
    for (int k = 0; k < facets; ++k) {
      const float across = (static_cast<float>(k) + 0.5f) / static_cast<float>(facets) - 0.5f;
      const float offset = across * width + chance.Bell(0.08f * width);
      const float press = 1.0f + chance.Bell(0.25f);
      // Facets start and end one after another.
      const std::size_t begin = static_cast<std::size_t>(chance.Whole(0, 2));
      const std::size_t end = stroke.size() - static_cast<std::size_t>(chance.Whole(0, 3));
      Stroke line;
      for (std::size_t i = begin; i < end; ++i) {
        line.push_back({Beside(stroke, i, offset), glm::clamp(stroke[i].pressure * press, 0.0f, 1.0f)});
      }
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

Touch Colouring::Nearer(const TargetColors& target_colors, const Stick& stick, const Hand& hand) const {
  const Colors seen = Squint(picture_, target_colors.sheet);
  const auto plan = std::make_shared<Field>(target_colors.sheet);
  for (int y = 0; y < plan->size; ++y) {
    for (int x = 0; x < plan->size; ++x) {
      const glm::vec2 at = plan->Place(x, y);
      if (RimDistance(at) > hand.overhang + 0.02f) continue;
      const glm::vec3 now = seen.At(x, y);
      const glm::vec3 effect = (stick.clear ? now * stick.color : stick.color) - now;
      const float strength = glm::length(effect);
      if (strength < 1e-3f || glm::distance(stick.color, target_colors.At(x, y)) > hand.reach) continue;
      // The share of the stick at which the colour is nearest to the target.
      const float nearer = glm::dot(target_colors.At(x, y) - now, effect) / strength;
      if (nearer < hand.least) continue;
      plan->At(x, y) = glm::mix(hand.lightest, hand.heaviest, std::min(nearer / strength, 1.0f));
    }
  }
  // A hand does not follow every detail.
  *plan = Blur(*plan, kSteady);
  return [plan, overhang = hand.overhang](glm::vec2 at) {
    const float pressure = plan->Near(static_cast<int>(at.x / kPlan), static_cast<int>(at.y / kPlan));
    return pressure * Ramp(overhang, overhang - 0.03f, RimDistance(at));
  };
}

Field Colouring::Grain(float crumble) {
  Field grain = tooth_;
  const int size = grain.size;
  const auto slide = [&](std::uint64_t which) {
    return static_cast<int>(Hash(drawn_, which) % static_cast<std::uint64_t>(size));
  };
  const int right = slide(1);
  const int down = slide(2);
  ++drawn_;
  if (crumble <= 0.0f) return grain;
  // A mean of two such fields would be flatter than either.
  const float contrast = 1.0f / std::sqrt(crumble * crumble + (1.0f - crumble) * (1.0f - crumble));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      // Similar grain, from another place and mirrored.
      const float crumbs = tooth_.At((y + right) % size, (x + down) % size);
      const float height = glm::mix(tooth_.At(x, y), crumbs, crumble) - 0.5f;
      grain.At(x, y) = glm::clamp(0.5f + contrast * height, 0.0f, 1.0f);
    }
  }
  return grain;
}

void Colouring::Draw(Brush& brush, const Stick& stick, const std::vector<Stroke>& strokes, const Settling& settling) {
  if (strokes.empty()) return;
  Canvas canvas(picture_.sheet);
  brush.Color(stick.color);
  brush.Paint(canvas, strokes);
  Settle(canvas.Read(), stick, settling);
}

void Colouring::Settle(Layer layer, const Stick& stick, const Settling& settling) {
  for (glm::vec4& pixel : layer.pixels) pixel *= settling.load;
  const Field grain = Grain(settling.crumble);
  if (!stick.clear) {
    RubInto(picture_, layer, grain, settling.media);
    return;
  }
  // The amount of settled wax is its coverage of white paper.
  for (glm::vec4& pixel : layer.pixels) pixel = glm::vec4(0, 0, 0, pixel.w);
  Colors bare(picture_.sheet, glm::vec3(1.0f));
  RubInto(bare, layer, grain, settling.media);
  for (std::size_t i = 0; i < picture_.pixels.size(); ++i) {
    picture_.pixels[i] *= glm::mix(stick.color, glm::vec3(1.0f), bare.pixels[i].x);
  }
}

void Colouring::Rub(Brush& finger, const std::vector<Stroke>& strokes) {
  Canvas canvas(picture_.sheet);
  canvas.Put(picture_);
  finger.Paint(canvas, strokes);
  const Layer layer = canvas.Read();
  for (std::size_t i = 0; i < picture_.pixels.size(); ++i) picture_.pixels[i] = glm::vec3(layer.pixels[i]);
}

}  // namespace scumble::paint
