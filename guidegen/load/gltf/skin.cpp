#include "guidegen/load/gltf/skin.h"

#include <tiny_gltf.h>

#include <cmath>
#include <utility>

#include "core/image/check.h"
#include "guidegen/load/gltf/accessor.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/load/mesh_normals.h"

namespace scumble {
namespace {

glm::vec3 UnitOr(const glm::dvec3& v, const glm::vec3& otherwise) {
  const double length = glm::length(v);
  return length > 0.0 && std::isfinite(length) ? glm::vec3(v / length) : otherwise;
}

// The inverse transpose up to a positive factor, without a division; defined for flat matrices too.
glm::dmat3 NormalMatrix(const glm::dmat3& m) {
  const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0.0 ? -cofactors : cofactors;
}

glm::dmat4 BlendJoints(const MeshDeformation& deformation, std::size_t vertex, std::span<const glm::dmat4> matrices) {
  const std::size_t first = vertex * std::size_t(deformation.influences);
  double sum = 0.0;
  for (int i = 0; i < deformation.influences; ++i) sum += double(deformation.weights[first + std::size_t(i)]);
  if (!(sum > 0.0)) return matrices[deformation.joints[first]];
  glm::dmat4 blend(0.0);
  for (std::size_t i = first; i < first + std::size_t(deformation.influences); ++i) {
    const double weight = double(deformation.weights[i]) / sum;
    if (weight > 0.0) blend += weight * matrices[deformation.joints[i]];
  }
  return blend;
}

// The deltas of the active targets for one attribute. They are collected once: most of many targets may be empty or
// have weight 0, and no vertex visits those.
class ActiveDeltas {
 public:
  ActiveDeltas(const MeshDeformation& deformation, std::span<const double> weights,
               std::vector<glm::vec3> MorphTarget::*attribute) {
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const std::vector<glm::vec3>& deltas = deformation.targets[i].*attribute;
      if (weights[i] != 0.0 && !deltas.empty()) active_.emplace_back(weights[i], deltas.data());
    }
  }

  bool empty() const { return active_.empty(); }

  // `rest` plus the deltas, in double.
  glm::dvec3 Add(const glm::dvec3& rest, std::size_t vertex) const {
    glm::dvec3 sum = rest;
    for (const auto& [weight, deltas] : active_) sum += weight * glm::dvec3(deltas[vertex]);
    return sum;
  }

 private:
  std::vector<std::pair<double, const glm::vec3*>> active_;  // by vertex, each
};

void MorphMesh(const MeshDeformation& deformation, std::span<const double> weights, Mesh& mesh) {
  const ActiveDeltas positions(deformation, weights, &MorphTarget::positions);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    mesh.positions[v] = glm::vec3(positions.Add(glm::dvec3(mesh.rest_positions[v]), v));
  }
  const ActiveDeltas normals(deformation, weights, &MorphTarget::normals);
  for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
    const glm::vec3& rest = deformation.normals[v];
    mesh.normals[v] = UnitOr(normals.Add(rest, v), rest);
  }
  const ActiveDeltas tangents(deformation, weights, &MorphTarget::tangents);
  for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
    const glm::vec4& rest = deformation.tangents[v];
    mesh.tangents[v] = glm::vec4(UnitOr(tangents.Add(glm::dvec3(rest), v), glm::vec3(rest)), rest.w);
  }
}

void SkinMesh(const MeshDeformation& deformation, std::span<const glm::dmat4> matrices, Mesh& mesh) {
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::dmat4 blend = BlendJoints(deformation, v, matrices);
    const glm::dmat3 linear(blend);
    mesh.positions[v] = glm::vec3(linear * glm::dvec3(mesh.positions[v]) + glm::dvec3(blend[3]));
    if (!mesh.normals.empty()) {
      mesh.normals[v] = UnitOr(NormalMatrix(linear) * glm::dvec3(mesh.normals[v]), mesh.normals[v]);
    }
    if (!mesh.tangents.empty()) {
      const glm::vec4 tangent = mesh.tangents[v];
      mesh.tangents[v] = glm::vec4(UnitOr(linear * glm::dvec3(tangent), glm::vec3(tangent)), tangent.w);
    }
  }
}

}  // namespace

Expected<GltfSkin> ReadSkin(const tinygltf::Model& model, const std::string& file, int index) {
  const auto bad = [&](const std::string& who, const std::string& what) {
    return InputError(file + ": " + who + " " + what + ": export it again");
  };
  if (index < 0 || std::size_t(index) >= model.skins.size()) {
    return bad("skin " + std::to_string(index), "does not exist, the file has " + std::to_string(model.skins.size()));
  }
  const tinygltf::Skin& from = model.skins[std::size_t(index)];
  GltfSkin skin;
  skin.name = "skin " + std::to_string(index) + (from.name.empty() ? "" : " '" + Excerpt(from.name, 80) + "'");
  skin.joints = from.joints;
  if (skin.joints.empty()) return bad(skin.name, "has no joints; expected one or more");
  if (from.inverseBindMatrices < 0) {
    skin.inverse_bind.assign(skin.joints.size(), glm::dmat4(1.0));
    return skin;
  }
  SCUMBLE_ASSIGN(skin.inverse_bind,
                 ReadMatrices(model, file, from.inverseBindMatrices, skin.name + ", inverse bind matrices"));
  if (skin.inverse_bind.size() < skin.joints.size()) {
    return bad(skin.name, "has " + std::to_string(skin.inverse_bind.size()) + " inverse bind matrices for " +
                              std::to_string(skin.joints.size()) + " joints; expected as many");
  }
  for (std::size_t i = 0; i < skin.inverse_bind.size(); ++i) {
    const glm::dmat4& m = skin.inverse_bind[i];
    const glm::dvec4 last_row(m[0][3], m[1][3], m[2][3], m[3][3] - 1.0);
    // Exporters invert in float, so the last row may be off by its rounding.
    if (glm::length(last_row) < 1e-3) continue;
    return bad(skin.name, "has an inverse bind matrix with a projective part, for joint " + std::to_string(i));
  }
  return skin;
}

bool DeformMesh(const MeshDeformation& deformation, std::span<const double> morph_weights,
                std::span<const glm::dmat4> joint_matrices, Mesh& mesh) {
  SCUMBLE_CHECK_EQ(morph_weights.size(), deformation.targets.size());
  SCUMBLE_CHECK_EQ(mesh.rest_positions.size(), mesh.positions.size());
  const bool skinned = !joint_matrices.empty() && deformation.influences > 0;
  MorphMesh(deformation, morph_weights, mesh);
  if (skinned) SkinMesh(deformation, joint_matrices, mesh);
  if (!deformation.shared_normals.empty() && (skinned || mesh.positions != mesh.rest_positions)) {
    mesh.normals = SmoothNormals(mesh.positions, mesh.triangles, deformation.shared_normals);
  }
  for (const glm::vec3& position : mesh.positions) {
    if (!IsFinite(position)) return false;
  }
  return true;
}

}  // namespace scumble
