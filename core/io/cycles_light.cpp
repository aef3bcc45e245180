#include "core/io/cycles_light.h"

#include <array>
#include <string>

#include "core/image/channel_image.h"
#include "core/io/channel_file.h"

namespace scumble {
namespace {

using Plane = std::vector<float>;
using ColorPlanes = std::array<const Plane*, 3>;

bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::string ChannelsOf(const ChannelImage& image) {
  std::string list;
  for (const std::string& name : image.names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

// The three channels of a pass: "ViewLayer.DiffDir.R", .G and .B.
Expected<ColorPlanes> FindPass(const ChannelImage& image, const std::string& pass) {
  ColorPlanes planes{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string channel = pass + "." + "RGB"[c];
    for (std::size_t i = 0; i < image.names.size(); ++i) {
      if (image.names[i] != channel && !EndsWith(image.names[i], "." + channel)) continue;
      if (planes[c]) {
        return InputError(image.name + " holds the pass " + pass +
                          " twice; expected one view layer: its channels are " + ChannelsOf(image));
      }
      planes[c] = &image.planes[i];
    }
    if (!planes[c]) {
      return InputError(image.name + " has no channel " + channel + "; its channels are " + ChannelsOf(image) +
                        ". Render it with blender_scripts/render_guides.py --samples");
    }
  }
  return planes;
}

// The content of one of the three files. A move leaves the planes in place; a copy would not.
struct LightFile {
  LightFile() = default;
  LightFile(LightFile&&) = default;
  LightFile& operator=(LightFile&&) = default;

  ChannelImage image;
  ColorPlanes combined, emit, diffuse_direct, diffuse_indirect, diffuse_color, glossy_direct, glossy_color;
};

Expected<LightFile> ReadLightFile(const std::filesystem::path& stem, const std::string& kind, int samples) {
  std::filesystem::path path = stem;
  path += "." + kind + "." + std::to_string(samples) + ".exr";
  LightFile file;
  SCUMBLE_ASSIGN(file.image, ReadChannels(path));
  SCUMBLE_ASSIGN(file.combined, FindPass(file.image, "Combined"));
  SCUMBLE_ASSIGN(file.emit, FindPass(file.image, "Emit"));
  SCUMBLE_ASSIGN(file.diffuse_direct, FindPass(file.image, "DiffDir"));
  SCUMBLE_ASSIGN(file.diffuse_indirect, FindPass(file.image, "DiffInd"));
  SCUMBLE_ASSIGN(file.diffuse_color, FindPass(file.image, "DiffCol"));
  SCUMBLE_ASSIGN(file.glossy_direct, FindPass(file.image, "GlossDir"));
  SCUMBLE_ASSIGN(file.glossy_color, FindPass(file.image, "GlossCol"));
  return file;
}

std::string SizeText(int width, int height) { return std::to_string(width) + "×" + std::to_string(height); }

Status CheckSameSize(const ChannelImage& a, const ChannelImage& b) {
  if (a.width == b.width && a.height == b.height) return Ok();
  return InputError(b.name + " is " + SizeText(b.width, b.height) + ", " + a.name + " " + SizeText(a.width, a.height) +
                    ": render them in one run");
}

// The layer's value is color · (direct + indirect). A null pass counts as 0, a null color as 1.
void Fill(GuideSet& guides, Layer layer, const ColorPlanes* color, const ColorPlanes& first,
          const ColorPlanes* second) {
  guides.Add(layer);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto out = guides.Plane(layer, static_cast<int>(c));
    for (std::size_t i = 0; i < out.size(); ++i) {
      const float light = (*first[c])[i] + (second ? (*(*second)[c])[i] : 0.0f);
      out[i] = color ? (*(*color)[c])[i] * light : light;
    }
  }
}

}  // namespace

Expected<CyclesLight> ReadCyclesLight(const std::filesystem::path& stem, int samples) {
  SCUMBLE_ASSIGN(const LightFile all, ReadLightFile(stem, "all", samples));
  SCUMBLE_ASSIGN(const LightFile ldde, ReadLightFile(stem, "ldde", samples));
  SCUMBLE_ASSIGN(const LightFile ld12e, ReadLightFile(stem, "ld12e", samples));
  SCUMBLE_RETURN_IF_ERROR(CheckSameSize(all.image, ldde.image));
  SCUMBLE_RETURN_IF_ERROR(CheckSameSize(all.image, ld12e.image));
  CyclesLight light;
  light.guides = GuideSet(all.image.width, all.image.height);
  Fill(light.guides, Layer::kLpeFull, nullptr, all.combined, nullptr);
  Fill(light.guides, Layer::kLpeLDE, &all.diffuse_color, all.diffuse_direct, nullptr);
  Fill(light.guides, Layer::kLpeLSE, &all.glossy_color, all.glossy_direct, nullptr);
  Fill(light.guides, Layer::kLpeLDDE, &ldde.diffuse_color, ldde.diffuse_indirect, nullptr);
  Fill(light.guides, Layer::kLpeLD12E, &ld12e.diffuse_color, ld12e.diffuse_direct, &ld12e.diffuse_indirect);
  light.emits.assign(light.guides.pixel_count(), 0);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < light.emits.size(); ++i) {
      if ((*all.emit[c])[i] != 0.0f) light.emits[i] = 1;
      if ((*all.glossy_color[c])[i] != 0.0f) light.glossy = true;
    }
  }
  return light;
}

Expected<std::vector<std::uint8_t>> CompleteAlbedo(const std::filesystem::path& file, GuideSet& guides) {
  SCUMBLE_ASSIGN(const ChannelImage image, ReadChannels(file));
  SCUMBLE_ASSIGN(const ColorPlanes color, FindPass(image, "GlossCol"));
  SCUMBLE_ASSIGN(const ColorPlanes emit, FindPass(image, "Emit"));
  if (image.width != guides.width() || image.height != guides.height()) {
    return InputError(image.name + " is " + SizeText(image.width, image.height) + ", its guides " +
                      SizeText(guides.width(), guides.height()));
  }
  std::vector<std::uint8_t> shines(guides.pixel_count(), 0);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto albedo = guides.Plane(Layer::kAlbedo, static_cast<int>(c));
    for (std::size_t i = 0; i < albedo.size(); ++i) {
      albedo[i] += (*color[c])[i];
      if ((*emit[c])[i] != 0.0f) shines[i] = 1;
    }
  }
  for (std::size_t i = 0; i < shines.size(); ++i) {
    if (guides.Vec3(Layer::kAlbedo, i) != glm::vec3(0.0f)) shines[i] = 0;
  }
  return shines;
}

}  // namespace scumble
