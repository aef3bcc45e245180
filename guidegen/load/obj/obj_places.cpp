#include "guidegen/load/obj/obj_places.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "guidegen/load/loader_util.h"
#include "guidegen/load/mesh_normals.h"

namespace scumble {
namespace {

// If an object's middle lies within this distance of 0 or of a neighbour's origin, that origin is good enough: floats
// step by at most 1/256 there. So scenes in millimetres, 60 m of them, keep the file's one origin.
constexpr double kOneOrigin = 65536.0;

bool IsFar(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 away = glm::abs(a - b);
  return std::max({away.x, away.y, away.z}) > kOneOrigin;
}

// Origins that are far from each other, found by cells of that size.
struct NearOrigins {
  std::vector<glm::dvec3> origins;
  std::map<std::array<double, 3>, std::vector<std::size_t>> cells;

  // The index of the first origin that is near; otherwise the place becomes an origin.
  std::size_t Find(const glm::dvec3& place) {
    const glm::dvec3 cell = glm::floor(place / kOneOrigin);
    std::size_t first = origins.size();
    for (int i = 0; i < 27; ++i) {
      const auto found = cells.find({cell.x + i % 3 - 1, cell.y + i / 3 % 3 - 1, cell.z + i / 9 - 1});
      if (found == cells.end()) continue;
      for (const std::size_t origin : found->second) {
        if (!IsFar(place, origins[origin])) first = std::min(first, origin);
      }
    }
    if (first == origins.size()) {
      origins.push_back(place);
      cells[{cell.x, cell.y, cell.z}].push_back(first);
    }
    return first;
  }
};

std::size_t CountVertices(const ObjContents& contents) { return contents.attributes.vertices.size() / 3; }

glm::dvec3 PlaceOf(const ObjContents& contents, std::size_t vertex) {
  const double* v = contents.attributes.vertices.data() + 3 * vertex;
  return {v[0], v[1], v[2]};
}

// Gives a shape its own vertices, after all others.
void CopyVertices(std::size_t shape, ObjContents& contents) {
  tinyobj::mesh_t& mesh = contents.shapes[shape].mesh;
  const bool has_colors = contents.HasColors();
  const auto copy = [](std::vector<double>& values, std::size_t vertex) {
    for (std::size_t axis = 0; axis < 3; ++axis) values.push_back(double(values[3 * vertex + axis]));
  };
  std::vector<int> used;
  for (const tinyobj::index_t& index : mesh.indices) used.push_back(index.vertex_index);
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const std::size_t first = CountVertices(contents);
  for (const int vertex : used) {
    copy(contents.attributes.vertices, std::size_t(vertex));
    if (has_colors) copy(contents.attributes.colors, std::size_t(vertex));
  }
  for (tinyobj::index_t& index : mesh.indices) {
    const auto at = std::lower_bound(used.begin(), used.end(), index.vertex_index) - used.begin();
    index.vertex_index = static_cast<int>(first + std::size_t(at));
  }
}

// Text holds any number of digits: surveyors' files lie millions of metres from 0. If one origin is enough for the
// file, it has only one, because objects that touch must round their corners alike. Otherwise objects at 0 may stand
// beside a surveyor's, and each far shape has its own origin.
void ChooseOrigins(ObjContents& contents, ObjPlaces& places) {
  PlaceBox whole;
  for (const tinyobj::shape_t& shape : contents.shapes) {
    PlaceBox box;
    for (const tinyobj::index_t& index : shape.mesh.indices) {
      box.Add(PlaceOf(contents, std::size_t(index.vertex_index)));
    }
    places.origins.push_back(OriginOf(box));
    if (shape.mesh.indices.empty()) continue;
    whole.Add(box.low);
    whole.Add(box.high);
  }
  const glm::dvec3 common = OriginOf(whole);
  places.frames.push_back({0, common});
  // Ordered by place, so that their order in the file does not matter.
  std::map<std::array<double, 3>, std::vector<std::size_t>> far_shapes;
  for (std::size_t s = 0; s < contents.shapes.size(); ++s) {
    const glm::dvec3 own = places.origins[s];
    if (common == glm::dvec3(0.0) && IsFar(own, common)) {
      far_shapes[{own.x, own.y, own.z}].push_back(s);
    } else {
      places.origins[s] = common;
    }
  }
  NearOrigins near;
  std::vector<std::vector<std::size_t>> of_origin;
  for (const auto& [place, shapes] : far_shapes) {
    const std::size_t origin = near.Find(glm::dvec3(place[0], place[1], place[2]));
    of_origin.resize(near.origins.size());
    of_origin[origin].insert(of_origin[origin].end(), shapes.begin(), shapes.end());
  }
  for (std::size_t i = 0; i < of_origin.size(); ++i) {
    places.frames.push_back({CountVertices(contents), near.origins[i]});
    for (const std::size_t s : of_origin[i]) {
      places.origins[s] = near.origins[i];
      CopyVertices(s, contents);
    }
  }
}

// The end of a frame's vertices, of so many in all.
std::size_t EndOf(std::span<const ObjFrame> frames, std::size_t frame, std::size_t vertices) {
  return frame + 1 < frames.size() ? frames[frame + 1].first_vertex : vertices;
}

}  // namespace

ObjPlaces PlaceVertices(ObjContents& contents) {
  ObjPlaces places;
  ChooseOrigins(contents, places);
  const std::size_t vertices = CountVertices(contents);
  places.positions.reserve(vertices);
  for (std::size_t f = 0; f < places.frames.size(); ++f) {
    const ObjFrame& frame = places.frames[f];
    for (std::size_t v = frame.first_vertex; v < EndOf(places.frames, f, vertices); ++v) {
      places.positions.emplace_back(PlaceOf(contents, v) - frame.origin);
    }
  }
  return places;
}

std::vector<std::uint32_t> WeldFrames(const ObjPlaces& places) {
  const std::span<const glm::vec3> positions = places.positions;
  const auto end_of = [&](std::size_t frame) { return EndOf(places.frames, frame, positions.size()); };
  std::vector<std::uint32_t> weld = WeldByPosition(positions.first(end_of(0)));
  for (std::size_t f = 1; f < places.frames.size(); ++f) {
    const std::size_t first = places.frames[f].first_vertex;
    for (const std::uint32_t id : WeldByPosition(positions.subspan(first, end_of(f) - first))) {
      weld.push_back(static_cast<std::uint32_t>(first) + id);
    }
  }
  return weld;
}

}  // namespace scumble
