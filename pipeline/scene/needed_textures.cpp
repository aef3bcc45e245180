#include "pipeline/scene/needed_textures.h"

#include "pipeline/run_context.h"

namespace scumble {
namespace {

GuidegenOptions NeedsOf(const SceneRequest& options, const LayerSet& layers) {
  GuidegenOptions needs;  // nothing else of them says which textures are looked at
  needs.layers = layers;
  needs.max_bounces = options.max_bounces;
  return needs;
}

}  // namespace

TexturePixels CountNeededPixels(const Scene& scene, const SceneRequest& options, const LayerSet& layers) {
  return CountNeededPixels(scene, NeedsOf(options, layers));
}

Expected<SceneCost> DecodeNeededTextures(Scene& scene, const SceneRequest& options, const LayerSet& layers,
                                         const RunContext& context) {
  GuidegenOptions needs = NeedsOf(options, layers);
  needs.progress = [&](double) { return context.CheckNotCancelled().ok(); };
  SCUMBLE_ASSIGN(const DecodedTextures decoded, DecodeTextures(scene, needs));
  for (const std::string& warning : decoded.warnings) context.Warn(options.scene + ": " + warning);
  SceneCost cost;
  cost.textures_decoded = decoded.count;
  cost.texture_bytes = decoded.bytes;
  cost.textures_left_out = decoded.left_out;
  cost.texture_warnings = decoded.warnings;
  return cost;
}

}  // namespace scumble
