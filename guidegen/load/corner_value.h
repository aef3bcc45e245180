// What a corner of a face has by itself; its vertex's value counts for what it lacks.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "core/image/hash.h"

namespace scumble {

struct CornerValue {
  std::optional<glm::vec2> uv;
  std::optional<glm::vec4> color;
  bool operator==(const CornerValue&) const = default;
};

// Of all bits of the floats: most values lie between 0 and 1. Values that are equal have one hash, 0 and -0 too.
struct CornerValueHash {
  std::size_t operator()(const CornerValue& v) const {
    const glm::vec2 uv = v.uv.value_or(glm::vec2(0.0f));
    const glm::vec4 c = v.color.value_or(glm::vec4(0.0f));
    return Hash(v.uv.has_value(), Bits(uv.x), Bits(uv.y), v.color.has_value(), Bits(c.r), Bits(c.g), Bits(c.b),
                Bits(c.a));
  }
  static std::uint32_t Bits(float value) { return value == 0.0f ? 0 : std::bit_cast<std::uint32_t>(value); }
};

}  // namespace scumble
