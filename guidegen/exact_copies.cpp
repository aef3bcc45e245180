#include "guidegen/exact_copies.h"

#include <algorithm>
#include <array>
#include <map>

#include "guidegen/bsdf.h"

namespace scumble {
namespace {

// The matrix, how much there is, and the first and last place of it: what tells nearly all shapes apart.
using Key = std::array<double, 24>;

Key KeyOf(const PlacedObject& object) {
  const Mesh& mesh = *object.mesh;
  Key key;
  auto at = key.begin();
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) *at++ = object.view_from_object[column][row];
  }
  *at++ = double(mesh.positions.size());
  *at++ = double(mesh.triangles.size());
  for (const glm::vec3& place : {mesh.positions.front(), mesh.positions.back()}) {
    for (int axis = 0; axis < 3; ++axis) *at++ = double(place[axis]);
  }
  return key;
}

bool IsSameShape(const Mesh& a, const Mesh& b) {
  return &a == &b || (a.positions == b.positions && a.triangles == b.triangles);
}

bool Covers(const PlacedObject& over, const PlacedObject& under) {
  const bool seen_from_behind =
      over.material->double_sided || (!under.material->double_sided && over.winding == under.winding);
  return seen_from_behind && !MayHaveHoles(*over.material) && IsSameShape(*over.mesh, *under.mesh);
}

}  // namespace

std::vector<bool> FindCoveredCopies(std::span<const PlacedObject> objects) {
  std::vector<bool> covered(objects.size(), false);
  std::map<Key, std::vector<const PlacedObject*>> seen;
  for (std::size_t i = objects.size(); i-- > 0;) {
    const PlacedObject& object = objects[i];
    if (!object.mesh || object.mesh->triangles.empty() || MayEmit(*object.material)) continue;
    const Key key = KeyOf(object);
    // A NaN is not in order with anything.
    if (std::any_of(key.begin(), key.end(), [](double value) { return !(value == value); })) continue;
    std::vector<const PlacedObject*>& here = seen[key];
    covered[i] = std::any_of(here.begin(), here.end(), [&](const PlacedObject* over) { return Covers(*over, object); });
    if (!covered[i]) here.push_back(&object);
  }
  return covered;
}

}  // namespace scumble
