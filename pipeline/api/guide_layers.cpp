#include "pipeline/api/guide_layers.h"

#include <utility>

#include "core/io/guide_file.h"

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

}  // namespace scumble
