#include "guidegen/load/gltf/curves.h"

#include <tiny_gltf.h>

#include <cmath>

#include "guidegen/load/gltf/accessor.h"

namespace scumble {
namespace {

class CurvesLoader {
 public:
  CurvesLoader(const GltfLoad& load, const tinygltf::Primitive& primitive, const std::string& name)
      : load_(load), primitive_(primitive), name_(name) {}

  Expected<Mesh> Load(Curves drawn) {
    if (Accessor("POSITION") < 0 || Accessor("_SCUMBLE_RADIUS") < 0 || primitive_.indices < 0) {
      return InputError(load_.file + ": " + name_ + " has hair without points, radii or segments; " +
                        "export it again with this version's export_scene.py");
    }
    SCUMBLE_ASSIGN(points_, AccessorCount(load_.model, load_.file, Accessor("POSITION"), What("POSITION")));
    SCUMBLE_ASSIGN(const std::size_t segments,
                   AccessorCount(load_.model, load_.file, primitive_.indices, What("indices")));
    SCUMBLE_RETURN_IF_ERROR(load_.budget.Take(load_.file, points_, segments));
    Mesh mesh;
    mesh.curves = std::move(drawn);
    mesh.positions.resize(points_);
    SCUMBLE_RETURN_IF_ERROR(ReadRows("POSITION", 3, "finite numbers", [&](std::size_t i, const float* v) {
      mesh.positions[i] = glm::vec3(v[0], v[1], v[2]);
      return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
    }));
    mesh.curves.radii.resize(points_);
    SCUMBLE_RETURN_IF_ERROR(ReadRows("_SCUMBLE_RADIUS", 1, "0 or more", [&](std::size_t i, const float* v) {
      mesh.curves.radii[i] = v[0];
      return std::isfinite(v[0]) && v[0] >= 0.0f;
    }));
    if (Accessor("TEXCOORD_0") >= 0) {
      mesh.uvs[0].resize(points_);
      SCUMBLE_RETURN_IF_ERROR(ReadRows("TEXCOORD_0", 2, "finite numbers", [&](std::size_t i, const float* v) {
        mesh.uvs[0][i] = glm::vec2(v[0], v[1]);
        return std::isfinite(v[0]) && std::isfinite(v[1]);
      }));
    }
    SCUMBLE_RETURN_IF_ERROR(ReadSegments(mesh));
    return mesh;
  }

 private:
  std::string What(const std::string& attribute) const { return name_ + ", " + attribute; }

  int Accessor(const std::string& attribute) const {
    const auto it = primitive_.attributes.find(attribute);
    return it == primitive_.attributes.end() ? -1 : it->second;
  }

  // put(i, values) returns whether the values may be so.
  template <class Put>
  Status ReadRows(const std::string& attribute, int components, const char* expected, Put put) {
    const int accessor = Accessor(attribute);
    SCUMBLE_ASSIGN(const FloatTable table, ReadFloats(load_.model, load_.file, accessor, What(attribute)));
    if (table.count != points_ || table.components != components) {
      return InputError(load_.file + ": " + What(attribute) + ": accessor " + std::to_string(accessor) + " has " +
                        std::to_string(table.count) + " × " + std::to_string(table.components) + " numbers; expected " +
                        std::to_string(points_) + " × " + std::to_string(components));
    }
    for (std::size_t i = 0; i < points_; ++i) {
      if (put(i, table.values.data() + i * std::size_t(components))) continue;
      return InputError(load_.file + ": " + What(attribute) + ": point " + std::to_string(i) + " of accessor " +
                        std::to_string(accessor) + " is not one; expected " + expected);
    }
    return Ok();
  }

  Status ReadSegments(Mesh& mesh) {
    SCUMBLE_ASSIGN(mesh.curves.segments,
                   ReadIndices(load_.model, load_.file, primitive_.indices, points_, What("indices")));
    for (const std::uint32_t first : mesh.curves.segments) {
      if (std::size_t(first) + 4 <= points_) continue;
      return InputError(load_.file + ": " + What("indices") + ": a segment begins at point " + std::to_string(first) +
                        " of " + std::to_string(points_) + "; expected three more behind it");
    }
    return Ok();
  }

  const GltfLoad& load_;
  const tinygltf::Primitive& primitive_;
  const std::string& name_;
  std::size_t points_ = 0;
};

}  // namespace

Expected<Mesh> LoadCurves(const GltfLoad& load, const tinygltf::Primitive& primitive, const std::string& name,
                          Curves drawn) {
  return CurvesLoader(load, primitive, name).Load(std::move(drawn));
}

}  // namespace scumble
