#include "pipeline/variant/variant_guides.h"

#include <fmt/format.h>

#include <glm/glm.hpp>
#include <span>
#include <utility>

#include "core/image/stopwatch.h"
#include "core/io/guide_precision.h"
#include "guidegen/path_layers.h"
#include "transfer/upsample_guides.h"

namespace scumble {

bool NeedSamples(const Scene& scene, const LayerSet& layers, const SceneRequest& options) {
  const PathSupply supply = SupplyOf(scene);
  const bool direct = layers.Has(Layer::kLuminance) || layers.Has(Layer::kShadow);
  return (supply.light && supply.may_be_met && direct) || NeedPathSamples(scene, layers, options);
}

bool NeedPathSamples(const Scene& scene, const LayerSet& layers, const SceneRequest& options) {
  const PathSupply supply = SupplyOf(scene);
  if (!supply.light) return false;
  const PathFollower follower(layers, supply, options.max_bounces);
  return !follower.empty() && follower.NeedsSamples();
}

Expected<VariantGuides> MakeVariantGuides(StaticScene& scene, const SceneRequest& options, const Variant& variant,
                                          const LayerSet& layers, const RunContext& context) {
  const Size& size = options.size;
  SceneRequest one = options;
  const int up = UpsampleOf(variant), super = SupersampleOf(variant);
  one.size = {size.width * super / up, size.height * super / up};
  one.robust = variant.robust;
  one.seed += static_cast<std::uint64_t>(variant.more_seed);
  if (variant.samples > 0) one.samples = variant.samples, one.samples_given = true;
  SCUMBLE_ASSIGN(SceneGuides made, CastScene({scene.scene, scene.view.camera}, one, layers, context, {}));
  VariantGuides result;
  for (const auto& [step, ms] : made.times) {
    if (step != "textures") result.ms += ms;  // decoded once, whatever is cast first
  }
  StoreFrameRate(options, scene.animation, made.guides);
  RoundGuides(variant.precision, made.guides);
  if (GuideFactorOf(variant) == 1) {
    result.guides = std::move(made.guides);
    return result;
  }
  Stopwatch watch;
  SCUMBLE_ASSIGN(result.guides, UpsampleGuides(made.guides, up, context.threads));
  result.ms += watch.Lap();
  result.given = std::move(made.guides);
  return result;
}

GuideSet AveragedGuides(const GuideSet& guides, int factor) {
  GuideSet small(guides.width() / factor, guides.height() / factor);
  for (const LayerInfo& info : AllLayers()) {
    const bool averages = info.is_color || info.layer == Layer::kNormal || info.layer == Layer::kCoverage;
    if (averages && guides.Has(info.layer)) small.Add(info.layer);
  }
  const auto coverage = guides.Plane(Layer::kCoverage);
  // The mean over the covered pixels of the block, or over all of it.
  const auto mean = [&](std::span<const float> plane, int x, int y, bool of_covered) {
    double sum = 0.0, count = 0.0;
    for (int v = 0; v < factor; ++v) {
      for (int u = 0; u < factor; ++u) {
        const std::size_t from = guides.Index(factor * x + u, factor * y + v);
        if (!of_covered || coverage[from] > 0.0f) sum += plane[from], count += 1.0;
      }
    }
    return sum / count;
  };
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) {
      const std::size_t i = small.Index(x, y);
      small.Plane(Layer::kCoverage)[i] = static_cast<float>(mean(coverage, x, y, false));
      if (!(small.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
      for (const LayerInfo& info : AllLayers()) {
        if (!info.is_color || !small.Has(info.layer)) continue;
        for (int c = 0; c < ChannelCount(info.layer); ++c) {
          small.Plane(info.layer, c)[i] = static_cast<float>(mean(guides.Plane(info.layer, c), x, y, true));
        }
      }
      if (!small.Has(Layer::kNormal)) continue;
      glm::dvec3 normal;
      for (int c = 0; c < 3; ++c) normal[c] = mean(guides.Plane(Layer::kNormal, c), x, y, true);
      const double length = glm::length(normal);
      for (int c = 0; c < 3 && length > 0.0; ++c) {
        small.Plane(Layer::kNormal, c)[i] = static_cast<float>(normal[c] / length);
      }
    }
  }
  return small;
}

std::string GuidesKey(const Variant& variant, const LayerSet& layers, bool rounded) {
  std::string key = fmt::format("{}{} {} {} {}", variant.guide_scale, variant.upscale ? " as cast" : "",
                                variant.samples, variant.robust, layers.ToString());
  if (rounded) key += fmt::format(" {} {}", int(variant.precision), variant.more_seed);
  return key;
}

}  // namespace scumble
