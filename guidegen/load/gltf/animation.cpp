#include "guidegen/load/gltf/animation.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "guidegen/load/gltf/accessor.h"

namespace scumble {

// Each channel keeps its times and values, and any number of channels may name one accessor. This budget refuses excess
// before it is read.
class KeyBudget {
 public:
  // 200 joints with translation, rotation and scale 30 times a second for 20 minutes have 43 million times and values.
  static constexpr std::uint64_t kMaxElements = 64'000'000;
  // Times have data, since they increase. Exporters omit constant values and seldom write them as zeros.
  static constexpr std::uint64_t kMaxZeros = 4'000'000;

  Status Take(const tinygltf::Model& model, const std::string& file, int accessor, const std::string& where) {
    SCUMBLE_ASSIGN(const std::size_t count, AccessorCount(model, file, accessor, where));
    SCUMBLE_RETURN_IF_ERROR(zeros_.Take(model, file, accessor));
    if (count > kMaxElements - taken_) {
      return InputError(file + ": " + where + ": with these the animation has more than " +
                        std::to_string(kMaxElements) + " times and values; expected fewer: bake fewer keys");
    }
    taken_ += count;
    return Ok();
  }

 private:
  ZeroBudget zeros_{kMaxZeros};
  std::uint64_t taken_ = 0;
};

namespace {

std::string AnimationName(const tinygltf::Model& model, std::size_t index) {
  const std::string& name = model.animations[index].name;
  return name.empty() ? "animation_" + std::to_string(index) : name;
}

glm::dquat ToQuaternion(const double* v) { return glm::dquat(v[3], v[0], v[1], v[2]); }

bool HasLength(const double* v) {
  const double length = glm::length(ToQuaternion(v));
  return length > 0.0 && std::isfinite(length);
}

// Reads one animation's channels; the members are shared arguments.
class ChannelReader {
 public:
  ChannelReader(const tinygltf::Model& model, const std::string& file, int animation, KeyBudget& budget)
      : model_(model),
        file_(file),
        budget_(budget),
        animation_(model.animations[std::size_t(animation)]),
        name_("animation '" + Excerpt(AnimationName(model, std::size_t(animation)), 80) + "'") {}

  const std::string& name() const { return name_; }
  std::string Where(std::size_t channel) const { return name_ + ", channel " + std::to_string(channel); }

  Error Bad(const std::string& where, const std::string& what) const {
    return InputError(file_ + ": " + where + " " + what + ": export it again");
  }

  // `width` is the property's; 0 for morph weights, of which the node's mesh has one per target.
  Expected<KeyTrack> Read(std::size_t channel, int width) const {
    const std::string where = Where(channel);
    const int index = animation_.channels[channel].sampler;
    if (index < 0 || std::size_t(index) >= animation_.samplers.size()) {
      return Bad(where, "uses sampler " + std::to_string(index) + ", the animation has " +
                            std::to_string(animation_.samplers.size()));
    }
    const tinygltf::AnimationSampler& sampler = animation_.samplers[std::size_t(index)];
    KeyTrack track;
    SCUMBLE_ASSIGN(track.interpolation, Interpolation(sampler.interpolation, where));
    SCUMBLE_ASSIGN(track.times, ReadTimes(sampler.input, where + ", times"));
    SCUMBLE_RETURN_IF_ERROR(ReadValues(sampler.output, width, where, track));
    return track;
  }

 private:
  Expected<KeyInterpolation> Interpolation(const std::string& name, const std::string& where) const {
    if (name == "LINEAR" || name.empty()) return KeyInterpolation::kLinear;
    if (name == "STEP") return KeyInterpolation::kStep;
    if (name == "CUBICSPLINE") return KeyInterpolation::kCubicSpline;
    return Bad(where, "interpolates by '" + Excerpt(name, 40) + "'; expected LINEAR, STEP or CUBICSPLINE");
  }

  Expected<std::vector<double>> ReadTimes(int accessor, const std::string& where) const {
    SCUMBLE_RETURN_IF_ERROR(budget_.Take(model_, file_, accessor, where));
    SCUMBLE_ASSIGN(const FloatTable table, ReadFloats(model_, file_, accessor, where));
    if (table.components != 1) return Bad(where, "are not single numbers");
    if (table.count == 0) return Bad(where, "has no key; expected one or more");
    std::vector<double> times(table.values.begin(), table.values.end());
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (!std::isfinite(times[i])) return Bad(where, "has NaN or infinity at key " + std::to_string(i));
      if (i > 0 && times[i] <= times[i - 1]) {
        return Bad(where, "does not increase at key " + std::to_string(i) + " (" + std::to_string(times[i]) +
                              " s after " + std::to_string(times[i - 1]) + " s)");
      }
    }
    return times;
  }

  Status ReadValues(int accessor, int width, const std::string& channel, KeyTrack& track) const {
    const std::string where = channel + ", values";
    SCUMBLE_RETURN_IF_ERROR(budget_.Take(model_, file_, accessor, where));
    SCUMBLE_ASSIGN(const FloatTable table, ReadFloats(model_, file_, accessor, where));
    const std::size_t values_a_key = track.interpolation == KeyInterpolation::kCubicSpline ? 3 : 1;
    const std::size_t keys = track.times.size() * values_a_key;
    if (width > 0 ? table.components != width : table.components != 1) {
      return Bad(where, "has " + std::to_string(table.components) + " components; expected " +
                            std::to_string(std::max(width, 1)));
    }
    if (width > 0 ? table.count != keys : table.count == 0 || table.count % keys != 0) {
      return Bad(where, "has " + std::to_string(table.count) + " elements for " + std::to_string(track.times.size()) +
                            " keys; expected " + (width > 0 ? "" : "a multiple of ") + std::to_string(keys));
    }
    track.width = width > 0 ? width : static_cast<int>(table.count / keys);
    track.values.assign(table.values.begin(), table.values.end());
    for (std::size_t i = 0; i < track.values.size(); ++i) {
      if (std::isfinite(track.values[i])) continue;
      return Bad(where, "has NaN or infinity at key " + std::to_string(i / (values_a_key * std::size_t(track.width))));
    }
    if (width != 4) return Ok();
    for (std::size_t key = 0; key < track.times.size(); ++key) {
      const std::size_t at = 4 * (key * values_a_key + (values_a_key == 3 ? 1 : 0));
      if (!HasLength(track.values.data() + at)) {
        return Bad(where, "has a rotation of zero length at key " + std::to_string(key));
      }
    }
    return Ok();
  }

  const tinygltf::Model& model_;
  const std::string& file_;
  KeyBudget& budget_;
  const tinygltf::Animation& animation_;
  const std::string name_;
};

void MakeUnit(std::vector<double>& rotation, const double* otherwise) {
  const double* from = HasLength(rotation.data()) ? rotation.data() : otherwise;
  const glm::dquat unit = ToQuaternion(from) / glm::length(ToQuaternion(from));
  rotation = {unit.x, unit.y, unit.z, unit.w};
}

}  // namespace

glm::dmat4 LocalMatrix(const NodePose& pose) {
  return glm::scale(glm::translate(glm::dmat4(1.0), pose.translation) * glm::mat4_cast(pose.rotation), pose.scale);
}

std::vector<double> KeyTrack::At(double seconds, bool is_rotation) const {
  const bool cubic = interpolation == KeyInterpolation::kCubicSpline;
  const std::size_t n = std::size_t(width), stride = cubic ? 3 * n : n;
  const auto value = [&](std::size_t key) { return values.data() + key * stride + (cubic ? n : 0); };
  // The key at or before the time; the first one if the time is before all keys, or NaN.
  const auto after = std::upper_bound(times.begin(), times.end(), seconds);
  const std::size_t key = after == times.begin() ? 0 : std::size_t(after - times.begin()) - 1;
  const double* v0 = value(key);
  std::vector<double> result(v0, v0 + n);
  const bool still = key + 1 == times.size() || !(seconds > times[key]) || interpolation == KeyInterpolation::kStep;
  if (!still) {
    const double* v1 = value(key + 1);
    const double length = times[key + 1] - times[key];
    const double t = (seconds - times[key]) / length;
    if (cubic) {
      const double t2 = t * t, t3 = t2 * t;
      const double* out0 = v0 + n;
      const double* in1 = v1 - n;
      for (std::size_t i = 0; i < n; ++i) {
        result[i] = (2.0 * t3 - 3.0 * t2 + 1.0) * v0[i] + length * (t3 - 2.0 * t2 + t) * out0[i] +
                    (-2.0 * t3 + 3.0 * t2) * v1[i] + length * (t3 - t2) * in1[i];
      }
    } else if (is_rotation) {
      const glm::dquat a = glm::normalize(ToQuaternion(v0)), b = glm::normalize(ToQuaternion(v1));
      const glm::dquat q = glm::slerp(a, b, t);  // the shorter way round
      result = {q.x, q.y, q.z, q.w};
    } else {
      for (std::size_t i = 0; i < n; ++i) result[i] = v0[i] + (v1[i] - v0[i]) * t;
    }
  }
  if (is_rotation) MakeUnit(result, v0);
  return result;
}

std::vector<std::string> AnimationNames(const tinygltf::Model& model) {
  std::vector<std::string> names;
  UniqueNames unique;
  for (std::size_t i = 0; i < model.animations.size(); ++i) names.push_back(unique.Take(AnimationName(model, i)));
  return names;
}

Expected<GltfAnimation> GltfAnimation::Read(const tinygltf::Model& model, const std::string& file,
                                            const std::string& name, WarningCounter& warnings) {
  GltfAnimation animation;
  KeyBudget budget;
  const std::vector<std::string> names = AnimationNames(model);
  if (name == "*") {
    for (std::size_t i = 0; i < names.size(); ++i) {
      SCUMBLE_RETURN_IF_ERROR(animation.ReadAnimation(model, file, static_cast<int>(i), budget, warnings));
    }
    return animation;
  }
  if (name.empty() && names.empty()) return animation;
  const auto chosen = name.empty() ? names.begin() : std::find(names.begin(), names.end(), name);
  if (chosen == names.end()) {
    std::string list;
    for (const std::string& one : names) list += (list.empty() ? "" : ", ") + ("\"" + Excerpt(one, 80) + "\"");
    return UsageError(file + " has no animation \"" + Excerpt(name, 80) + "\": " +
                      (list.empty() ? "it has none at all" : "choose one of " + list + ", or \"*\" for all at once"));
  }
  if (name.empty() && names.size() > 1) {
    warnings.Add("only the first of the " + std::to_string(names.size()) + " animations in the file is played",
                 "'" + Excerpt(names[0], 80) + "'");
  }
  const int index = static_cast<int>(chosen - names.begin());
  SCUMBLE_RETURN_IF_ERROR(animation.ReadAnimation(model, file, index, budget, warnings));
  return animation;
}

Status GltfAnimation::ReadAnimation(const tinygltf::Model& model, const std::string& file, int index, KeyBudget& budget,
                                    WarningCounter& warnings) {
  const ChannelReader reader(model, file, index, budget);
  const std::vector<tinygltf::AnimationChannel>& channels = model.animations[std::size_t(index)].channels;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const int node = channels[i].target_node;
    const std::string& path = channels[i].target_path;
    const std::string where = reader.Where(i);
    if (node < 0 || std::size_t(node) >= model.nodes.size()) {
      return reader.Bad(where,
                        "moves node " + std::to_string(node) + ", the file has " + std::to_string(model.nodes.size()));
    }
    NodeTracks& tracks = nodes_[node];
    KeyTrack* track = path == "translation" ? &tracks.translation
                      : path == "rotation"  ? &tracks.rotation
                      : path == "scale"     ? &tracks.scale
                      : path == "weights"   ? &tracks.weights
                                            : nullptr;
    if (!track) {
      warnings.Add("animation of what glTF 2.0 cannot animate is left out", where + ", '" + Excerpt(path, 40) + "'");
      continue;
    }
    if (track != &tracks.weights && !model.nodes[std::size_t(node)].matrix.empty()) {
      return reader.Bad(where, "moves node " + std::to_string(node) +
                                   ", which has a matrix; expected translation, rotation and scale");
    }
    if (!track->times.empty()) {
      warnings.Add("where a property is animated twice, the first animation counts", where);
      continue;
    }
    SCUMBLE_ASSIGN(*track, reader.Read(i, track == &tracks.weights ? 0 : track == &tracks.rotation ? 4 : 3));
    duration_ = std::max(duration_, track->times.back());
  }
  return Ok();
}

bool GltfAnimation::Moves(int node) const {
  const auto it = nodes_.find(node);
  if (it == nodes_.end()) return false;
  const NodeTracks& tracks = it->second;
  return !tracks.translation.times.empty() || !tracks.rotation.times.empty() || !tracks.scale.times.empty();
}

bool GltfAnimation::Morphs(int node) const {
  const auto it = nodes_.find(node);
  return it != nodes_.end() && !it->second.weights.times.empty();
}

void GltfAnimation::Pose(int node, double seconds, NodePose& pose) const {
  const auto it = nodes_.find(node);
  if (it == nodes_.end()) return;
  const auto vector = [&](const KeyTrack& track, glm::dvec3& v) {
    if (track.times.empty()) return;
    const std::vector<double> value = track.At(seconds);
    v = glm::dvec3(value[0], value[1], value[2]);
  };
  vector(it->second.translation, pose.translation);
  vector(it->second.scale, pose.scale);
  if (!it->second.rotation.times.empty()) pose.rotation = ToQuaternion(it->second.rotation.At(seconds, true).data());
}

std::vector<double> GltfAnimation::MorphWeights(int node, double seconds) const {
  return nodes_.at(node).weights.At(seconds);
}

}  // namespace scumble
