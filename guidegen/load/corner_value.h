// What a corner of a face has by itself.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "core/image/hash.h"

namespace scumble {

struct CornerValue {
  glm::vec2 uv{0.0f};
  glm::vec4 color{1.0f};
  bool operator==(const CornerValue&) const = default;
};

// Of all bits of the floats: most values lie between 0 and 1. Values that are equal have one hash, 0 and -0 too.
struct CornerValueHash {
  std::size_t operator()(const CornerValue& v) const {
    return Hash(Bits(v.uv.x), Bits(v.uv.y), Bits(v.color.r), Bits(v.color.g), Bits(v.color.b), Bits(v.color.a));
  }
  static std::uint32_t Bits(float value) { return value == 0.0f ? 0 : std::bit_cast<std::uint32_t>(value); }
};

}  // namespace scumble
