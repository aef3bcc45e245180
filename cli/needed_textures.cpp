#include "cli/needed_textures.h"

#include "cli/command.h"
#include "guidegen/scene_textures.h"

namespace scumble {

Expected<SceneCost> DecodeNeededTextures(Scene& scene, const SceneOptions& options, const LayerSet& layers) {
  GuidegenOptions needs;  // nothing else of them says which textures are looked at
  needs.layers = layers;
  needs.max_bounces = options.max_bounces;
  SCUMBLE_ASSIGN(const DecodedTextures decoded, DecodeTextures(scene, needs));
  for (const std::string& warning : decoded.warnings) Warn(options.scene + ": " + warning);
  SceneCost cost;
  cost.textures_decoded = decoded.count;
  cost.texture_bytes = decoded.bytes;
  return cost;
}

}  // namespace scumble
