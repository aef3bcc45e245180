// Guides with hard shadows, and the exact areas of their pixels.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/image/guides.h"

namespace scumble {

// Of pixel (x, y), the share above the line y = a + b x, from its corner's coordinates.
inline double AreaAbove(double a, double b, int x, int y) {
  constexpr int kSamples = 64;
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) sum += std::clamp(a + b * (x + (i + 0.5) / kSamples) - y, 0.0, 1.0);
  return sum / kSamples;
}

// One object, covered from edge to edge, that faces the viewer 5 m away in full light.
inline GuideSet FlatLight(int size) {
  GuideSet guides(size, size);
  for (const Layer layer :
       {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject, Layer::kLuminance, Layer::kShadow}) {
    guides.Add(layer);
  }
  for (const Layer layer : {Layer::kCoverage, Layer::kObject, Layer::kLuminance})
    std::ranges::fill(guides.Plane(layer), 1.0f);
  std::ranges::fill(guides.Plane(Layer::kNormal, 2), 1.0f);
  std::ranges::fill(guides.Plane(Layer::kDepth), 5.0f);
  return guides;
}

// Shadow above a line, seen at pixel centres.
inline GuideSet SlantedShadow(int size, double a, double b) {
  GuideSet guides = FlatLight(size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const bool shaded = y + 0.5 < a + b * (x + 0.5);
      guides.Plane(Layer::kShadow)[guides.Index(x, y)] = shaded ? 1.0f : 0.0f;
      guides.Plane(Layer::kLuminance)[guides.Index(x, y)] = shaded ? 0.0f : 1.0f;
    }
  }
  guides.attributes[kLightKey] = kExactLight;
  return guides;
}

struct Errors {
  double mean = 0.0, most = 0.0;
};

// Of values 0 … 1 at the pixels through which the line goes, away from the picture's edges.
template <class Value>
Errors ErrorsAlong(int size, double a, double b, const Value& value) {
  Errors errors;
  int count = 0;
  for (int y = 8; y < size - 8; ++y) {
    for (int x = 8; x < size - 8; ++x) {
      const double exact = AreaAbove(a, b, x, y), error = std::fabs(value(x, y) - exact);
      errors.most = std::max(errors.most, error);
      if (exact > 0.0 && exact < 1.0) errors.mean += error, ++count;
    }
  }
  errors.mean /= std::max(1, count);
  return errors;
}

}  // namespace scumble
