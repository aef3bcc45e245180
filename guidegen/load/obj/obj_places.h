// Where the vertices of an OBJ file are: in floats, each relative to an origin. guidegen/load/obj/obj.h says where
// origins are.
//
// A frame is a run of vertices that share an origin. The first frame has the file's own vertices. Each further one has
// copies for shapes that are far from the file's origin and near each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "guidegen/load/obj/obj_parse.h"

namespace scumble {

struct ObjFrame {
  std::size_t first_vertex = 0;  // the frame ends where the next one begins
  glm::dvec3 origin{0.0};
};

struct ObjPlaces {
  std::vector<ObjFrame> frames;      // one at least, in the order of their vertices
  std::vector<glm::dvec3> origins;   // of each shape
  std::vector<glm::vec3> positions;  // of each vertex, relative to its frame's origin
};

// Cannot fail: positions must be finite, and the vertex indices of all shapes valid. Far shapes get their own vertices,
// at the end of `contents.attributes`, and their vertex indices name those; nothing else of `contents` changes. The
// result is a copy, which does not refer to `contents`.
ObjPlaces PlaceVertices(ObjContents& contents);

// One id per vertex: the first vertex of its frame that has exactly its position. Vertices of two frames never share an
// id, because their positions are relative to other origins.
std::vector<std::uint32_t> WeldFrames(const ObjPlaces& places);

}  // namespace scumble
