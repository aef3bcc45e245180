#include "pipeline/guide_layers.h"

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

bool internal::UseDataFolder(const char* folder) {
  SetModuleFolder(std::filesystem::path(folder) / "../../lib/scumble");
  return true;
}

Expected<Picture> LoadPicture(const std::string& file) { return ReadPicture(file); }

Status SavePicture(const std::string& file, const Picture& picture, int bits) {
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(file, {bits}));
  return WritePicture(file, picture, {bits});
}

}  // namespace scumble
