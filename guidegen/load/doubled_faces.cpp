#include "guidegen/load/doubled_faces.h"

#include <algorithm>
#include <unordered_map>

#include "core/image/hash.h"

namespace scumble {
namespace {

// The triangles of a face, by their numbers.
struct FaceRange {
  std::size_t first = 0, count = 0;
};

std::vector<std::uint32_t> PlacesOf(std::span<const glm::uvec3> triangles, FaceRange face) {
  std::vector<std::uint32_t> places;
  for (const glm::uvec3& t : triangles.subspan(face.first, face.count)) places.insert(places.end(), {t.x, t.y, t.z});
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

glm::vec3 AreaOf(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, FaceRange face) {
  glm::vec3 area(0.0f);
  for (const glm::uvec3& t : triangles.subspan(face.first, face.count)) {
    area += glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x]);
  }
  return area;
}

}  // namespace

std::vector<DoubledFace> FindDoubledFaces(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                                          std::span<const std::uint32_t> faces) {
  std::vector<FaceRange> ranges;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (faces[t] >= ranges.size()) ranges.resize(std::size_t(faces[t]) + 1);
    FaceRange& range = ranges[faces[t]];
    if (range.count++ == 0) range.first = t;
  }
  std::vector<DoubledFace> doubled(ranges.size());
  std::unordered_map<std::uint64_t, std::size_t> firsts;
  bool any = false;
  for (std::size_t f = 0; f < ranges.size(); ++f) {
    doubled[f].under = f;
    if (ranges[f].count == 0) continue;
    const std::vector<std::uint32_t> places = PlacesOf(triangles, ranges[f]);
    const auto [first, is_new] = firsts.try_emplace(HashBytes(std::span(places)), f);
    if (is_new || PlacesOf(triangles, ranges[first->second]) != places) continue;
    const glm::vec3 area = AreaOf(positions, triangles, ranges[f]);
    doubled[f] = {first->second, glm::dot(area, AreaOf(positions, triangles, ranges[first->second])) < 0.0f};
    any = true;
  }
  return any ? doubled : std::vector<DoubledFace>();
}

}  // namespace scumble
