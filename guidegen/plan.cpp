#include <algorithm>
#include <string>
#include <vector>

#include "guidegen/guidegen.h"

namespace scumble {
namespace {

std::string Counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

bool HasTexturedColor(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& material) { return material.base_color_texture.texture >= 0; });
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
      return "none: follows from the primary rays";
    case Layer::kAlbedo:
      return HasTexturedColor(scene) ? "1 texture lookup per covered pixel" : "none: no material has a texture";
    case Layer::kLuminance:
    case Layer::kShadow:
      return scene.lights.empty() ? "none: the scene has no light, so it is 0" : "shadow rays";
    default:
      return "not built in";
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
  if ((luminance || shadow) && !scene.lights.empty()) {
    plan.push_back({"shadow rays",
                    luminance && shadow ? "for luminance and shadow" : (luminance ? "for luminance" : "for shadow"),
                    Counted(scene.lights.size(), "shadow ray") + " per covered pixel, where the light faces it"});
  }
  const bool holes = std::any_of(scene.materials.begin(), scene.materials.end(),
                                 [](const Material& material) { return material.alpha_mode != AlphaMode::kOpaque; });
  if (holes) plan.push_back({"alpha test", "materials with holes", "1 texture lookup per ray and surface met"});
  return plan;
}

}  // namespace scumble
