#include "guidegen/load/gltf/gltf_scene.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "guidegen/load/gltf/accessor.h"
#include "guidegen/load/gltf/camera_light.h"
#include "guidegen/load/gltf/gltf_extras.h"
#include "guidegen/load/gltf/gpu_instances.h"
#include "guidegen/load/gltf/materials.h"
#include "guidegen/load/gltf/meshes.h"
#include "guidegen/load/gltf/nodes.h"
#include "guidegen/load/gltf/parse.h"
#include "guidegen/load/loader_util.h"

namespace scumble {
namespace {

// Exporters write morph targets without data: 100 targets that do not change the positions and normals of 100,000
// vertices have 20 million elements.
constexpr std::uint64_t kMaxZerosOfTargets = 4 * kMaxZeroElements;
// Counted for each node. 100,000 meshes of 150 targets with three attributes have 60 million; the vertices of so many
// targets reach their own limit long before.
constexpr std::uint64_t kMaxParts = 64'000'000;
// A skin needs as many inverse bind matrices as joints; further ones are allowed, and ignored.
constexpr std::size_t kMaxSpareMatrices = 1024;

// Of all copies that EXT_mesh_gpu_instancing lists.
constexpr std::uint64_t kMaxNamesOfCopies = std::uint64_t(1) << 28;

class GltfLoader {
 public:
  // `animation` as in AnimationOptions; without one the scene is at rest.
  GltfLoader(std::string file, std::optional<std::string> animation, MissingNormals missing)
      : file_(std::move(file)), animation_(std::move(animation)), missing_(missing) {}

  Expected<MovingScene> Load(const std::filesystem::path& path, const FileListener& on_file) {
    SCUMBLE_RETURN_IF_ERROR(ParseGltf(path, on_file, model_, warnings_));
    SCUMBLE_RETURN_IF_ERROR(CheckVersionAndExtensions());
    SCUMBLE_RETURN_IF_ERROR(LoadGltfMaterials(model_, file_, scene_, warnings_));
    SCUMBLE_RETURN_IF_ERROR(ReadMaterialExtras(model_, file_, scene_));
    ShareDefaultMaterial();
    SCUMBLE_RETURN_IF_ERROR(ReadSceneExtras(model_, std::max(model_.defaultScene, 0), file_, scene_));
    rig_.file = file_;
    if (animation_) {
      SCUMBLE_ASSIGN(rig_.animation, GltfAnimation::Read(model_, file_, *animation_, warnings_));
    }
    SCUMBLE_ASSIGN(rig_.nodes, ReadNodes(model_, file_, rig_.animation, warnings_));
    for (std::size_t i = 0; i < rig_.nodes.size(); ++i) rig_node_of_[rig_.nodes[i].node] = static_cast<int>(i);
    SCUMBLE_ASSIGN(names_, NameObjects(model_, file_, rig_.nodes));
    for (std::size_t i = 0; i < rig_.nodes.size(); ++i) SCUMBLE_RETURN_IF_ERROR(LoadNode(i));
    SCUMBLE_RETURN_IF_ERROR(CheckHasTriangles());
    SCUMBLE_RETURN_IF_ERROR(CheckAnimatedWeights());
    if (!rig_.meshes.empty()) SCUMBLE_RETURN_IF_ERROR(rig_.Pose(std::nullopt, scene_));
    WarnOfUsedMaterials(model_, scene_, warnings_);
    WarnOfIgnoredParts();
    warnings_.MoveTo(scene_.warnings);
    missing_.Tell(scene_.notes);
    return MovingScene{std::move(scene_), std::move(rig_), AnimationNames(model_)};
  }

 private:
  std::string Label(int node) const { return NodeLabel(model_, node); }

  Status CheckVersionAndExtensions() const {
    if (model_.asset.version.rfind("2.", 0) != 0) {
      return InputError(file_ + " is glTF version '" + Excerpt(model_.asset.version, 40) +
                        "'; expected 2.0, export it as glTF 2.0");
    }
    return CheckRequiredExtensions(file_, model_.extensionsRequired);
  }

  // A file's own default may be anywhere in its list, and searching for it with each primitive without a material would
  // take quadratic time. One that we make is at the end, and is found at once.
  void ShareDefaultMaterial() {
    const int shared = FindDefaultMaterial(scene_);
    if (shared < 0) return;
    for (tinygltf::Mesh& mesh : model_.meshes) {
      for (tinygltf::Primitive& primitive : mesh.primitives) {
        if (primitive.material < 0) primitive.material = shared;
      }
    }
  }

  Status LoadNode(std::size_t index) {
    SCUMBLE_RETURN_IF_ERROR(LoadWhatNodeHolds(index));
    // A node has one light at most.
    if (scene_.lights.size() > rig_.light_nodes.size()) rig_.light_nodes.push_back(static_cast<int>(index));
    return Ok();
  }

  Status LoadWhatNodeHolds(std::size_t index) {
    const RigNode& visit = rig_.nodes[index];
    const tinygltf::Node& node = model_.nodes[std::size_t(visit.node)];
    if (node.mesh >= 0 && !visit.is_hidden) SCUMBLE_RETURN_IF_ERROR(LoadInstances(index));
    if (node.camera >= 0) {
      SCUMBLE_ASSIGN(Camera camera, ReadCamera(model_, file_, visit));
      camera.name = camera_names_.Take(camera.name);
      scene_.cameras.push_back(std::move(camera));
      rig_.camera_nodes.push_back(static_cast<int>(index));
    }
    if (visit.is_hidden) return Ok();
    SCUMBLE_ASSIGN(std::optional<Light> light, ReadLight(model_, file_, visit, warnings_));
    if (light) scene_.lights.push_back(*std::move(light));
    return Ok();
  }

  Status LoadInstances(std::size_t index) {
    const RigNode& visit = rig_.nodes[index];
    const tinygltf::Node& node = model_.nodes[std::size_t(visit.node)];
    if (std::size_t(node.mesh) >= model_.meshes.size()) {
      return InputError(file_ + ": " + Label(visit.node) + " uses mesh " + std::to_string(node.mesh) +
                        ", the file has " + std::to_string(model_.meshes.size()) + ": export it again");
    }
    // A skeleton places its mesh anew, and an animation may restore a mesh that is flat at rest.
    if (Flattens(visit.world) && !visit.moves && node.skin < 0) {
      // A scale of 0 along all axes is how glTF and Blender hide things.
      if (glm::dmat3(visit.world) != glm::dmat3(0.0)) {
        warnings_.Add("objects that their transform flattens are left out", Label(visit.node));
      }
      return Ok();
    }
    Instance instance{names_[index], 0, visit.world};
    SCUMBLE_RETURN_IF_ERROR(ReadObjectExtras(node, file_ + ": " + Label(visit.node), instance));
    SCUMBLE_RETURN_IF_ERROR(TakeTargets(node.mesh));
    SCUMBLE_ASSIGN(const std::vector<double> weights, MorphWeights(visit.node));
    const bool morphs = rig_.animation.Morphs(visit.node) ||
                        std::any_of(weights.begin(), weights.end(), [](double weight) { return weight != 0.0; });
    SCUMBLE_ASSIGN(const std::vector<glm::dmat4> copies,
                   ReadGpuInstances(model_, file_, visit.node, zeros_, warnings_));
    if (node.skin >= 0 || morphs) {
      if (!copies.empty())
        warnings_.Add("copies of a mesh that is deformed are ignored, it is seen once", Label(visit.node));
      return LoadDeformed(static_cast<int>(index), std::move(instance), morphs ? weights : std::vector<double>());
    }
    const auto [loaded, is_new] = loaded_meshes_.try_emplace(node.mesh);
    if (is_new) {
      SCUMBLE_RETURN_IF_ERROR(TakeZeros(node.mesh, false));
      SCUMBLE_ASSIGN(loaded->second,
                     LoadGltfMesh({model_, file_, scene_, budget_, warnings_, choice_, missing_}, node.mesh));
    }
    bool is_first = is_new;
    const auto add = [&](const glm::dmat4& of_copy) -> Status {
      for (int mesh : loaded->second) {
        SCUMBLE_RETURN_IF_ERROR(budget_.TakeInstance(file_, scene_.meshes[std::size_t(mesh)], is_first));
        instance.mesh = mesh;
        AddInstance({instance, static_cast<int>(index), -1, of_copy});
      }
      is_first = false;
      return Ok();
    };
    if (copies.empty()) return add(glm::dmat4(1.0));
    SCUMBLE_RETURN_IF_ERROR(TakeCopyNames(index, copies.size()));
    for (std::size_t i = 0; i < copies.size(); ++i) {
      if (i > 0) instance.object = copy_names_.Take(names_[index]);
      instance.world_from_object = visit.world * copies[i];
      SCUMBLE_RETURN_IF_ERROR(add(copies[i]));
    }
    return Ok();
  }

  // Each copy is an object of its own, "Tree", "Tree#2", …: names that no node has.
  Status TakeCopyNames(std::size_t index, std::size_t copies) {
    if (!has_copies_) {
      for (const std::string& name : names_) copy_names_.Take(name);
    }
    has_copies_ = true;
    bytes_of_copies_ += copies * names_[index].size();
    if (bytes_of_copies_ <= kMaxNamesOfCopies) return Ok();
    return InputError(file_ + ": the names of copied meshes come to more than " + std::to_string(kMaxNamesOfCopies) +
                      " bytes, at " + Label(rig_.nodes[index].node) + ": give a shorter name");
  }

  Status TakeParts(std::uint64_t more) {
    parts_ += more;
    if (parts_ <= kMaxParts) return Ok();
    return InputError(file_ + " has at least " + std::to_string(parts_) + " morph targets and attributes of deformed " +
                      "meshes, each node counted; expected at most " + std::to_string(kMaxParts) +
                      ": simplify the scene");
  }

  // Takes one weight from the budget for each target of a node's mesh, also for targets without effect.
  Status TakeTargets(int mesh) {
    const std::vector<tinygltf::Primitive>& primitives = model_.meshes[std::size_t(mesh)].primitives;
    return primitives.empty() ? Ok() : TakeParts(primitives[0].targets.size());
  }

  // Takes a mesh from the budget before it is read for one more node, which gets a copy: its primitives, also those
  // that will be left out, and their attributes, also empty ones. All are visited for each node.
  Status TakeDeformed(int mesh, bool with_targets) {
    for (const tinygltf::Primitive& primitive : model_.meshes[std::size_t(mesh)].primitives) {
      SCUMBLE_RETURN_IF_ERROR(budget_.TakeInstance(file_, Mesh(), true));
      std::uint64_t parts = primitive.attributes.size();
      if (with_targets) {
        for (const std::map<std::string, int>& target : primitive.targets) parts += 1 + target.size();
      }
      SCUMBLE_RETURN_IF_ERROR(TakeParts(parts));
    }
    return Ok();
  }

  // Takes a mesh's elements without data from the budget before it is read: those of all its primitives, and of their
  // morph targets where those are read too.
  Status TakeZeros(int mesh, bool with_targets) {
    for (const tinygltf::Primitive& primitive : model_.meshes[std::size_t(mesh)].primitives) {
      SCUMBLE_RETURN_IF_ERROR(zeros_.Take(model_, file_, primitive.indices));
      for (const auto& [name, accessor] : primitive.attributes) {
        SCUMBLE_RETURN_IF_ERROR(zeros_.Take(model_, file_, accessor));
      }
      if (!with_targets) continue;
      for (const std::map<std::string, int>& target : primitive.targets) {
        for (const auto& [name, accessor] : target) {
          SCUMBLE_RETURN_IF_ERROR(zeros_of_targets_.Take(model_, file_, accessor));
        }
      }
    }
    return Ok();
  }

  void AddInstance(RigInstance instance) {
    if (!Flattens(instance.instance.world_from_object)) scene_.instances.push_back(instance.instance);
    rig_.instances.push_back(std::move(instance));
  }

  // The weights of the node's morph targets at rest: its own, its mesh's, or zeros.
  Expected<std::vector<double>> MorphWeights(int index) const {
    const tinygltf::Node& node = model_.nodes[std::size_t(index)];
    const tinygltf::Mesh& mesh = model_.meshes[std::size_t(node.mesh)];
    const std::size_t targets = mesh.primitives.empty() ? 0 : mesh.primitives[0].targets.size();
    const std::vector<double>& given = node.weights.empty() ? mesh.weights : node.weights;
    if (given.empty() || targets == 0) return std::vector<double>(targets, 0.0);
    const auto bad = [&](const std::string& what) {
      return InputError(file_ + ": " + Label(index) + " " + what + ": export it again");
    };
    if (given.size() != targets) {
      return bad("has " + std::to_string(given.size()) + " morph weights for " + std::to_string(targets) +
                 " targets; expected as many");
    }
    for (double weight : given) {
      if (!std::isfinite(weight)) return bad("has a morph weight that is NaN or infinite");
    }
    return given;
  }

  Status LoadDeformed(int index, Instance instance, const std::vector<double>& weights) {
    const tinygltf::Node& node = model_.nodes[std::size_t(rig_.nodes[std::size_t(index)].node)];
    int skin = -1;
    if (node.skin >= 0) {
      SCUMBLE_ASSIGN(skin, LoadSkin(node.skin));
    }
    SCUMBLE_RETURN_IF_ERROR(TakeDeformed(node.mesh, !weights.empty()));
    SCUMBLE_RETURN_IF_ERROR(TakeZeros(node.mesh, !weights.empty()));
    DeformationRequest request;
    request.joints = skin < 0 ? 0 : rig_.skins[std::size_t(skin)].joints.size();
    request.targets = weights.size();
    SCUMBLE_ASSIGN(
        std::vector<DeformableMesh> loaded,
        LoadDeformableMesh({model_, file_, scene_, budget_, warnings_, choice_, missing_}, node.mesh, request));
    for (DeformableMesh& mesh : loaded) {
      instance.mesh = mesh.mesh;
      const bool skinned = mesh.deformation.influences > 0;
      AddInstance({instance, index, static_cast<int>(rig_.meshes.size())});
      rig_.meshes.push_back({mesh.mesh, index, skinned ? skin : -1, std::move(mesh.deformation), weights});
    }
    return Ok();
  }

  // The skin's index in the rig. Skins are few, and each is read once.
  Expected<int> LoadSkin(int index) {
    const auto [known, is_new] = loaded_skins_.try_emplace(index, static_cast<int>(rig_.skins.size()));
    if (!is_new) return known->second;
    SCUMBLE_RETURN_IF_ERROR(CheckInverseBinds(index));
    SCUMBLE_ASSIGN(GltfSkin skin, ReadSkin(model_, file_, index));
    skin.inverse_bind.resize(skin.joints.size());
    skin.inverse_bind.shrink_to_fit();
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
      const auto joint = rig_node_of_.find(skin.joints[i]);
      if (joint == rig_node_of_.end()) {
        return InputError(file_ + ": " + skin.name + ", joint " + std::to_string(i) + " is node " +
                          std::to_string(skin.joints[i]) + ", which is not in the scene: export it again");
      }
      skin.joints[i] = joint->second;
    }
    rig_.skins.push_back(std::move(skin));
    return known->second;
  }

  // Checked before they are read: skins may share one list of any length.
  Status CheckInverseBinds(int index) const {
    if (index < 0 || std::size_t(index) >= model_.skins.size()) return Ok();  // ReadSkin reports it
    const tinygltf::Skin& skin = model_.skins[std::size_t(index)];
    const int accessor = skin.inverseBindMatrices;
    if (accessor < 0 || std::size_t(accessor) >= model_.accessors.size()) return Ok();
    const std::size_t matrices = model_.accessors[std::size_t(accessor)].count;
    if (matrices <= skin.joints.size() + kMaxSpareMatrices) return Ok();
    return InputError(file_ + ": skin " + std::to_string(index) + " has " + std::to_string(matrices) +
                      " inverse bind matrices for " + std::to_string(skin.joints.size()) +
                      " joints; expected as many: export it again");
  }

  // Fails for a scene of points and lines alone, which would be an empty picture.
  Status CheckHasTriangles() const {
    if (!rig_.instances.empty()) return Ok();
    std::uint64_t points = 0;
    bool has_lines = false;
    std::set<int> seen;
    for (const RigNode& visit : rig_.nodes) {
      const int mesh = model_.nodes[std::size_t(visit.node)].mesh;
      if (mesh < 0 || visit.is_hidden || !seen.insert(mesh).second) continue;
      for (const tinygltf::Primitive& primitive : model_.meshes[std::size_t(mesh)].primitives) {
        const auto position = primitive.attributes.find("POSITION");
        const bool is_drawn = primitive.mode >= TINYGLTF_MODE_TRIANGLES || position == primitive.attributes.end();
        if (is_drawn || position->second < 0 || std::size_t(position->second) >= model_.accessors.size()) continue;
        points += model_.accessors[std::size_t(position->second)].count;
        has_lines |= primitive.mode != TINYGLTF_MODE_POINTS;
      }
    }
    return points == 0 ? Ok() : Status(NoTrianglesError(file_, points, has_lines ? ", lines" : ""));
  }

  // Every key of an animated mesh must have as many weights as there are targets.
  Status CheckAnimatedWeights() const {
    for (const RigMesh& mesh : rig_.meshes) {
      const int node = rig_.nodes[std::size_t(mesh.node)].node;
      if (!rig_.animation.Morphs(node)) continue;
      const std::size_t animated = rig_.animation.MorphWeights(node, 0.0).size();
      if (animated == mesh.weights.size()) continue;
      return InputError(file_ + ": the animation of " + Label(node) + " has " + std::to_string(animated) +
                        " morph weights a key for " + std::to_string(mesh.weights.size()) +
                        " targets; expected as many: export it again");
    }
    return Ok();
  }

  void WarnOfIgnoredParts() {
    if (!model_.animations.empty() && !animation_) {
      warnings_.Add("animations are not played without a frame's number, the scene is seen as its nodes stand",
                    std::to_string(model_.animations.size()) + " in the file");
    }
  }

  const std::string file_;
  const std::optional<std::string> animation_;
  MissingNormals missing_;
  tinygltf::Model model_;
  Scene scene_;
  GeometryBudget budget_;
  ElementChoice choice_;
  std::uint64_t parts_ = 0;
  ZeroBudget zeros_{kMaxZeroElements};
  ZeroBudget zeros_of_targets_{kMaxZerosOfTargets};
  WarningCounter warnings_;
  GltfRig rig_;
  UniqueNames copy_names_;
  bool has_copies_ = false;
  std::uint64_t bytes_of_copies_ = 0;
  std::vector<std::string> names_;  // of the object at each visit; empty where none is seen
  std::map<int, std::vector<int>> loaded_meshes_;
  std::map<int, int> loaded_skins_;
  std::unordered_map<int, int> rig_node_of_;  // by the node in the file
  UniqueNames camera_names_;
};

}  // namespace

Expected<Scene> LoadGltfScene(const std::filesystem::path& path, MissingNormals missing, const FileListener& on_file) {
  SCUMBLE_ASSIGN(MovingScene loaded, GltfLoader(path.string(), std::nullopt, missing).Load(path, on_file));
  return std::move(loaded.scene);
}

Expected<MovingScene> LoadMovingGltfScene(const std::filesystem::path& path, const std::string& animation,
                                          MissingNormals missing, const FileListener& on_file) {
  return GltfLoader(path.string(), animation, missing).Load(path, on_file);
}

}  // namespace scumble
