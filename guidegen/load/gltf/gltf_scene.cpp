#include "guidegen/load/gltf/gltf_scene.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <unordered_map>

#include "guidegen/load/gltf/accessor.h"
#include "guidegen/load/gltf/materials.h"
#include "guidegen/load/gltf/meshes.h"
#include "guidegen/load/gltf/parse.h"
#include "guidegen/load/gltf/gltf_extras.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/scene/matrix_util.h"

namespace scumble {
namespace {

constexpr int kMaxNodeDepth = 1024;
// Of objects, cameras and lights, wherever one is kept: as many instances as there may be, with names of 500 bytes.
constexpr std::uint64_t kMaxNameBytes = std::uint64_t(1) << 29;
// Morph targets are what exporters write without data: 100 that do nothing to the positions and normals of 100,000 vertices
// are 20 million.
constexpr std::uint64_t kMaxZerosOfTargets = 4 * kMaxZeroElements;
// Counted for each node. 100,000 meshes of 150 targets with three attributes have 60 million; the vertices of all those targets
// come to more than their own limit long before.
constexpr std::uint64_t kMaxParts = 64'000'000;
// Skins have as many inverse bind matrices as joints; more are allowed, and not looked at.
constexpr std::size_t kMaxSpareMatrices = 1024;
constexpr double kLumensPerWatt = 683.0;
constexpr double kDegreesPerRadian = 180.0 / 3.14159265358979323846;

// Extensions that a file may require: those read here, in part if need be, and those that change only shading that no guide
// holds.
bool IsKnownExtension(std::string_view name) {
  constexpr std::string_view kKnown[] = {"KHR_lights_punctual", "KHR_texture_transform", "KHR_mesh_quantization",
                                         "EXT_texture_webp"};
  for (std::string_view known : kKnown) {
    if (name == known) return true;
  }
  return name.rfind("KHR_materials_", 0) == 0;
}

class GltfLoader {
 public:
  // `animation` as in AnimationOptions; without one the scene is seen at rest.
  GltfLoader(std::string file, std::optional<std::string> animation)
      : file_(std::move(file)), animation_(std::move(animation)) {}

  Expected<MovingScene> Load(const std::filesystem::path& path) {
    SCUMBLE_RETURN_IF_ERROR(ParseGltf(path, model_, warnings_));
    SCUMBLE_RETURN_IF_ERROR(CheckVersionAndExtensions());
    SCUMBLE_RETURN_IF_ERROR(LoadGltfMaterials(model_, file_, scene_, warnings_));
    SCUMBLE_RETURN_IF_ERROR(ReadMaterialExtras(model_, file_, scene_));
    ShareDefaultMaterial();
    SCUMBLE_RETURN_IF_ERROR(ReadSceneExtras(model_, std::max(model_.defaultScene, 0), file_, scene_));
    rig_.file = file_;
    if (animation_) {
      SCUMBLE_ASSIGN(rig_.animation, GltfAnimation::Read(model_, file_, *animation_, warnings_));
    }
    SCUMBLE_ASSIGN(const std::vector<int> roots, ChooseRoots());
    SCUMBLE_RETURN_IF_ERROR(WalkNodes(roots));
    SCUMBLE_RETURN_IF_ERROR(NameObjects());
    for (std::size_t i = 0; i < rig_.nodes.size(); ++i) SCUMBLE_RETURN_IF_ERROR(LoadNode(i));
    SCUMBLE_RETURN_IF_ERROR(CheckAnimatedWeights());
    if (!rig_.meshes.empty()) SCUMBLE_RETURN_IF_ERROR(rig_.Pose(std::nullopt, scene_));
    WarnOfIgnoredParts();
    warnings_.MoveTo(scene_.warnings);
    return MovingScene{std::move(scene_), std::move(rig_), AnimationNames(model_)};
  }

 private:
  std::string NodeLabel(int node) const {
    const std::string& name = model_.nodes[std::size_t(node)].name;
    return "node " + std::to_string(node) + (name.empty() ? "" : " '" + Excerpt(name, 80) + "'");
  }

  std::string NodeName(int node) const {
    const std::string& name = model_.nodes[std::size_t(node)].name;
    return name.empty() ? "node_" + std::to_string(node) : name;
  }

  Status CheckVersionAndExtensions() const {
    if (model_.asset.version.rfind("2.", 0) != 0) {
      return InputError(file_ + " is glTF version '" + Excerpt(model_.asset.version, 40) +
                        "'; expected 2.0, export it as glTF 2.0");
    }
    std::string unknown;
    for (const std::string& name : model_.extensionsRequired) {
      if (!IsKnownExtension(name)) unknown += (unknown.empty() ? "" : ", ") + Excerpt(name, 80);
    }
    if (unknown.empty()) return Ok();
    return InputError(file_ + " requires " + unknown + ", which cannot be read: export it without (for Draco or " +
                      "meshopt: switch compression off)");
  }

  // A default of the file's own may stand anywhere in its list: looked for anew for each primitive without a material, that
  // would take the square of what the file holds. One that is made stands at the end, and is found at once.
  void ShareDefaultMaterial() {
    const int shared = FindDefaultMaterial(scene_);
    if (shared < 0) return;
    for (tinygltf::Mesh& mesh : model_.meshes) {
      for (tinygltf::Primitive& primitive : mesh.primitives) {
        if (primitive.material < 0) primitive.material = shared;
      }
    }
  }

  Expected<std::vector<int>> ChooseRoots() {
    if (model_.scenes.empty()) {
      std::vector<bool> is_child(model_.nodes.size(), false);
      for (const tinygltf::Node& node : model_.nodes) {
        for (int child : node.children) {
          if (child >= 0 && std::size_t(child) < is_child.size()) is_child[std::size_t(child)] = true;
        }
      }
      std::vector<int> roots;
      for (std::size_t i = 0; i < is_child.size(); ++i) {
        if (!is_child[i]) roots.push_back(static_cast<int>(i));
      }
      return roots;
    }
    const int chosen = model_.defaultScene < 0 ? 0 : model_.defaultScene;
    if (std::size_t(chosen) >= model_.scenes.size()) {
      return InputError(file_ + " names scene " + std::to_string(chosen) + " as its own, but has " +
                        std::to_string(model_.scenes.size()) + ": export it again");
    }
    const tinygltf::Scene& scene = model_.scenes[std::size_t(chosen)];
    if (model_.scenes.size() > 1) {
      warnings_.Add("only one of the " + std::to_string(model_.scenes.size()) + " scenes in the file is loaded",
                    scene.name.empty() ? "scene " + std::to_string(chosen) : "'" + Excerpt(scene.name, 80) + "'");
    }
    return scene.nodes;
  }

  // Depth first, in the file's order, without recursion: the depth is the file's to choose.
  Status WalkNodes(const std::vector<int>& roots) {
    std::vector<bool> seen(model_.nodes.size(), false);
    std::vector<RigNode> stack;
    for (std::size_t i = roots.size(); i-- > 0;) stack.push_back({.node = roots[i]});
    while (!stack.empty()) {
      RigNode visit = stack.back();
      stack.pop_back();
      if (visit.node < 0 || std::size_t(visit.node) >= model_.nodes.size()) {
        return InputError(file_ + ": node " + std::to_string(visit.node) + " does not exist, the file has " +
                          std::to_string(model_.nodes.size()) + ": export it again");
      }
      if (seen[std::size_t(visit.node)]) {
        return InputError(file_ + ": " + NodeLabel(visit.node) + " is reached twice; nodes must form a tree, without " +
                          "cycles and with one parent each");
      }
      if (visit.depth > kMaxNodeDepth) {
        return InputError(file_ + ": nodes are nested more than " + std::to_string(kMaxNodeDepth) + " levels deep");
      }
      seen[std::size_t(visit.node)] = true;
      SCUMBLE_ASSIGN(visit.local, LocalTransform(visit.node));
      visit.world = visit.world * visit.local;
      if (!IsFinite(visit.world))
        return InputError(file_ + ": " + NodeLabel(visit.node) + " has an infinite transform");
      if (rig_.animation.Moves(visit.node)) {
        visit.moves = true;
        visit.pose = RestPose(visit.node);
      }
      const int index = static_cast<int>(rig_.nodes.size());
      rig_node_of_[visit.node] = index;
      rig_.nodes.push_back(visit);
      const std::vector<int>& children = model_.nodes[std::size_t(visit.node)].children;
      for (std::size_t i = children.size(); i-- > 0;) {
        stack.push_back({.node = children[i],
                         .parent = index,
                         .depth = visit.depth + 1,
                         .moves = visit.moves,
                         .world = visit.world});
      }
    }
    return Ok();
  }

  Expected<glm::dmat4> LocalTransform(int index) const {
    const tinygltf::Node& node = model_.nodes[std::size_t(index)];
    const auto bad = [&](const char* what) {
      return InputError(file_ + ": " + NodeLabel(index) + " has " + what + ": export it again");
    };
    const auto fits = [](const std::vector<double>& list, std::size_t count) {
      return list.empty() || list.size() == count;
    };
    if (!fits(node.matrix, 16)) return bad("a matrix that is not 16 numbers");
    if (!fits(node.translation, 3)) return bad("a translation that is not 3 numbers");
    if (!fits(node.rotation, 4)) return bad("a rotation that is not 4 numbers");
    if (!fits(node.scale, 3)) return bad("a scale that is not 3 numbers");
    glm::dmat4 local(1.0);
    if (!node.matrix.empty()) {
      for (int i = 0; i < 16; ++i) local[i / 4][i % 4] = node.matrix[std::size_t(i)];
      if (local[0][3] != 0.0 || local[1][3] != 0.0 || local[2][3] != 0.0 || local[3][3] != 1.0) {
        return bad("a matrix with a projective part");
      }
      return local;
    }
    if (!node.translation.empty()) {
      local = glm::translate(local, glm::dvec3(node.translation[0], node.translation[1], node.translation[2]));
    }
    if (!node.rotation.empty()) {
      const glm::dquat q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
      const double length = glm::length(q);
      if (!(length > 0.0) || !std::isfinite(length)) return bad("a rotation of zero length");
      local = local * glm::mat4_cast(q / length);
    }
    if (!node.scale.empty()) local = glm::scale(local, glm::dvec3(node.scale[0], node.scale[1], node.scale[2]));
    return local;
  }

  // Of a node without a matrix that LocalTransform has accepted.
  NodePose RestPose(int index) const {
    const tinygltf::Node& node = model_.nodes[std::size_t(index)];
    NodePose pose;
    if (!node.translation.empty()) {
      pose.translation = glm::dvec3(node.translation[0], node.translation[1], node.translation[2]);
    }
    if (!node.rotation.empty()) {
      pose.rotation =
          glm::normalize(glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]));
    }
    if (!node.scale.empty()) pose.scale = glm::dvec3(node.scale[0], node.scale[1], node.scale[2]);
    return pose;
  }

  // Ids are hashes of names, so objects of one name would be one object. The first node of a name, by its place in the
  // file's list, keeps it whatever comes later; the others take their whole path.
  Status NameObjects() {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < rig_.nodes.size(); ++i) {
      if (model_.nodes[std::size_t(rig_.nodes[i].node)].mesh >= 0) order.push_back(i);
    }
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return rig_.nodes[a].node < rig_.nodes[b].node; });
    names_.resize(rig_.nodes.size());
    UniqueNames unique;
    std::set<std::string> plain;
    std::vector<std::size_t> later;
    for (std::size_t i : order) {
      const std::string name = NodeName(rig_.nodes[i].node);
      if (plain.insert(name).second) {
        names_[i] = unique.Take(name);
      } else {
        later.push_back(i);
      }
    }
    SCUMBLE_RETURN_IF_ERROR(CheckNames(later));
    for (std::size_t i : later) names_[i] = unique.Take(PathOf(i));
    return Ok();
  }

  std::string PathOf(std::size_t index) const {
    std::vector<int> nodes;
    for (int at = static_cast<int>(index); at >= 0; at = rig_.nodes[std::size_t(at)].parent) {
      nodes.push_back(rig_.nodes[std::size_t(at)].node);
    }
    std::string path = NodeName(nodes.back());
    for (std::size_t i = nodes.size() - 1; i-- > 0;) path += "/" + NodeName(nodes[i]);
    return path;
  }

  // A name is in the file once and kept many times: with each primitive of a mesh, in the path of each node below, by each
  // node that shows one camera or light. So names are counted before the paths are made, which nodes `with_path` get.
  Status CheckNames(const std::vector<std::size_t>& with_path) const {
    std::vector<bool> has_path(rig_.nodes.size(), false);
    for (std::size_t i : with_path) has_path[i] = true;
    std::vector<std::uint64_t> path_bytes;  // parents stand before their children
    std::uint64_t bytes = 0;
    for (const RigNode& visit : rig_.nodes) {
      const tinygltf::Node& node = model_.nodes[std::size_t(visit.node)];
      const std::uint64_t own = NodeName(visit.node).size();
      path_bytes.push_back(visit.parent < 0 ? own : path_bytes[std::size_t(visit.parent)] + 1 + own);
      if (node.mesh >= 0 && std::size_t(node.mesh) < model_.meshes.size()) {
        const std::uint64_t one = has_path[path_bytes.size() - 1] ? path_bytes.back() : own;
        bytes += one * std::max<std::uint64_t>(model_.meshes[std::size_t(node.mesh)].primitives.size(), 1);
      }
      if (node.name.empty()) bytes += NameBytesOf(model_.cameras, node.camera);
      if (node.name.empty()) bytes += NameBytesOf(model_.lights, LightOf(node).value_or(-1));
      if (bytes > kMaxNameBytes) {
        return InputError(file_ + ": the names of its objects, cameras and lights come to more than " +
                          std::to_string(kMaxNameBytes) + " bytes, at " + NodeLabel(visit.node) + "; where a name is " +
                          "taken, the path counts: give shorter names, or each object one of its own");
      }
    }
    return Ok();
  }

  template <class Named>
  static std::uint64_t NameBytesOf(const std::vector<Named>& list, int index) {
    return index >= 0 && std::size_t(index) < list.size() ? list[std::size_t(index)].name.size() : 0;
  }

  // The light that KHR_lights_punctual gives a node.
  static std::optional<int> LightOf(const tinygltf::Node& node) {
    const auto light = node.extensions.find("KHR_lights_punctual");
    if (light == node.extensions.end() || !light->second.Has("light")) return std::nullopt;
    if (!light->second.Get("light").IsInt()) return std::nullopt;
    return light->second.Get("light").GetNumberAsInt();
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
    if (node.mesh >= 0) SCUMBLE_RETURN_IF_ERROR(LoadInstances(index));
    if (node.camera >= 0) {
      SCUMBLE_RETURN_IF_ERROR(LoadCamera(visit));
      rig_.camera_nodes.push_back(static_cast<int>(index));
    }
    SCUMBLE_ASSIGN(const std::optional<Light> from_blender, ReadLightExtras(node, file_ + ": " + NodeLabel(visit.node)));
    if (from_blender) return PlaceLight(visit, *from_blender);
    const std::optional<int> light = LightOf(node);
    return light ? LoadLight(visit, *light) : Ok();
  }

  Status LoadInstances(std::size_t index) {
    const RigNode& visit = rig_.nodes[index];
    const tinygltf::Node& node = model_.nodes[std::size_t(visit.node)];
    if (std::size_t(node.mesh) >= model_.meshes.size()) {
      return InputError(file_ + ": " + NodeLabel(visit.node) + " uses mesh " + std::to_string(node.mesh) +
                        ", the file has " + std::to_string(model_.meshes.size()) + ": export it again");
    }
    if (node.extensions.count("EXT_mesh_gpu_instancing") > 0) {
      warnings_.Add("EXT_mesh_gpu_instancing is ignored, such a mesh is seen once", NodeLabel(visit.node));
    }
    // A skeleton places its mesh anew, and an animation may give it back what flattens it at rest.
    if (Flattens(visit.world) && !visit.moves && node.skin < 0) {
      warnings_.Add("objects that their transform flattens are left out", NodeLabel(visit.node));
      return Ok();
    }
    Instance instance{names_[index], 0, visit.world};
    SCUMBLE_RETURN_IF_ERROR(ReadObjectExtras(node, file_ + ": " + NodeLabel(visit.node), instance));
    SCUMBLE_RETURN_IF_ERROR(TakeTargets(node.mesh));
    SCUMBLE_ASSIGN(const std::vector<double> weights, MorphWeights(visit.node));
    const bool morphs = rig_.animation.Morphs(visit.node) ||
                        std::any_of(weights.begin(), weights.end(), [](double weight) { return weight != 0.0; });
    if (node.skin >= 0 || morphs) {
      return LoadDeformed(static_cast<int>(index), std::move(instance), morphs ? weights : std::vector<double>());
    }
    const auto [loaded, is_new] = loaded_meshes_.try_emplace(node.mesh);
    if (is_new) {
      SCUMBLE_RETURN_IF_ERROR(TakeZeros(node.mesh, false));
      SCUMBLE_ASSIGN(loaded->second, LoadGltfMesh({model_, file_, scene_, budget_, warnings_, choice_}, node.mesh));
    }
    for (int mesh : loaded->second) {
      SCUMBLE_RETURN_IF_ERROR(budget_.TakeInstance(file_, scene_.meshes[std::size_t(mesh)], is_new));
      instance.mesh = mesh;
      AddInstance({instance, static_cast<int>(index), -1});
    }
    return Ok();
  }

  Status TakeParts(std::uint64_t more) {
    parts_ += more;
    if (parts_ <= kMaxParts) return Ok();
    return InputError(file_ + " has at least " + std::to_string(parts_) + " morph targets and attributes of deformed " +
                      "meshes, each node counted; expected at most " + std::to_string(kMaxParts) +
                      ": simplify the scene");
  }

  // Each node has a weight for each target of its mesh, also where that does nothing.
  Status TakeTargets(int mesh) {
    const std::vector<tinygltf::Primitive>& primitives = model_.meshes[std::size_t(mesh)].primitives;
    return primitives.empty() ? Ok() : TakeParts(primitives[0].targets.size());
  }

  // Before a mesh is read for one more node, which has it for itself: its primitives, those among them that will be left
  // out, and what each consists of, however empty that is. It is all looked through for each node.
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

  // Before a mesh is read, what it has of elements without data: all its primitives', and their morph targets' where those
  // are read too.
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
      return InputError(file_ + ": " + NodeLabel(index) + " " + what + ": export it again");
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
    SCUMBLE_ASSIGN(std::vector<DeformableMesh> loaded,
                   LoadDeformableMesh({model_, file_, scene_, budget_, warnings_, choice_}, node.mesh, request));
    for (DeformableMesh& mesh : loaded) {
      instance.mesh = mesh.mesh;
      const bool skinned = mesh.deformation.influences > 0;
      AddInstance({instance, index, static_cast<int>(rig_.meshes.size())});
      rig_.meshes.push_back({mesh.mesh, index, skinned ? skin : -1, std::move(mesh.deformation), weights});
    }
    return Ok();
  }

  // The skin's place in the rig. Skins are few, and each is read once.
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

  // Before they are read: skins may share one list of any length.
  Status CheckInverseBinds(int index) const {
    if (index < 0 || std::size_t(index) >= model_.skins.size()) return Ok();  // ReadSkin says so
    const tinygltf::Skin& skin = model_.skins[std::size_t(index)];
    const int accessor = skin.inverseBindMatrices;
    if (accessor < 0 || std::size_t(accessor) >= model_.accessors.size()) return Ok();
    const std::size_t matrices = model_.accessors[std::size_t(accessor)].count;
    if (matrices <= skin.joints.size() + kMaxSpareMatrices) return Ok();
    return InputError(file_ + ": skin " + std::to_string(index) + " has " + std::to_string(matrices) +
                      " inverse bind matrices for " + std::to_string(skin.joints.size()) +
                      " joints; expected as many: export it again");
  }

  // Every key of an animated mesh must have as many weights as there are targets.
  Status CheckAnimatedWeights() const {
    for (const RigMesh& mesh : rig_.meshes) {
      const int node = rig_.nodes[std::size_t(mesh.node)].node;
      if (!rig_.animation.Morphs(node)) continue;
      const std::size_t animated = rig_.animation.MorphWeights(node, 0.0).size();
      if (animated == mesh.weights.size()) continue;
      return InputError(file_ + ": the animation of " + NodeLabel(node) + " has " + std::to_string(animated) +
                        " morph weights a key for " + std::to_string(mesh.weights.size()) +
                        " targets; expected as many: export it again");
    }
    return Ok();
  }

  Status LoadCamera(const RigNode& visit) {
    const int index = model_.nodes[std::size_t(visit.node)].camera;
    const auto bad = [&](const std::string& what) {
      return InputError(file_ + ": the camera of " + NodeLabel(visit.node) + " " + what + ": export it again");
    };
    if (std::size_t(index) >= model_.cameras.size()) return bad("does not exist");
    const tinygltf::Camera& from = model_.cameras[std::size_t(index)];
    Camera camera;
    camera.name = model_.nodes[std::size_t(visit.node)].name;
    if (camera.name.empty()) camera.name = from.name.empty() ? "camera_" + std::to_string(index) : from.name;
    camera.name = camera_names_.Take(camera.name);
    camera.orthographic = from.type == "orthographic";
    if (camera.orthographic) {
      const auto& lens = from.orthographic;
      camera.ymag = std::abs(lens.ymag);
      camera.aspect = std::abs(lens.xmag) / camera.ymag;
      camera.z_near = lens.znear;
      camera.z_far = lens.zfar;
      if (!(camera.ymag > 0.0) || !std::isfinite(camera.ymag)) return bad("has a height of zero");
    } else {
      const auto& lens = from.perspective;
      camera.yfov_degrees = lens.yfov * kDegreesPerRadian;
      if (lens.aspectRatio != 0.0) camera.aspect = lens.aspectRatio;
      camera.z_near = lens.znear;
      if (lens.zfar != 0.0) camera.z_far = lens.zfar;
      if (!(camera.yfov_degrees > 0.0) || !(camera.yfov_degrees < 180.0)) {
        return bad("has a vertical angle of " + std::to_string(camera.yfov_degrees) + "°, expected 0 … 180");
      }
    }
    if (camera.aspect && (!(*camera.aspect > 0.0) || !std::isfinite(*camera.aspect))) return bad("has no proportions");
    if (!(camera.z_near >= 0.0) || !(camera.z_far > camera.z_near)) return bad("has its far plane before its near one");
    const std::optional<glm::dmat4> world = WithoutScale(visit.world);
    if (!world) return bad("is scaled or sheared until it has no direction");
    SCUMBLE_RETURN_IF_ERROR(
        ReadCameraExtras(model_.nodes[std::size_t(visit.node)], file_ + ": " + NodeLabel(visit.node), camera));
    camera.world_from_camera = *world;
    scene_.cameras.push_back(std::move(camera));
    return Ok();
  }

  Status LoadLight(const RigNode& visit, int index) {
    const auto bad = [&](const std::string& what) {
      return InputError(file_ + ": the light of " + NodeLabel(visit.node) + " " + what + ": export it again");
    };
    if (index < 0 || std::size_t(index) >= model_.lights.size()) return bad("does not exist");
    const tinygltf::Light& from = model_.lights[std::size_t(index)];
    Light light;
    light.name = from.name.empty() ? "light_" + std::to_string(index) : from.name;
    if (from.type == "directional") {
      light.type = LightType::kSun;
    } else if (from.type == "spot") {
      light.type = LightType::kSpot;
    } else if (from.type != "point") {
      return bad("is of the unknown type '" + Excerpt(from.type, 40) + "'");
    }
    if (!from.color.empty()) {
      if (from.color.size() != 3) return bad("has a colour that is not 3 numbers");
      light.color = glm::vec3(from.color[0], from.color[1], from.color[2]);
    }
    light.intensity = from.intensity / kLumensPerWatt;
    if (light.type != LightType::kSun && from.range > 0.0) {
      warnings_.Add("the range of lights is ignored, they reach as far as physics has it", NodeLabel(visit.node));
    }
    if (!IsFinite(light.color) || glm::any(glm::lessThan(light.color, glm::vec3(0.0f))))
      return bad("has a wrong colour");
    if (!std::isfinite(light.intensity) || light.intensity < 0.0) return bad("has a wrong intensity");
    light.inner_cone_degrees = from.spot.innerConeAngle * kDegreesPerRadian;
    light.outer_cone_degrees = from.spot.outerConeAngle * kDegreesPerRadian;
    if (light.type == LightType::kSpot &&
        !(light.inner_cone_degrees >= 0.0 && light.outer_cone_degrees <= 90.0 + 1e-6 &&
          light.inner_cone_degrees <= light.outer_cone_degrees)) {
      return bad("has wrong cone angles");
    }
    return PlaceLight(visit, std::move(light));
  }

  // Appends a light at its node, whose name it takes if there is one.
  Status PlaceLight(const RigNode& visit, Light light) {
    const std::string& name = model_.nodes[std::size_t(visit.node)].name;
    if (!name.empty()) light.name = name;
    const std::optional<glm::dmat4> world = WithoutScale(visit.world);
    if (!world) {
      return InputError(file_ + ": the light of " + NodeLabel(visit.node) +
                        " is scaled or sheared until it has no direction: export it again");
    }
    light.world_from_light = *world;
    scene_.lights.push_back(std::move(light));
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
  tinygltf::Model model_;
  Scene scene_;
  GeometryBudget budget_;
  ElementChoice choice_;
  std::uint64_t parts_ = 0;
  ZeroBudget zeros_{kMaxZeroElements};
  ZeroBudget zeros_of_targets_{kMaxZerosOfTargets};
  WarningCounter warnings_;
  GltfRig rig_;
  std::vector<std::string> names_;  // of the object at each visit; empty where there is no mesh
  std::map<int, std::vector<int>> loaded_meshes_;
  std::map<int, int> loaded_skins_;
  std::unordered_map<int, int> rig_node_of_;  // by the node in the file
  UniqueNames camera_names_;
};

}  // namespace

Expected<Scene> LoadGltfScene(const std::filesystem::path& path) {
  SCUMBLE_ASSIGN(MovingScene loaded, GltfLoader(path.string(), std::nullopt).Load(path));
  return std::move(loaded.scene);
}

Expected<MovingScene> LoadMovingGltfScene(const std::filesystem::path& path, const std::string& animation) {
  return GltfLoader(path.string(), animation).Load(path);
}

}  // namespace scumble
