#include "guidegen/load/gltf/rig.h"

#include <cmath>
#include <span>
#include <utility>

#include "guidegen/scene/matrix_util.h"

namespace scumble {
namespace {

// The frame of a skinned mesh, which its joints place, not its node. The object's origin is the first joint, so that a
// character far from the world's origin keeps its floats' precision. A mirrored skeleton mirrors the object, so that
// its triangles keep their front sides.
glm::dmat4 SkinFrame(const glm::dmat4& first_joint, const glm::dmat4& first_matrix) {
  glm::dmat4 frame(1.0);
  if (glm::determinant(glm::dmat3(first_matrix)) < 0.0) frame[0][0] = -1.0;
  frame[3] = first_joint[3];
  return frame;
}

struct PlacedSkin {
  bool moves = false;
  glm::dmat4 frame{1.0};             // of the meshes with this skin
  std::vector<glm::dmat4> matrices;  // by joint, from rest to that frame
};

// Poses one scene at one time; the members are shared arguments.
class Poser {
 public:
  Poser(const GltfRig& rig, std::optional<double> seconds, Scene& scene)
      : rig_(rig), seconds_(seconds), scene_(scene) {}

  Status Run() {
    SCUMBLE_RETURN_IF_ERROR(PlaceNodes());
    PlaceSkins();
    for (const RigMesh& mesh : rig_.meshes) SCUMBLE_RETURN_IF_ERROR(Deform(mesh));
    PlaceInstances();
    if (!seconds_) return Ok();
    SCUMBLE_RETURN_IF_ERROR(Place(
        rig_.camera_nodes, "camera", [&](std::size_t i) -> auto& { return scene_.cameras[i].world_from_camera; }));
    return Place(
        rig_.light_nodes, "light", [&](std::size_t i) -> auto& { return scene_.lights[i].world_from_light; });
  }

 private:
  Error Bad(const std::string& what) const {
    const std::string when = seconds_ ? ", at " + std::to_string(*seconds_) + " s" : "";
    return InputError(rig_.file + when + ": " + what + ": fix the animation and export it again");
  }

  Status PlaceNodes() {
    world_.reserve(rig_.nodes.size());
    for (const RigNode& node : rig_.nodes) {
      world_.push_back(node.world);
      if (!seconds_ || !node.moves) continue;
      glm::dmat4 local = node.local;
      if (rig_.animation.Moves(node.node)) {
        NodePose pose = node.pose;
        rig_.animation.Pose(node.node, *seconds_, pose);
        local = LocalMatrix(pose);
      }
      world_.back() = node.parent < 0 ? local : world_[std::size_t(node.parent)] * local;
      if (!IsFinite(world_.back())) return Bad("node " + std::to_string(node.node) + " has an infinite transform");
    }
    return Ok();
  }

  // Once for each skin, which any number of meshes may share.
  void PlaceSkins() {
    for (const GltfSkin& from : rig_.skins) {
      PlacedSkin skin;
      for (std::size_t i = 0; i < from.joints.size(); ++i) {
        skin.moves = skin.moves || rig_.nodes[std::size_t(from.joints[i])].moves;
        skin.matrices.push_back(world_[std::size_t(from.joints[i])] * from.inverse_bind[i]);
      }
      skin.frame = SkinFrame(world_[std::size_t(from.joints[0])], skin.matrices[0]);
      for (glm::dmat4& matrix : skin.matrices) {
        matrix[3] = glm::dvec4(glm::dvec3(matrix[3]) - glm::dvec3(skin.frame[3]), 1.0);
        for (int column = 0; column < 4; ++column) matrix[column][0] *= skin.frame[0][0];
      }
      skins_.push_back(std::move(skin));
    }
  }

  // Whether its shape at some time may differ from the one at rest.
  bool Changes(const RigMesh& mesh) const {
    if (rig_.animation.Morphs(rig_.nodes[std::size_t(mesh.node)].node)) return true;
    return mesh.skin >= 0 && skins_[std::size_t(mesh.skin)].moves;
  }

  Status Deform(const RigMesh& mesh) {
    std::span<const glm::dmat4> matrices;
    if (mesh.skin >= 0) matrices = skins_[std::size_t(mesh.skin)].matrices;
    if (seconds_ && !Changes(mesh)) return Ok();
    const int node = rig_.nodes[std::size_t(mesh.node)].node;
    const bool morphs = seconds_ && rig_.animation.Morphs(node);
    const std::vector<double> weights = morphs ? rig_.animation.MorphWeights(node, *seconds_) : mesh.weights;
    if (DeformMesh(mesh.deformation, weights, matrices, scene_.meshes[std::size_t(mesh.mesh)])) return Ok();
    return Bad("the mesh of node " + std::to_string(node) + " is deformed to infinity");
  }

  void PlaceInstances() {
    scene_.instances.clear();
    for (const RigInstance& from : rig_.instances) {
      Instance instance = from.instance;
      const int skin = from.rig_mesh < 0 ? -1 : rig_.meshes[std::size_t(from.rig_mesh)].skin;
      instance.world_from_object =
          skin < 0 ? world_[std::size_t(from.node)] * from.of_copy : skins_[std::size_t(skin)].frame;
      if (!Flattens(instance.world_from_object)) scene_.instances.push_back(std::move(instance));
    }
  }

  template <class MatrixOf>
  Status Place(const std::vector<int>& nodes, const char* what, MatrixOf matrix_of) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const RigNode& node = rig_.nodes[std::size_t(nodes[i])];
      if (!node.moves) continue;
      const std::optional<glm::dmat4> world = WithoutScale(world_[std::size_t(nodes[i])]);
      if (!world) {
        return Bad(std::string("the ") + what + " of node " + std::to_string(node.node) +
                   " is scaled or sheared until it has no direction");
      }
      matrix_of(i) = *world;
    }
    return Ok();
  }

  const GltfRig& rig_;
  const std::optional<double> seconds_;
  Scene& scene_;
  std::vector<glm::dmat4> world_;  // of the rig's nodes
  std::vector<PlacedSkin> skins_;  // of the rig's
};

}  // namespace

bool Flattens(const glm::dmat4& world) {
  const double determinant = glm::determinant(glm::dmat3(world));
  return determinant == 0.0 || !std::isfinite(1.0 / determinant);
}

std::optional<glm::dmat4> WithoutScale(const glm::dmat4& world) {
  const std::optional<glm::dmat3> axes = StraightenAxes(world);
  if (!axes) return std::nullopt;
  glm::dmat4 rigid(*axes);
  rigid[3] = world[3];
  return rigid;
}

Status GltfRig::Pose(std::optional<double> seconds, Scene& scene) const { return Poser(*this, seconds, scene).Run(); }

}  // namespace scumble
