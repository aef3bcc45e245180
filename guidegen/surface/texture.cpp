#include "guidegen/surface/texture.h"

#include <algorithm>
#include <cmath>

#include "core/image/color.h"
#include "guidegen/surface/work_counters.h"

namespace scumble {
namespace {

// Reduces a coordinate so that its product with the picture's size fits an int.
double Fold(double coordinate, TextureWrap wrap) {
  if (!std::isfinite(coordinate)) return 0.0;
  switch (wrap) {
    case TextureWrap::kRepeat:
      return coordinate - std::floor(coordinate);
    case TextureWrap::kMirror:
      return coordinate - 2.0 * std::floor(coordinate / 2.0);
    case TextureWrap::kClamp:
      return std::clamp(coordinate, -1.0, 2.0);
  }
  return 0.0;
}

int WrapTexel(int texel, int size, TextureWrap wrap) {
  if (wrap == TextureWrap::kClamp) return std::clamp(texel, 0, size - 1);
  const int period = wrap == TextureWrap::kMirror ? 2 * size : size;
  const int folded = ((texel % period) + period) % period;
  return folded < size ? folded : period - 1 - folded;
}

template <class Texel>
glm::vec4 Sample(const Picture& picture, const TextureUse& use, glm::vec2 uv, const Texel& texel) {
  if (picture.empty()) return glm::vec4(1.0f);
  ++thread_counters.texture_lookups;
  thread_counters.texels += use.nearest ? 1 : 4;
  const glm::vec3 moved = use.uv_transform * glm::vec3(uv, 1.0f);
  double x = Fold(moved.x, use.wrap_u) * picture.width;
  double y = Fold(moved.y, use.wrap_v) * picture.height;
  const auto at = [&](int column, int row) {
    return texel(picture.At(WrapTexel(column, picture.width, use.wrap_u), WrapTexel(row, picture.height, use.wrap_v)));
  };
  if (use.nearest) return at(int(std::floor(x)), int(std::floor(y)));
  x -= 0.5;
  y -= 0.5;
  const int column = int(std::floor(x));
  const int row = int(std::floor(y));
  const float right = float(x - column);
  const float down = float(y - row);
  const glm::vec4 top = glm::mix(at(column, row), at(column + 1, row), right);
  const glm::vec4 bottom = glm::mix(at(column, row + 1), at(column + 1, row + 1), right);
  return glm::mix(top, bottom, down);
}

}  // namespace

glm::vec4 SampleColor(const Picture& picture, const TextureUse& use, glm::vec2 uv) {
  return Sample(picture, use, uv, [](const std::uint16_t* texel) {
    return glm::vec4(Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2]), texel[3] / 65535.0f);
  });
}

glm::vec4 SampleRaw(const Picture& picture, const TextureUse& use, glm::vec2 uv) {
  return Sample(picture, use, uv, [](const std::uint16_t* texel) {
    return glm::vec4(texel[0], texel[1], texel[2], texel[3]) / 65535.0f;
  });
}

}  // namespace scumble
