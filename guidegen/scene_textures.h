// Pictures of a scene's materials, decoded when a layer needs them and not before. A style that asks for normals alone
// never waits for the paint of the model, nor does it fail where that paint is missing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/guidegen.h"
#include "guidegen/scene/scene.h"

namespace scumble {

// By the number of Scene::textures: whether RenderGuides with these options may look at it. Normal maps always; base
// colours for albedo, for light paths that can exist, and where they may leave holes; roughness and metalness for light
// paths; emission wherever light is asked for. Only what instances show counts, with texture coordinates for it.
std::vector<bool> NeededTextures(const Scene& scene, const GuidegenOptions& options);

struct DecodedTextures {
  int count = 0;
  std::size_t bytes = 0;              // of the decoded pictures
  int left_out = 0;                   // pictures that cannot be read
  std::vector<std::string> warnings;  // of those
};

// How many pixels those would have that are not decoded yet, by their headers; of one that cannot be read none:
// decoding it says why.
struct TexturePixels {
  std::uint64_t all = 0;
  std::uint64_t largest = 0;  // of one
};
TexturePixels CountNeededPixels(const Scene& scene, const GuidegenOptions& options);

// Decodes what RenderGuides needs with these options and is not decoded yet. A picture that is missing or broken is an
// error that names it, or a warning where the scene's format can do without (Wavefront's); more pixels than
// PictureBudget has are an error that names the scene. After an error nothing that was decoded is lost.
// options.progress is asked before each picture, with a share of 0.
Expected<DecodedTextures> DecodeTextures(Scene& scene, const GuidegenOptions& options);

// The same of all there are.
Expected<DecodedTextures> DecodeAllTextures(Scene& scene);

}  // namespace scumble
