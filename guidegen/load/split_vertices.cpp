#include "guidegen/load/split_vertices.h"

#include <numeric>
#include <unordered_map>

#include "core/image/check.h"

namespace scumble {

CornerSplit SplitByCorners(std::span<const glm::uvec3> of_corners, Mesh& mesh) {
  SCUMBLE_CHECK_EQ(of_corners.size(), mesh.triangles.size());
  const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
  CornerSplit split;
  split.sources.resize(vertices);
  std::iota(split.sources.begin(), split.sources.end(), 0u);
  split.values.assign(vertices, kNoValue);
  std::unordered_map<std::uint64_t, std::uint32_t> others;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t vertex = mesh.triangles[t][i], value = of_corners[t][i];
      if (split.values[vertex] == kNoValue) split.values[vertex] = value;
      if (split.values[vertex] == value) continue;
      const auto [known, is_new] =
          others.try_emplace(std::uint64_t(vertex) << 32 | value, static_cast<std::uint32_t>(split.sources.size()));
      if (is_new) {
        split.sources.push_back(vertex);
        split.values.push_back(value);
      }
      mesh.triangles[t][i] = known->second;
    }
  }
  Split(split.sources, mesh.positions);
  Split(split.sources, mesh.normals);
  Split(split.sources, mesh.uvs[0]);
  Split(split.sources, mesh.uvs[1]);
  Split(split.sources, mesh.tangents);
  Split(split.sources, mesh.colors);
  Split(split.sources, mesh.rest_positions);
  return split;
}

}  // namespace scumble
