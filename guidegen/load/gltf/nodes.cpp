#include "guidegen/load/gltf/nodes.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <set>

#include "guidegen/scene/matrix_util.h"

namespace scumble {
namespace {

constexpr int kMaxNodeDepth = 1024;
// Bytes of names of objects, cameras and lights, for each copy: as many as the largest number of instances with names
// of 500 bytes.
constexpr std::uint64_t kMaxNameBytes = std::uint64_t(1) << 29;

std::string NodeName(const tinygltf::Model& model, int node) {
  const std::string& name = model.nodes[std::size_t(node)].name;
  return name.empty() ? "node_" + std::to_string(node) : name;
}

bool IsHidden(const tinygltf::Node& node) {
  const auto found = node.extensions.find("KHR_node_visibility");
  if (found == node.extensions.end() || !found->second.Has("visible")) return false;
  const tinygltf::Value& visible = found->second.Get("visible");
  return visible.IsBool() && !visible.Get<bool>();
}

class NodeReader {
 public:
  NodeReader(const tinygltf::Model& model, const std::string& file, const GltfAnimation& animation,
             WarningCounter& warnings)
      : model_(model), file_(file), animation_(animation), warnings_(warnings) {}

  Expected<std::vector<RigNode>> Read() {
    SCUMBLE_ASSIGN(const std::vector<int> roots, ChooseRoots());
    SCUMBLE_RETURN_IF_ERROR(WalkNodes(roots));
    return std::move(nodes_);
  }

 private:
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

  // Depth first, in the file's order, without recursion: the file sets the depth.
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
        return InputError(file_ + ": " + NodeLabel(model_, visit.node) +
                          " is reached twice; nodes must form a tree, without " + "cycles and with one parent each");
      }
      if (visit.depth > kMaxNodeDepth) {
        return InputError(file_ + ": nodes are nested more than " + std::to_string(kMaxNodeDepth) + " levels deep");
      }
      seen[std::size_t(visit.node)] = true;
      SCUMBLE_ASSIGN(visit.local, LocalTransform(visit.node));
      visit.world = visit.world * visit.local;
      if (!IsFinite(visit.world))
        return InputError(file_ + ": " + NodeLabel(model_, visit.node) + " has an infinite transform");
      if (animation_.Moves(visit.node)) {
        visit.moves = true;
        visit.pose = RestPose(visit.node);
      }
      visit.is_hidden = visit.is_hidden || IsHidden(model_.nodes[std::size_t(visit.node)]);
      const int index = static_cast<int>(nodes_.size());
      nodes_.push_back(visit);
      const std::vector<int>& children = model_.nodes[std::size_t(visit.node)].children;
      for (std::size_t i = children.size(); i-- > 0;) {
        stack.push_back({.node = children[i],
                         .parent = index,
                         .depth = visit.depth + 1,
                         .moves = visit.moves,
                         .is_hidden = visit.is_hidden,
                         .world = visit.world});
      }
    }
    return Ok();
  }

  Expected<glm::dmat4> LocalTransform(int index) const {
    const tinygltf::Node& node = model_.nodes[std::size_t(index)];
    const auto bad = [&](const char* what) {
      return InputError(file_ + ": " + NodeLabel(model_, index) + " has " + what + ": export it again");
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

  // The pose of a node without a matrix that LocalTransform has accepted.
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

  const tinygltf::Model& model_;
  const std::string& file_;
  const GltfAnimation& animation_;
  WarningCounter& warnings_;
  std::vector<RigNode> nodes_;
};

class ObjectNamer {
 public:
  ObjectNamer(const tinygltf::Model& model, const std::string& file, const std::vector<RigNode>& nodes)
      : model_(model), file_(file), nodes_(nodes) {}

  // Ids are hashes of names, so objects of one name would be one object. The first node of a name in the file's list
  // keeps it; the others take their whole path.
  Expected<std::vector<std::string>> NameAll() const {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (model_.nodes[std::size_t(nodes_[i].node)].mesh >= 0 && !nodes_[i].is_hidden) order.push_back(i);
    }
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return nodes_[a].node < nodes_[b].node; });
    std::vector<std::string> names(nodes_.size());
    UniqueNames unique;
    std::set<std::string> plain;
    std::vector<std::size_t> later;
    for (std::size_t i : order) {
      const std::string name = NodeName(model_, nodes_[i].node);
      if (plain.insert(name).second) {
        names[i] = unique.Take(name);
      } else {
        later.push_back(i);
      }
    }
    SCUMBLE_RETURN_IF_ERROR(CheckNames(later));
    for (std::size_t i : later) names[i] = unique.Take(PathOf(i));
    return names;
  }

 private:
  std::string PathOf(std::size_t index) const {
    std::vector<int> nodes;
    for (int at = static_cast<int>(index); at >= 0; at = nodes_[std::size_t(at)].parent) {
      nodes.push_back(nodes_[std::size_t(at)].node);
    }
    std::string path = NodeName(model_, nodes.back());
    for (std::size_t i = nodes.size() - 1; i-- > 0;) path += "/" + NodeName(model_, nodes[i]);
    return path;
  }

  // A name is in the file once and kept many times: with each primitive of a mesh, in the path of each node below, with
  // each node of one camera or light. So the lengths of names are summed before the paths are made, which nodes
  // `with_path` get.
  Status CheckNames(const std::vector<std::size_t>& with_path) const {
    std::vector<bool> has_path(nodes_.size(), false);
    for (std::size_t i : with_path) has_path[i] = true;
    std::vector<std::uint64_t> path_bytes;  // parents stand before their children
    std::uint64_t bytes = 0;
    for (const RigNode& visit : nodes_) {
      const tinygltf::Node& node = model_.nodes[std::size_t(visit.node)];
      const std::uint64_t own = NodeName(model_, visit.node).size();
      path_bytes.push_back(visit.parent < 0 ? own : path_bytes[std::size_t(visit.parent)] + 1 + own);
      if (node.mesh >= 0 && std::size_t(node.mesh) < model_.meshes.size()) {
        const std::uint64_t one = has_path[path_bytes.size() - 1] ? path_bytes.back() : own;
        bytes += one * std::max<std::uint64_t>(model_.meshes[std::size_t(node.mesh)].primitives.size(), 1);
      }
      if (node.name.empty()) bytes += NameBytesOf(model_.cameras, node.camera);
      if (node.name.empty()) bytes += NameBytesOf(model_.lights, LightOf(node).value_or(-1));
      if (bytes > kMaxNameBytes) {
        return InputError(file_ + ": the names of its objects, cameras and lights come to more than " +
                          std::to_string(kMaxNameBytes) + " bytes, at " + NodeLabel(model_, visit.node) +
                          "; where a name is " +
                          "taken, the path counts: give shorter names, or each object one of its own");
      }
    }
    return Ok();
  }

  template <class Named>
  static std::uint64_t NameBytesOf(const std::vector<Named>& list, int index) {
    return index >= 0 && std::size_t(index) < list.size() ? list[std::size_t(index)].name.size() : 0;
  }

  const tinygltf::Model& model_;
  const std::string& file_;
  const std::vector<RigNode>& nodes_;
};

}  // namespace

std::string NodeLabel(const tinygltf::Model& model, int node) {
  const std::string& name = model.nodes[std::size_t(node)].name;
  return "node " + std::to_string(node) + (name.empty() ? "" : " '" + Excerpt(name, 80) + "'");
}

std::optional<int> LightOf(const tinygltf::Node& node) {
  const auto light = node.extensions.find("KHR_lights_punctual");
  if (light == node.extensions.end() || !light->second.Has("light")) return std::nullopt;
  if (!light->second.Get("light").IsInt()) return std::nullopt;
  return light->second.Get("light").GetNumberAsInt();
}

Expected<std::vector<RigNode>> ReadNodes(const tinygltf::Model& model, const std::string& file,
                                         const GltfAnimation& animation, WarningCounter& warnings) {
  return NodeReader(model, file, animation, warnings).Read();
}

Expected<std::vector<std::string>> NameObjects(const tinygltf::Model& model, const std::string& file,
                                               const std::vector<RigNode>& nodes) {
  return ObjectNamer(model, file, nodes).NameAll();
}

}  // namespace scumble
