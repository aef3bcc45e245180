// The moving parts of a loaded glTF scene, and their pose at a time. Independent of the file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/load/gltf/animation.h"
#include "guidegen/load/gltf/skin.h"
#include "guidegen/scene.h"

namespace scumble {

// A node of the hierarchy, reached from the scene's roots; parents stand before their children.
struct RigNode {
  int node = 0;     // in the file
  int parent = -1;  // in the rig
  int depth = 0;
  bool moves = false;      // itself or one above it is animated
  bool is_hidden = false;  // itself or one above it, by KHR_node_visibility; cameras are not
  NodePose pose{};         // at rest; used only where it is animated
  glm::dmat4 local{1.0};
  glm::dmat4 world{1.0};  // at rest
};

// A mesh that is deformed: one for each node that has it.
struct RigMesh {
  int mesh = 0;  // in Scene::meshes
  int node = 0;  // in the rig
  int skin = -1;
  MeshDeformation deformation;
  std::vector<double> weights;  // of the targets, at rest
};

struct RigInstance {
  Instance instance;        // as at rest
  int node = 0;             // in the rig
  int rig_mesh = -1;        // where the mesh is deformed
  glm::dmat4 of_copy{1.0};  // from a copy of a mesh to its node
};

struct GltfRig {
  std::string file;
  GltfAnimation animation;
  std::vector<RigNode> nodes;
  std::vector<GltfSkin> skins;  // joints are indices into `nodes`
  std::vector<RigMesh> meshes;
  std::vector<RigInstance> instances;
  std::vector<int> camera_nodes;  // of each of Scene::cameras, in its order
  std::vector<int> light_nodes;

  // Rewrites the animated parts of `scene`, which was loaded with this rig, for a time, or for the rest pose without
  // one. Entries appended to its lists stay. Objects that their transform flattens at that time are not among its
  // instances. Errors name the file, the time and the node or mesh.
  Status Pose(std::optional<double> seconds, Scene& scene) const;
};

// Whether a matrix reduces an object's volume to zero.
bool Flattens(const glm::dmat4& world);

// Rotation and translation only; empty where scale and shear leave no direction.
std::optional<glm::dmat4> WithoutScale(const glm::dmat4& world);

}  // namespace scumble
