#include "cli/tradeoff_guides.h"

#include <fmt/format.h>

#include <utility>

#include "guidegen/path_layers.h"
#include "image/stopwatch.h"
#include "io/guide_precision.h"
#include "transfer/upsample_guides.h"

namespace scumble {

bool NeedSamples(const Scene& scene, const LayerSet& layers, const SceneOptions& options) {
  const PathSupply supply = SupplyOf(scene);
  if (!supply.light) return false;
  if (supply.may_be_met && (layers.Has(Layer::kLuminance) || layers.Has(Layer::kShadow))) return true;
  const PathFollower follower(layers, supply, options.max_bounces);
  return !follower.empty() && follower.NeedsSamples();
}

Expected<WayGuides> MakeWayGuides(SceneAtRest& scene, const SceneOptions& options, const Way& way,
                                  const LayerSet& layers, const Globals& globals) {
  SCUMBLE_ASSIGN(const Size size, ParseSize(options.size));
  SceneOptions one = options;
  const int up = UpsampleOf(way), super = SupersampleOf(way);
  one.size = fmt::format("{}x{}", size.width * super / up, size.height * super / up);
  one.robust = way.robust;
  one.seed += static_cast<std::uint64_t>(way.more_seed);
  if (way.samples > 0) one.samples = way.samples;
  SCUMBLE_ASSIGN(SceneGuides made, CastScene(scene.scene, scene.view.camera, nullptr, one, layers, globals, {}, false));
  WayGuides result;
  for (const auto& [step, ms] : made.times) {
    if (step != "textures") result.ms += ms;  // decoded once, whatever is cast first
  }
  RoundGuides(way.precision, made.guides);
  if (up == 1) {
    result.guides = std::move(made.guides);
    return result;
  }
  Stopwatch watch;
  SCUMBLE_ASSIGN(result.guides, UpsampleGuides(made.guides, up, globals.threads));
  result.ms += watch.Lap();
  result.given = std::move(made.guides);
  return result;
}

std::string GuidesKey(const Way& way, const LayerSet& layers, bool rounded) {
  std::string key = fmt::format("{} {} {} {}", way.guide_scale, way.samples, way.robust, layers.ToString());
  if (rounded) key += fmt::format(" {} {}", int(way.precision), way.more_seed);
  return key;
}

}  // namespace scumble
