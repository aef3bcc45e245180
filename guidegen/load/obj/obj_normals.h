// Normals that an OBJ file lacks. guidegen/load/obj/obj.h says which faces they are smooth across.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "guidegen/load/obj/obj_places.h"

namespace scumble {

// A corner of a triangle: indices of a vertex, of a texture coordinate and of a normal. `uv` is -1 where there is none.
// `normal` is an index into the file's normals, or -1 - an index into those made here.
struct ObjCorner {
  int position = 0;
  int uv = -1;
  std::int64_t normal = 0;
  bool operator==(const ObjCorner&) const = default;
};

struct ObjTriangle {
  ObjCorner corners[3];
  std::size_t face = 0;  // counted through the whole file
  unsigned smoothing_group = 0;
  int shape = 0;
  int material = -1;
};

struct ObjNormals {
  std::span<const double> given;  // the file's, three numbers each; not owned
  std::vector<glm::vec3> made;

  // The corner's normal, of any length; its index must be valid.
  glm::vec3 At(const ObjCorner& corner) const;
};

// Gives a normal to each corner whose index is below 0, and fills `normals.made` with unit normals. They are smooth
// over all shapes with one origin, so that no seam shows between shapes or materials. Faces that lie on others have the
// normals of those, which may be the file's.
// `degrees`: smooth up to this angle, as AutoSmoothNormals; none: as the smoothing groups say.
// Cannot fail: all indices must be valid, and the triangles in the order of their faces.
void MakeObjNormals(const ObjPlaces& places, std::optional<double> degrees, std::span<ObjTriangle> triangles,
                    ObjNormals& normals);

}  // namespace scumble
