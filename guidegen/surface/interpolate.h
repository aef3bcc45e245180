// Values of a mesh's corners within its triangles, and its textures.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "guidegen/surface/surface.h"

namespace scumble {

template <class T>
auto Interpolate(const std::vector<T>& values, const glm::uvec3& triangle, const glm::dvec2& barycentric) {
  const T a = values[triangle.x];
  const T b = values[triangle.y];
  const T c = values[triangle.z];
  const float v = float(barycentric.x);
  const float w = float(barycentric.y);
  return a * (1.0f - v - w) + b * v + c * w;
}

// Null where the use names no texture or the mesh lacks its UV set.
inline const Picture* FindTexture(const PlacedObject& object, const TextureUse& use) {
  if (use.texture < 0 || std::size_t(use.texture) >= object.textures.size() || !object.mesh) return nullptr;
  if (object.mesh->uvs[use.uv_set].empty()) return nullptr;
  return &object.textures[use.texture];
}

}  // namespace scumble
