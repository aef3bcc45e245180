#include "pipeline/api/guide_layers.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "core/io/guide_file.h"
#include "core/io/library.h"
#include "core/io/picture_file.h"

namespace scumble {

GuideLayers::GuideLayers(std::shared_ptr<const State> state) : state_(std::move(state)) {}

Expected<GuideLayers> GuideLayers::Load(const std::string& file) {
  GuideReadOptions options;
  for (const LayerInfo& info : AllLayers()) options.optional.Add(info.layer);
  SCUMBLE_ASSIGN(GuideSet guides, ReadGuides(file, options));
  return GuideLayers(std::make_shared<const State>(State{std::make_shared<const GuideSet>(std::move(guides))}));
}

Status GuideLayers::Save(const std::string& file) const {
  SCUMBLE_RETURN_IF_ERROR(CheckGuideTarget(file, {}));
  return WriteGuides(file, *state_->guides, {});
}

int GuideLayers::width() const { return state_->guides->width(); }
int GuideLayers::height() const { return state_->guides->height(); }
LayerSet GuideLayers::layers() const { return state_->guides->layers(); }

std::span<const float> GuideLayers::Plane(Layer layer, int component) const {
  if (!state_->guides->Has(layer) || component < 0 || component >= ChannelCount(layer)) return {};
  return state_->guides->Plane(layer, component);
}

namespace {

// A picture's members are the caller's to fill.
Status CheckPicture(const std::string& file, const Picture& picture) {
  const bool has_size = picture.width > 0 && picture.height > 0;
  const std::size_t wanted = has_size ? std::size_t(4) * std::size_t(picture.width) * std::size_t(picture.height) : 0;
  if (has_size && picture.rgba.size() == wanted) return Ok();
  return UsageError(fmt::format("cannot write {}: the picture is {}×{} with {} values in rgba; expected {}", file,
                                picture.width, picture.height, picture.rgba.size(),
                                has_size ? fmt::format("{}, 4 · width · height", wanted) : "at least 1×1 pixels"));
}

}  // namespace

bool internal::UseDataFolder(const char* folder) {
  SetModuleFolder(std::filesystem::path(folder) / "../../lib/scumble");
  return true;
}

Expected<Picture> LoadPicture(const std::string& file) { return ReadPicture(file); }

Status SavePicture(const std::string& file, const Picture& picture, int bits) {
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(file, {bits}));
  SCUMBLE_RETURN_IF_ERROR(CheckPicture(file, picture));
  return WritePicture(file, picture, {bits});
}

}  // namespace scumble
