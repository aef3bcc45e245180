#include "guidegen/scene_textures.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "guidegen/load/loader_util.h"
#include "guidegen/load/texture_budget.h"
#include "guidegen/path_layers.h"
#include "guidegen/surface/bsdf.h"
#include "guidegen/surface/surface.h"

namespace scumble {
namespace {

bool IsEncoded(const Scene& scene, std::size_t texture) {
  return texture < scene.encoded_textures.size() && scene.encoded_textures[texture];
}

// Empty where it cannot be read.
std::optional<std::uint64_t> CountPixels(const EncodedTexture& texture) {
  if (!texture.count_pixels) return std::nullopt;
  const Expected<std::uint64_t> pixels = texture.count_pixels();
  return pixels ? std::optional(*pixels) : std::nullopt;
}

// Decodes those that `wanted(scene)` names. Leaving a texture out may change materials, and with them the wanted
// textures.
template <class Wanted>
Expected<DecodedTextures> Decode(Scene& scene, const Wanted& wanted, const Progress& progress) {
  DecodedTextures done;
  WarningCounter warnings;
  PictureBudget budget;
  for (const Picture& picture : scene.textures) SCUMBLE_RETURN_IF_ERROR(budget.Take(scene.name, picture));
  for (bool again = true; std::exchange(again, false);) {
    const std::vector<bool> needed = wanted(scene);
    for (std::size_t i = 0; i < needed.size(); ++i) {
      if (!needed[i] || !IsEncoded(scene, i)) continue;
      if (progress && !progress(0.0)) return CancelledError();
      const std::shared_ptr<const EncodedTexture> encoded = scene.encoded_textures[i];
      // Checked by the header, and charged after decoding: a texture that is left out takes nothing.
      if (const auto promised = CountPixels(*encoded)) {
        SCUMBLE_RETURN_IF_ERROR(PictureBudget(budget).Take(scene.name, *promised));
      }
      Expected<Picture> picture = encoded->decode();
      if (!picture && !encoded->leave_out) return picture.error();
      if (picture) SCUMBLE_RETURN_IF_ERROR(budget.Take(scene.name, *picture));
      scene.encoded_textures[i].reset();
      if (picture) {
        ++done.count;
        done.bytes += picture->rgba.size() * sizeof(picture->rgba[0]);
        scene.textures[i] = *std::move(picture);
      } else {
        warnings.Add("a texture cannot be read and is left out", Excerpt(picture.error().message));
        encoded->leave_out(scene);
        ++done.left_out;
        again = true;
      }
    }
  }
  warnings.MoveTo(done.warnings);
  return done;
}

}  // namespace

std::vector<bool> NeededTextures(const Scene& scene, const GuidegenOptions& options) {
  std::vector<bool> needed(scene.textures.size(), false);
  const bool paths = !PathFollower(options.layers, SupplyOf(scene), options.max_bounces).empty();
  const bool lit = paths || options.layers.Has(Layer::kLuminance) || options.layers.Has(Layer::kShadow);
  const bool colored = paths || options.layers.Has(Layer::kAlbedo);
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    const Material& material = scene.materials[std::size_t(mesh.material)];
    const auto need = [&](bool asked, const TextureUse& use) {
      if (asked && use.texture >= 0 && !mesh.uvs[std::size_t(use.uv_set)].empty())
        needed[std::size_t(use.texture)] = true;
    };
    const bool in_object =
        material.normal_rule == NormalMapRule::kObject || material.normal_rule == NormalMapRule::kBlenderObject;
    need(in_object || !mesh.tangents.empty(), material.normal_texture);
    need(true, material.bump.height_texture);
    need(colored || MayHaveHoles(material), material.base_color_texture);
    need(paths && material.bsdf != Bsdf::kDiffuse && material.bsdf != Bsdf::kEmission,
         material.metallic_roughness_texture);
    need(lit && MayEmit(material), material.emission_texture);
  }
  return needed;
}

TexturePixels CountNeededPixels(const Scene& scene, const GuidegenOptions& options) {
  const std::vector<bool> needed = NeededTextures(scene, options);
  TexturePixels pixels;
  for (std::size_t i = 0; i < needed.size(); ++i) {
    if (!needed[i] || !IsEncoded(scene, i)) continue;
    const std::uint64_t one = CountPixels(*scene.encoded_textures[i]).value_or(0);
    pixels.all += one;
    pixels.largest = std::max(pixels.largest, one);
  }
  return pixels;
}

Expected<DecodedTextures> DecodeTextures(Scene& scene, const GuidegenOptions& options) {
  return Decode(
      scene, [&](const Scene& now) { return NeededTextures(now, options); }, options.progress);
}

Expected<DecodedTextures> DecodeAllTextures(Scene& scene) {
  return Decode(scene, [](const Scene& now) { return std::vector<bool>(now.textures.size(), true); }, {});
}

}  // namespace scumble
