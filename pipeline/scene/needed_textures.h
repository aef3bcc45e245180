// Textures of an open scene, decoded before it is cast.
#pragma once

#include "guidegen/scene_textures.h"
#include "pipeline/scene_guides.h"

namespace scumble {

// How many pixels that will be; by the files' headers.
TexturePixels CountNeededPixels(const Scene& scene, const SceneRequest& options, const LayerSet& layers);

// Decodes what casting these layers needs and is not decoded yet; it stays in the scene. Warns of what is left out.
// Returns what it took; the rest of the cost is 0. Cancelled between two pictures.
Expected<SceneCost> DecodeNeededTextures(Scene& scene, const SceneRequest& options, const LayerSet& layers,
                                         const RunContext& context);

}  // namespace scumble
