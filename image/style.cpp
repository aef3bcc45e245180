#include "image/style.h"

namespace scumble {

LayerSet RequiredLayers(const Style& style) {
  const TransferSettings& settings = style.transfer;
  LayerSet layers{Layer::kCoverage, Layer::kNormal};
  const bool votes_stop_at_edges = settings.edge_aware && settings.blend_radius > 0;
  if (votes_stop_at_edges || settings.variety > 0.0) layers.Add(Layer::kObject);
  if (votes_stop_at_edges) layers.Add(Layer::kDepth);
  if (settings.coherent && settings.method == Method::kStyleBlit) {
    layers.Add(Layer::kObject).Add(Layer::kDepth).Add(Layer::kPref);
  }
  if (style.exemplars.size() > 1) layers.Add(Layer::kLuminance);
  if (settings.shadow == ShadowMode::kPaint) layers.Add(Layer::kShadow);
  if (settings.edge == EdgeMode::kExemplar) layers.Add(Layer::kObject).Add(Layer::kDepth);
  if (settings.colorize > 0.0) layers.Add(Layer::kAlbedo);
  return layers;
}

}  // namespace scumble
