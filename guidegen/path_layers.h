// The light-path layers as expressions, followed side by side while a path grows from the eye.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/image/layers.h"
#include "guidegen/light/path_expression.h"
#include "guidegen/scene.h"

namespace scumble {

inline constexpr int kMaxPathLayers = 5;

// Kinds of light and reflection in a scene: the parts that paths are made of.
struct PathSupply {
  bool light = false;            // anything that emits
  std::size_t delta_lights = 0;  // lights without extent
  bool may_be_met = false;       // a light that has an extent: area lights, meshes, the world
  bool diffuse = false;          // some material reflects diffusely
  bool specular = false;
};
PathSupply SupplyOf(const Scene& scene);

// The expression of a light-path layer, or null for other layers.
const char* PathLayerExpression(Layer layer);
LayerSet PathLayers();

// The state of a path in each layer's expression.
using PathState = std::array<PathExpression::State, kMaxPathLayers>;

// The requested layers whose paths can exist in the scene; the others stay 0 and cost nothing. Immutable.
class PathFollower {
 public:
  PathFollower(const LayerSet& asked, const PathSupply& supply, int max_bounces);

  std::span<const Layer> layers() const { return layers_; }
  bool empty() const { return layers_.empty(); }
  // Whether random numbers are needed: a light with extent may be hit, or a path has more than one reflection.
  bool NeedsSamples() const { return needs_samples_; }
  // Whether any path has more than one reflection.
  bool Bounces() const { return bounces_; }

  PathState AtEye() const;
  PathState Step(const PathState& state, PathEvent event) const;
  // Whether light found now belongs to some layer.
  bool WantsLight(const PathState& state) const;
  bool WantsLight(const PathState& state, int layer) const {
    return expressions_[std::size_t(layer)].EndsWithLight(state[std::size_t(layer)]);
  }
  // Whether another reflection can lead to light.
  bool WantsMore(const PathState& state) const;

 private:
  bool IsAlive(const PathState& state) const;
  int LongestPath(const PathExpression& expression, int most) const;

  PathSupply supply_;
  std::vector<Layer> layers_;
  std::vector<PathExpression> expressions_;
  bool needs_samples_ = false;
  bool bounces_ = false;
};

}  // namespace scumble
