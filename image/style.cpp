#include "image/style.h"

namespace scumble {

LayerSet RequiredLayers(const TransferSettings& settings) {
  LayerSet layers{Layer::kCoverage, Layer::kNormal};
  if (settings.edge_aware && settings.blend_radius > 0) layers.Add(Layer::kDepth).Add(Layer::kObject);
  return layers;
}

}  // namespace scumble
