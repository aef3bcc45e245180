#include "guidegen/rays/coincident_objects.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <unordered_map>

#include "core/image/hash.h"
#include "guidegen/surface/bsdf.h"

namespace scumble {
namespace {

// A hash of the matrix, the sizes, and the first and last position: enough to separate nearly all objects.
std::uint64_t HashOf(const PlacedObject& object) {
  const Mesh& mesh = *object.mesh;
  std::uint64_t hash = Hash(mesh.positions.size(), mesh.triangles.size());
  const auto add = [&](double value) { hash = HashOn(hash, std::bit_cast<std::uint64_t>(value + 0.0)); };  // −0 is 0
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) add(object.view_from_object[column][row]);
  }
  for (const glm::vec3& place : {mesh.positions.front(), mesh.positions.back()}) {
    for (int axis = 0; axis < 3; ++axis) add(double(place[axis]));
  }
  return hash;
}

bool IsCopy(const PlacedObject& a, const PlacedObject& b) {
  if (a.view_from_object != b.view_from_object) return false;
  return a.mesh == b.mesh || (a.mesh->positions == b.mesh->positions && a.mesh->triangles == b.mesh->triangles);
}

bool MayCover(const PlacedObject& over) { return !MayHaveHoles(*over.material); }

bool Covers(const PlacedObject& over, const PlacedObject& under) {
  const bool seen_from_behind =
      over.material->double_sided || (!under.material->double_sided && over.winding == under.winding);
  return seen_from_behind && IsCopy(over, under);
}

}  // namespace

std::vector<bool> FindHiddenCoincident(std::span<const PlacedObject> objects) {
  std::vector<bool> covered(objects.size(), false);
  std::unordered_map<std::uint64_t, std::vector<const PlacedObject*>> seen;
  for (std::size_t i = objects.size(); i-- > 0;) {
    const PlacedObject& object = objects[i];
    if (!object.mesh || object.mesh->triangles.empty() || MayEmit(*object.material)) continue;
    std::vector<const PlacedObject*>& here = seen[HashOf(object)];
    covered[i] = std::any_of(here.begin(), here.end(), [&](const PlacedObject* over) { return Covers(*over, object); });
    if (!covered[i] && MayCover(object)) here.push_back(&object);
  }
  return covered;
}

std::vector<bool> FindTied(std::span<const PlacedObject> objects, const std::vector<bool>& hidden) {
  constexpr std::uint64_t kNone = 0;
  std::vector<std::uint64_t> hashes(objects.size(), kNone);
  std::unordered_map<std::uint64_t, int> count;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (hidden[i] || !objects[i].mesh || objects[i].mesh->triangles.empty()) continue;
    hashes[i] = HashOf(objects[i]);
    ++count[hashes[i]];
  }
  std::vector<bool> tied(objects.size(), false);
  for (std::size_t i = 0; i < objects.size(); ++i) tied[i] = hashes[i] != kNone && count[hashes[i]] > 1;
  return tied;
}

}  // namespace scumble
