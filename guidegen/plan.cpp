#include <algorithm>
#include <string>
#include <vector>

#include "guidegen/guidegen.h"
#include "guidegen/path_layers.h"
#include "guidegen/scene_textures.h"
#include "guidegen/surface/bsdf.h"

namespace scumble {
namespace {

std::string Counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

bool HasTexturedColor(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& material) { return material.base_color_texture.texture >= 0; });
}

std::string Samples(const GuidegenOptions& options) {
  if (options.time_budget_seconds <= 0.0 && options.noise <= 0.0) return Counted(std::size_t(options.samples), "path");
  return options.time_budget_seconds > 0.0 ? "as many paths as the time allows" : "paths until the noise is reached";
}

// Of luminance and shadow.
std::string LightSamples(const GuidegenOptions& options) {
  const std::string most = Counted(std::size_t(options.samples), "sample");
  if (!(options.light_error > 0.0) || options.samples <= kLeastLightSamples) return most;
  return std::to_string(kLeastLightSamples) + " to " + most;
}

std::string PathCost(Layer layer, const Scene& scene, const GuidegenOptions& options) {
  const PathSupply supply = SupplyOf(scene);
  if (!supply.light) return "none: the scene has no light, so it is 0";
  const PathFollower follower({layer}, supply, options.max_bounces);
  const std::string expression = PathLayerExpression(layer);
  if (follower.empty()) return "none: the scene has no path " + expression + ", so it is 0";
  if (!follower.NeedsSamples()) return "1 shadow ray per light and covered pixel; no random numbers";
  const std::string reach = follower.Bounces() ? "bounced up to " + Counted(std::size_t(options.max_bounces), "time")
                                               : "direct light alone, never bounced";
  return Samples(options) + " " + expression + " per covered pixel, " + reach;
}

// Whether there may be a key lamp, as far as lights and materials tell.
bool HasLamp(const Scene& scene) {
  return std::any_of(scene.lights.begin(), scene.lights.end(),
                     [](const Light& light) { return light.intensity * Brightness(glm::dvec3(light.color)) > 0.0; }) ||
         std::any_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& instance) {
           return MayEmit(scene.materials[std::size_t(scene.meshes[std::size_t(instance.mesh)].material)]);
         });
}

std::string LayerCost(Layer layer, const Scene& scene, const GuidegenOptions& options) {
  switch (layer) {
    case Layer::kCoverage:
      if (options.aa <= 1) return "none: the primary rays tell";
      return Counted(std::size_t(options.aa) * options.aa, "coverage ray") + " per pixel";
    case Layer::kNormal:
      return "1 primary ray per pixel, shared by every layer";
    case Layer::kDepth:
    case Layer::kObject:
    case Layer::kMaterial:
    case Layer::kPosition:
    case Layer::kPref:
    case Layer::kMotion:
    case Layer::kUv:
    case Layer::kOutline:
      return "none: follows from the primary rays";
    case Layer::kAlbedo:
      return HasTexturedColor(scene) ? "1 texture lookup per covered pixel" : "none: no material has a texture";
    case Layer::kLuminance:
    case Layer::kShadow:
      return SupplyOf(scene).light ? "shadow rays" : "none: the scene has no light, so it is 0";
    case Layer::kCosine:
      return HasLamp(scene) ? "none: follows from the primary rays and the place of the brightest lamp"
                            : "none: the scene has no lamp, so it is 0";
    default:
      return PathCost(layer, scene, options);
  }
}

}  // namespace

std::vector<PlanItem> PlanGuides(const Scene& scene, const GuidegenOptions& options) {
  std::vector<PlanItem> plan;
  for (const LayerInfo& info : AllLayers()) {
    const bool always = AlwaysWritten().Has(info.layer);
    if (!always && !options.layers.Has(info.layer)) continue;
    plan.push_back({info.name, always ? "always written" : "asked for", LayerCost(info.layer, scene, options)});
  }
  const bool luminance = options.layers.Has(Layer::kLuminance);
  const bool shadow = options.layers.Has(Layer::kShadow);
  const PathSupply supply = SupplyOf(scene);
  if ((luminance || shadow) && supply.light) {
    std::string cost;
    if (supply.delta_lights > 0) {
      cost = Counted(supply.delta_lights, "shadow ray") + " per covered pixel, where the light faces it";
    }
    if (supply.may_be_met) {
      cost += (cost.empty() ? "" : "; ") + LightSamples(options) + " per covered pixel of the lights with extent";
    }
    plan.push_back({"shadow rays",
                    luminance && shadow ? "for luminance and shadow" : (luminance ? "for luminance" : "for shadow"),
                    cost});
  }
  const bool holes = std::any_of(scene.materials.begin(), scene.materials.end(),
                                 [](const Material& material) { return material.alpha_mode != AlphaMode::kOpaque; });
  if (holes) plan.push_back({"alpha test", "materials with holes", "1 texture lookup per ray and surface met"});
  if (!scene.textures.empty()) {
    const std::vector<bool> needed = NeededTextures(scene, options);
    const auto count = std::size_t(std::count(needed.begin(), needed.end(), true));
    plan.push_back(
        {"textures", "pictures of the scene's materials",
         (count ? std::to_string(count) : std::string("none")) + " of " + std::to_string(needed.size()) + " decoded"});
  }
  return plan;
}

}  // namespace scumble
