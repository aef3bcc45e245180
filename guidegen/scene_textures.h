// Pictures of a scene's materials, decoded when a layer needs them and not before. A style that needs only normals
// never waits for the model's textures, and does not fail if they are missing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/guidegen.h"
#include "guidegen/scene.h"

namespace scumble {

// By index of Scene::textures: whether RenderGuides with these options may read it. Normal maps always. Base colours
// for albedo, for light paths that can exist, and for possible holes. Roughness and metalness for light paths; emission
// wherever light is needed. Only materials of instances count, with texture coordinates for the texture.
std::vector<bool> NeededTextures(const Scene& scene, const GuidegenOptions& options);

struct DecodedTextures {
  int count = 0;
  std::size_t bytes = 0;              // of the decoded pictures
  int left_out = 0;                   // pictures that cannot be read
  std::vector<std::string> warnings;  // of those
};

// The pixels of the textures not decoded yet, by their headers. An unreadable one counts 0: decoding reports it.
struct TexturePixels {
  std::uint64_t all = 0;
  std::uint64_t largest = 0;  // of one
};
TexturePixels CountNeededPixels(const Scene& scene, const GuidegenOptions& options);

// Decodes the textures that RenderGuides needs with these options and that are not decoded yet. A missing or damaged
// picture is an error that names it, or a warning where it is optional in the scene's format (Wavefront's). More pixels
// than PictureBudget allows are an error that names the scene. After an error all decoded textures are kept. Calls
// options.progress before each picture, with a share of 0.
Expected<DecodedTextures> DecodeTextures(Scene& scene, const GuidegenOptions& options);

// DecodeTextures for all textures.
Expected<DecodedTextures> DecodeAllTextures(Scene& scene);

}  // namespace scumble
