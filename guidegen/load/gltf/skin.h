// glTF's deformed meshes: morph targets first, then linear blend skinning (glTF 2.0, sections 3.7.2.2 and 3.7.3).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/scene.h"

namespace tinygltf {
class Model;
}

namespace scumble {

// One target's deltas of a mesh, per vertex; attributes that the file leaves out are empty.
struct MorphTarget {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec3> tangents;
};

// The deformation of a mesh. Its rest shape is mesh.rest_positions and the attributes kept here.
struct MeshDeformation {
  std::vector<MorphTarget> targets;
  int influences = 0;                 // joints of each vertex; 0 where the mesh is not skinned
  std::vector<std::uint16_t> joints;  // by vertex, `influences` each; numbers in the skin's list
  std::vector<float> weights;         // likewise, of 0 or more
  // Where the file gives no normals, which vertices share one (SplitVertices::shared): a deformed shape gets normals of
  // its own, and stays smooth or sharp where the rest shape is. Empty: `normals` are deformed.
  std::vector<std::uint32_t> shared_normals;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec4> tangents;
};

// A skeleton: nodes, and for each the matrix from the mesh's space to the node's at rest.
struct GltfSkin {
  std::string name;  // for messages
  std::vector<int> joints;
  std::vector<glm::dmat4> inverse_bind;
};

// Without an inverse bind matrix each is the identity. A skin without joints, or with fewer matrices than joints, is a
// kInput error that names it. The caller checks whether the joints exist.
Expected<GltfSkin> ReadSkin(const tinygltf::Model& model, const std::string& file, int index);

// Rewrites positions, normals and tangents of a mesh from its rest shape. `morph_weights` has one entry per target.
// `joint_matrices` take rest positions to object space, and are empty where the mesh is not skinned. Normals use the
// inverse transpose of the blended matrix and are unit again. Weights are divided by their sum; a vertex without any
// follows its first joint. The result depends on the arguments alone. False if a position is not finite; the mesh is
// then unusable.
[[nodiscard]] bool DeformMesh(const MeshDeformation& deformation, std::span<const double> morph_weights,
                              std::span<const glm::dmat4> joint_matrices, Mesh& mesh);

}  // namespace scumble
