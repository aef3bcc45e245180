#include "guidegen/load/gltf/gpu_instances.h"

#include <tiny_gltf.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "guidegen/load/gltf/nodes.h"
#include "guidegen/scene/matrix_util.h"

namespace scumble {

Expected<std::vector<glm::dmat4>> ReadGpuInstances(const tinygltf::Model& model, const std::string& file, int node,
                                                   ZeroBudget& zeros, WarningCounter& warnings) {
  const auto& extensions = model.nodes[std::size_t(node)].extensions;
  const auto found = extensions.find("EXT_mesh_gpu_instancing");
  if (found == extensions.end() || !found->second.Has("attributes")) return std::vector<glm::dmat4>();
  const tinygltf::Value& attributes = found->second.Get("attributes");
  const std::string place = NodeLabel(model, node) + ", EXT_mesh_gpu_instancing";
  std::size_t count = 0;
  std::string counted;
  const auto read = [&](const char* name, int components) -> Expected<FloatTable> {
    if (!attributes.Has(name)) return FloatTable();
    const std::string what = place + ", " + name;
    const int accessor = attributes.Get(name).IsInt() ? attributes.Get(name).GetNumberAsInt() : -1;
    SCUMBLE_RETURN_IF_ERROR(zeros.Take(model, file, accessor));
    SCUMBLE_ASSIGN(FloatTable table, ReadFloats(model, file, accessor, what));
    if (table.components != components) {
      return InputError(file + ": " + what + " has " + std::to_string(table.components) + " numbers each; expected " +
                        std::to_string(components) + ": export it again");
    }
    if (!counted.empty() && table.count != count) {
      return InputError(file + ": " + what + " has " + std::to_string(table.count) + " entries, " + counted + " has " +
                        std::to_string(count) + "; expected as many: export it again");
    }
    count = table.count, counted = name;
    return table;
  };
  SCUMBLE_ASSIGN(const FloatTable translation, read("TRANSLATION", 3));
  SCUMBLE_ASSIGN(const FloatTable rotation, read("ROTATION", 4));
  SCUMBLE_ASSIGN(const FloatTable scale, read("SCALE", 3));
  if (counted.empty() && attributes.IsObject() && attributes.Size() > 0) {
    warnings.Add("copies of a mesh without places for them are ignored, it is seen once", NodeLabel(model, node));
  }
  std::vector<glm::dmat4> instances;
  for (std::size_t i = 0; i < count; ++i) {
    const auto vector = [&](const FloatTable& table, double none) {
      if (table.count == 0) return glm::dvec3(none);
      return glm::dvec3(table.values[3 * i], table.values[3 * i + 1], table.values[3 * i + 2]);
    };
    glm::dmat4 instance = glm::translate(glm::dmat4(1.0), vector(translation, 0.0));
    if (rotation.count > 0) {
      const float* const q = rotation.values.data() + 4 * i;
      const glm::dquat turn(q[3], q[0], q[1], q[2]);
      const double length = glm::length(turn);
      if (!(length > 0.0)) {
        return InputError(file + ": " + place + ", entry " + std::to_string(i) +
                          " has a rotation of zero length: export it again");
      }
      instance = instance * glm::mat4_cast(turn / length);
    }
    instance = glm::scale(instance, vector(scale, 1.0));
    if (!IsFinite(instance)) {
      return InputError(file + ": " + place + ", entry " + std::to_string(i) +
                        " has an infinite transform: export it again");
    }
    instances.push_back(instance);
  }
  return instances;
}

}  // namespace scumble
