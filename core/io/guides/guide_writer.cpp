// Guides to EXR.
#include "core/io/atomic_file.h"
#include "core/io/exr/scanline_exr.h"
#include "core/io/guide_file.h"
#include "core/io/guides/cryptomatte_writer.h"
#include "core/io/guides/fragment_storage.h"
#include "core/io/guides/guide_header.h"

namespace scumble {
namespace {

// OpenEXR's camera space looks down +Z and is left-handed; its NDC runs from (0, 0) in the upper left corner to (1, 1)
// in the lower right (ImfStandardAttributes.h). Column by column.
const glm::dmat4 kExrFromView{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1};
const glm::dmat4 kNdcFromClip{0.5, 0, 0, 0, 0, -0.5, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0, 1};

// Its channels are the guides' own planes, and those of `mattes`.
internal::ExrImage ImageOf(const GuideSet& guides, const GuideWriteOptions& options, internal::MattePlanes& mattes) {
  internal::ExrImage image;
  image.width = guides.width(), image.height = guides.height();
  image.compression = options.compression;
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      image.channels.push_back(
          {info.channels[static_cast<std::size_t>(c)], options.half && info.is_color, guides.Plane(info.layer, c)});
    }
  }
  image.texts = {guides.attributes.begin(), guides.attributes.end()};
  const auto set_names = [&](const char* name, const std::map<std::uint32_t, std::string>& names) {
    if (!names.empty()) image.texts[name] = internal::NamesToText(names);
  };
  set_names("scumble:objects", guides.object_names);
  set_names("scumble:materials", guides.material_names);
  set_names("scumble:objectStyles", guides.object_styles);
  set_names("scumble:materialStyles", guides.material_styles);
  if (guides.camera) {
    image.texts["scumble:camera"] = guides.camera->name;
    image.texts["scumble:viewFromWorld"] = internal::MatrixToText(guides.camera->view_from_world);
    image.texts["scumble:clipFromView"] = internal::MatrixToText(guides.camera->clip_from_view);
    // Our matrices are for column vectors, OpenEXR's for row vectors: the same 16 numbers in memory.
    image.matrices["worldToCamera"] = kExrFromView * guides.camera->view_from_world;
    image.matrices["worldToNDC"] = kNdcFromClip * guides.camera->clip_from_view * guides.camera->view_from_world;
  }
  if (guides.fragments) {
    image.blobs[internal::kFragmentAttribute] = {internal::kFragmentType,
                                                 internal::EncodeFragments(guides, options.half)};
  }
  if (options.cryptomatte) mattes.AddTo(guides, image);
  return image;
}

}  // namespace

Status WriteGuides(const std::filesystem::path& path, const GuideSet& guides, const GuideWriteOptions& options) {
  SCUMBLE_RETURN_IF_ERROR(CheckGuideTarget(path, options));
  internal::MattePlanes mattes;
  SCUMBLE_ASSIGN(const std::vector<std::byte> encoded,
                 internal::EncodeExr(path.string(), ImageOf(guides, options, mattes)));
  return WriteFileAtomically(path, encoded);
}

}  // namespace scumble
