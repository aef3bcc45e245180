// How painted layers settle on a ground: grain, relief, washes. These finish painted strokes and make no marks of their
// own.
#pragma once

#include <optional>

#include "exemplars/paint/engine/canvas.h"

namespace scumble::paint {

// Charcoal, chalk and graphite catch on the paper's peaks and leave the hollows bare until they are pressed in.
struct DryMedia {
  float bite = 0.75f;      // 0: covers hollows like peaks, 1: the tooth alone decides
  float softness = 0.30f;  // of the grain's edges
  float density = 1.0f;    // of the covered grain
  // The colour of the stick, where there is only one: the faintest strokes have too few bits left to determine it.
  std::optional<glm::vec3> stick = std::nullopt;
};
void RubInto(Colors& ground, const Layer& layer, const Field& tooth, const DryMedia& media);

// Light across the paint's thickness from the upper left, as sheen and shade on each ridge.
struct Relief {
  float shade = 0.5f;
  float sheen = 0.12f;
};
void LightRelief(Colors& paint, const Field& height, const Relief& relief);

// Three box blurs, close to a Gaussian of that radius in units of kSide; edge pixels are repeated, on a tile too.
Field Blur(const Field& field, float radius);

// One plane of a layer.
Field Plane(const Layer& layer, int component);

}  // namespace scumble::paint
