#include "core/image/style.h"

#include <algorithm>

namespace scumble {

LayerSet GuideWeights::Layers() const {
  LayerSet layers;
  for (const LayerInfo& info : AllLayers()) {
    if ((*this)[info.layer] > 0.0f) layers.Add(info.layer);
  }
  return layers;
}

bool GuideWeights::CanWeigh(Layer layer) {
  return layer == Layer::kNormal || layer == Layer::kAlbedo || layer == Layer::kShadow || layer == Layer::kOutline ||
         IsRadiance(layer);
}

bool GuideWeights::IsRadiance(Layer layer) {
  switch (layer) {
    case Layer::kLuminance:
    case Layer::kLpeFull:
    case Layer::kLpeLDE:
    case Layer::kLpeLSE:
    case Layer::kLpeLDDE:
    case Layer::kLpeLD12E:
      return true;
    default:
      return false;
  }
}

LayerSet TransferLayers(const Style& style) {
  const TransferSettings& settings = style.transfer;
  LayerSet layers{Layer::kCoverage, Layer::kNormal};
  const bool votes_stop_at_edges = settings.edge_aware && settings.blend_radius > 0;
  if (votes_stop_at_edges || settings.variety > 0.0) layers.Add(Layer::kObject);
  if (votes_stop_at_edges) layers.Add(Layer::kDepth);
  if (settings.coherent && settings.method == Method::kStyleBlit) {
    layers.Add(Layer::kObject).Add(Layer::kDepth).Add(Layer::kPref);
  }
  layers.Add(settings.guide_weights.Layers());
  if (style.exemplars.size() > 1) layers.Add(Layer::kLuminance);
  if (settings.shadow == ShadowMode::kPaint) layers.Add(Layer::kShadow);
  if (settings.edge == EdgeMode::kExemplar) layers.Add(Layer::kObject).Add(Layer::kDepth);
  if (settings.colorize > 0.0) layers.Add(Layer::kAlbedo);
  return layers;
}

LayerSet RequiredLayers(const Style& style) {
  LayerSet layers = TransferLayers(style);
  for (const FinishPass& pass : style.finish) layers.Add(RequiredLayers(pass));
  return layers;
}

bool AsksForLight(const Style& style) {
  const LayerSet layers = RequiredLayers(style);
  return std::any_of(AllLayers().begin(), AllLayers().end(), [&](const LayerInfo& info) {
    return layers.Has(info.layer) && (info.layer == Layer::kShadow || GuideWeights::IsRadiance(info.layer));
  });
}

bool LooksAtLight(const Style& style) {
  if (style.exemplars.size() > 1) return true;
  for (const LayerInfo& info : AllLayers()) {
    if (style.transfer.guide_weights[info.layer] > 0.0f && GuideWeights::IsRadiance(info.layer)) return true;
  }
  return false;
}

}  // namespace scumble
