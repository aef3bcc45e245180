#include "exemplars/paint/engine/media.h"

#include <algorithm>
#include <cmath>

#include "exemplars/paint/engine/chance.h"

namespace scumble::paint {
namespace {

// Box blur of width 2 · reach + 1 along one axis; `stride` steps along the line, `next` from line to line.
void BoxBlur(const Field& from, Field& to, int reach, std::size_t stride, std::size_t next) {
  const int size = from.size;
  const double scale = 1.0 / (2 * reach + 1);
  for (int line = 0; line < size; ++line) {
    const std::size_t start = static_cast<std::size_t>(line) * next;
    const auto at = [&](int i) { return start + static_cast<std::size_t>(std::clamp(i, 0, size - 1)) * stride; };
    double sum = 0.0;
    for (int i = -reach; i <= reach; ++i) sum += from.pixels[at(i)];
    for (int i = 0; i < size; ++i) {
      to.pixels[at(i)] = static_cast<float>(sum * scale);
      sum += from.pixels[at(i + reach + 1)] - from.pixels[at(i - reach)];
    }
  }
}

}  // namespace

void RubInto(Colors& ground, const Layer& layer, const Field& tooth, const DryMedia& media) {
  for (std::size_t i = 0; i < ground.pixels.size(); ++i) {
    const glm::vec4 paint = layer.pixels[i];
    if (paint.w <= 0.0f) continue;
    const float hollow = (1.0f - tooth.pixels[i]) * media.bite;
    const float caught = Ramp(hollow - media.softness, hollow + media.softness, paint.w);
    const float cover =
        glm::clamp(media.density * glm::mix(paint.w, caught, media.bite) * std::sqrt(paint.w), 0.0f, 1.0f);
    ground.pixels[i] = glm::mix(ground.pixels[i], media.stick.value_or(glm::vec3(paint) / paint.w), cover);
  }
}

void LightRelief(Colors& paint, const Field& height, const Relief& relief) {
  const Colors flat = paint;
  for (int y = 0; y < paint.size; ++y) {
    for (int x = 0; x < paint.size; ++x) {
      const float across =
          height.Near(x + 1, y) - height.Near(x - 1, y) + 0.5f * (height.Near(x + 2, y) - height.Near(x - 2, y));
      const float down =
          height.Near(x, y + 1) - height.Near(x, y - 1) + 0.5f * (height.Near(x, y + 2) - height.Near(x, y - 2));
      const float facing = 0.6f * across + 0.8f * down;
      const float shade = glm::clamp(1.0f + relief.shade * facing, 0.62f, 1.4f);
      const float sheen = relief.sheen * std::pow(glm::clamp(0.5f + 0.9f * facing, 0.0f, 1.0f), 6.0f);
      paint.At(x, y) = flat.At(x, y) * shade + sheen;
    }
  }
}

Field Blur(const Field& field, float radius) {
  const int reach = std::max(1, static_cast<int>(std::lround(radius * static_cast<float>(field.size) / kSide)));
  const std::size_t size = static_cast<std::size_t>(field.size);
  Field a = field;
  Field b(field.sheet);
  for (int pass = 0; pass < 3; ++pass) {
    BoxBlur(a, b, reach, 1, size);
    BoxBlur(b, a, reach, size, 1);
  }
  return a;
}

Field Plane(const Layer& layer, int component) {
  Field plane(layer.sheet);
  for (std::size_t i = 0; i < plane.pixels.size(); ++i) plane.pixels[i] = layer.pixels[i][component];
  return plane;
}

}  // namespace scumble::paint
