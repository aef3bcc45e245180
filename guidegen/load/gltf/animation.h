// glTF animation: a node's properties at a time, by the samplers of the chosen animation. glTF 2.0, section 3.11 and
// appendix C: linear (rotations by slerp), step, cubic spline. Before the first key and after the last one the value is
// constant.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/load/loader_util.h"

namespace tinygltf {
class Model;
}

namespace scumble {

class KeyBudget;

// A node's own transform in glTF's parts: scale, then rotation, then translation.
struct NodePose {
  glm::dvec3 translation{0.0};
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  // unit
  glm::dvec3 scale{1.0};
};
glm::dmat4 LocalMatrix(const NodePose& pose);

enum class KeyInterpolation { kLinear, kStep, kCubicSpline };

// The keys of one property of one node. A key holds `width` numbers; with a cubic spline three times as many: the
// in-tangent, the value, the out-tangent.
struct KeyTrack {
  KeyInterpolation interpolation = KeyInterpolation::kLinear;
  int width = 0;
  std::vector<double> times;  // seconds, increasing, never empty
  std::vector<double> values;

  // `width` numbers. A rotation (four numbers: x, y, z, w) comes back with length 1.
  std::vector<double> At(double seconds, bool is_rotation = false) const;
};

// Immutable once read; free to use from any thread.
class GltfAnimation {
 public:
  // Chooses by name: "" is the file's first, "*" all of them at once (Blender may write one for each object). An
  // unknown name is a kUsage error that lists those of the file. kInput errors name animation, channel and place. They
  // are keys that are not finite or do not increase, counts of accessors that do not fit, and more keys than the limit.
  static Expected<GltfAnimation> Read(const tinygltf::Model& model, const std::string& file, const std::string& name,
                                      WarningCounter& warnings);

  bool empty() const { return nodes_.empty(); }
  double duration_seconds() const { return duration_; }  // of the last key; 0 without any

  bool Moves(int node) const;
  bool Morphs(int node) const;
  // Overwrites the animated properties of `pose` only.
  void Pose(int node, double seconds, NodePose& pose) const;
  std::vector<double> MorphWeights(int node, double seconds) const;  // of a node that Morphs

 private:
  struct NodeTracks {
    KeyTrack translation, rotation, scale, weights;  // without keys: not animated
  };

  Status ReadAnimation(const tinygltf::Model& model, const std::string& file, int index, KeyBudget& budget,
                       WarningCounter& warnings);

  std::map<int, NodeTracks> nodes_;
  double duration_ = 0.0;
};

// The names of a file's animations, in its order; "animation_0" for those without, "#2" behind a name that was there.
std::vector<std::string> AnimationNames(const tinygltf::Model& model);

}  // namespace scumble
