// The illuminated extension: exemplars painted for different light, and the choice between them at a pixel.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/image/guides.h"
#include "core/image/style.h"

namespace scumble {

// Up to kMaxExemplars lighting conditions with a luminance each. Immutable; free to use from any thread.
class Illumination {
 public:
  Illumination() = default;
  // `luminances` in the order of the exemplars; any order is legal. Of equal ones the first is taken.
  Illumination(std::span<const double> luminances, float weight, LuminanceError form);

  // With one exemplar light has no effect.
  bool active() const { return luminances_.size() > 1; }
  std::span<const float> luminances() const { return luminances_; }
  float weight() const { return weight_; }
  LuminanceError form() const { return form_; }
  float brightest() const { return brightest_; }
  // Where the choice changes, rising.
  std::span<const float> borders() const { return borders_; }

  // The exemplar with the nearest luminance; ties to the first. NaN and negative values count as darkness. Values
  // brighter than the brightest exemplar count as bright as that: far from all exemplars, the differences would be
  // rounded away.
  int Choose(float luminance) const;

  // The addition to a pixel's guide distance if exemplar `chosen` paints its luminance: 0 or more.
  float Error(float luminance, int chosen) const;

 private:
  float Clamped(float luminance) const { return luminance >= 0.0f ? std::min(luminance, brightest_) : 0.0f; }

  std::vector<float> luminances_, borders_;
  float brightest_ = 0.0f;
  float weight_ = 0.0f;
  LuminanceError form_ = LuminanceError::kExcess;
};

// Mean luminance, linear, of the paint inside the disc of a square picture, weighted by its alpha.
double MeasuredLuminance(const Picture& picture, double rim);

// MeasuredLuminance over the pixels of a mask, which has one value for each, 1 for yes.
double MeasuredLuminance(const Picture& picture, std::span<const std::uint8_t> mask);

// The 90th percentile of a layer of light over the covered pixels, by the luminance of its colours; values not above 0
// count as 0. 0 where nothing is covered. Runs on all threads of the caller's oneTBB arena; the result does not depend
// on them.
double BrightPercentile(const GuideSet& guides, Layer layer);

// The exposure, in stops to the hundredth, that maps the 90th percentile of the luminance of covered pixels to the
// brightest exemplar's. 0 where nothing is lit. The guides must hold the layer that stands for luminance.
double MeasureExposure(const GuideSet& guides, std::span<const float> luminances, Layer layer = Layer::kLuminance);

}  // namespace scumble
