#include "guidegen/path_layers.h"

#include <algorithm>
#include <utility>

#include "core/image/check.h"
#include "guidegen/surface/bsdf.h"

namespace scumble {
namespace {

constexpr std::pair<Layer, const char*> kExpressions[] = {{Layer::kLpeFull, "L.*E"},
                                                          {Layer::kLpeLDE, "LDE"},
                                                          {Layer::kLpeLSE, "LSE"},
                                                          {Layer::kLpeLDDE, "L.*DDE"},
                                                          {Layer::kLpeLD12E, "LD{1,2}E"}};
static_assert(std::size(kExpressions) == kMaxPathLayers);

bool Shines(const Light& light) { return light.intensity > 0.0 && light.color != glm::vec3(0.0f); }

bool HasExtent(const Light& light) {
  return light.type == LightType::kArea || (light.type == LightType::kSun ? light.angle_degrees : light.radius) > 0.0;
}

}  // namespace

PathSupply SupplyOf(const Scene& scene) {
  PathSupply supply;
  for (const Light& light : scene.lights) {
    supply.light = supply.light || Shines(light);
    if (Shines(light) && !HasExtent(light)) ++supply.delta_lights;
    supply.may_be_met = supply.may_be_met || (Shines(light) && HasExtent(light));
  }
  bool large = scene.world_radiance != glm::vec3(0.0f);
  for (const Instance& instance : scene.instances) {
    const Material& material = scene.materials[std::size_t(scene.meshes[std::size_t(instance.mesh)].material)];
    supply.diffuse = supply.diffuse || MayBeDiffuse(material);
    supply.specular = supply.specular || MayBeSpecular(material);
    large = large || MayEmit(material);
  }
  supply.light = supply.light || large;
  supply.may_be_met = supply.may_be_met || large;
  return supply;
}

const char* PathLayerExpression(Layer layer) {
  for (const auto& [known, text] : kExpressions) {
    if (known == layer) return text;
  }
  return nullptr;
}

LayerSet PathLayers() {
  LayerSet layers;
  for (const auto& [layer, text] : kExpressions) layers.Add(layer);
  return layers;
}

PathFollower::PathFollower(const LayerSet& asked, const PathSupply& supply, int max_bounces) : supply_(supply) {
  if (!supply.light) return;
  for (const auto& [layer, text] : kExpressions) {
    if (!asked.Has(layer)) continue;
    Expected<PathExpression> expression = PathExpression::Parse(text);
    SCUMBLE_CHECK(expression.ok());
    const int longest = LongestPath(*expression, max_bounces + 1);
    if (longest < 0) continue;
    bounces_ = bounces_ || longest > 1;
    needs_samples_ = needs_samples_ || longest > 1 || (longest == 1 && supply.may_be_met);
    layers_.push_back(layer);
    expressions_.push_back(*std::move(expression));
  }
}

// The largest number of reflections, up to `most`, of a path that matches with the scene's parts; −1 for none.
int PathFollower::LongestPath(const PathExpression& expression, int most) const {
  std::vector<PathExpression::State> states = {expression.Step(expression.Start(), PathEvent::kEye)};
  int longest = -1;
  for (int reflections = 0; reflections <= most && !states.empty(); ++reflections) {
    std::vector<PathExpression::State> next;
    for (const PathExpression::State state : states) {
      if (expression.EndsWithLight(state)) longest = reflections;
      if (supply_.diffuse) next.push_back(expression.Step(state, PathEvent::kDiffuse));
      if (supply_.specular) next.push_back(expression.Step(state, PathEvent::kSpecular));
    }
    std::erase(next, PathExpression::kDead);
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    states = std::move(next);
  }
  return longest;
}

PathState PathFollower::AtEye() const {
  PathState state;
  state.fill(PathExpression::kDead);
  for (std::size_t i = 0; i < expressions_.size(); ++i) state[i] = expressions_[i].Start();
  return Step(state, PathEvent::kEye);
}

PathState PathFollower::Step(const PathState& state, PathEvent event) const {
  PathState next;
  next.fill(PathExpression::kDead);
  for (std::size_t i = 0; i < expressions_.size(); ++i) next[i] = expressions_[i].Step(state[i], event);
  return next;
}

bool PathFollower::IsAlive(const PathState& state) const {
  return std::any_of(state.begin(), state.end(), [](PathExpression::State s) { return s != PathExpression::kDead; });
}

bool PathFollower::WantsLight(const PathState& state) const {
  for (std::size_t i = 0; i < expressions_.size(); ++i) {
    if (expressions_[i].EndsWithLight(state[i])) return true;
  }
  return false;
}

bool PathFollower::WantsMore(const PathState& state) const {
  return (supply_.diffuse && IsAlive(Step(state, PathEvent::kDiffuse))) ||
         (supply_.specular && IsAlive(Step(state, PathEvent::kSpecular)));
}

}  // namespace scumble
