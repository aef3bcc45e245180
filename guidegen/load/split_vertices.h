// Vertices whose corners want different values, such as two normals or two tangents at one place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "guidegen/scene.h"

namespace scumble {

inline constexpr std::uint32_t kNoValue = ~0u;

struct CornerSplit {
  std::vector<std::uint32_t> sources;  // of each vertex: the one that it was
  std::vector<std::uint32_t> values;   // of each vertex: the value of its corners; kNoValue where it has no corner
};

// `of_corners` has the number of a value for each corner of the mesh's triangles. A vertex whose corners have several
// is split: the first keeps its number, further ones are appended. All lists of the mesh follow; normals and tangents,
// too, if they are there.
CornerSplit SplitByCorners(std::span<const glm::uvec3> of_corners, Mesh& mesh);

// Repeats the values of vertices that were split, `stride` each. Empty lists stay empty.
template <class T>
void Split(std::span<const std::uint32_t> sources, std::vector<T>& values, std::size_t stride = 1) {
  if (values.empty()) return;
  const std::size_t before = values.size() / stride;
  values.reserve(sources.size() * stride);
  for (std::size_t i = before; i < sources.size(); ++i) {
    for (std::size_t k = 0; k < stride; ++k) values.push_back(T(values[sources[i] * stride + k]));
  }
}

}  // namespace scumble
