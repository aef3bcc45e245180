// The guides of the variants that `scumble tradeoff` measures: made as `stylize` would make them.
#pragma once

#include <string>

#include "core/image/guides.h"
#include "pipeline/requests.h"
#include "pipeline/scene/scene_sequence.h"
#include "pipeline/variant/variant.h"

namespace scumble {

// Whether guides of these layers need chance there, so that their samples matter.
bool NeedSamples(const Scene& scene, const LayerSet& layers, const SceneRequest& options);
// Whether light paths need it, besides luminance and shadow, of which each pixel takes as many samples as show.
bool NeedPathSamples(const Scene& scene, const LayerSet& layers, const SceneRequest& options);

struct VariantGuides {
  GuideSet guides;  // as the transfer reads them
  GuideSet given;   // before they were upsampled, by which the exposure is measured; empty where they were not
  double ms = 0.0;  // of wall clock: building the acceleration structure, casting, upsampling; not rounding

  const GuideSet& ForExposure() const { return given.pixel_count() > 0 ? given : guides; }
};

// `options.size` is the picture's.
Expected<VariantGuides> MakeVariantGuides(StaticScene& scene, const SceneRequest& options, const Variant& variant,
                                          const LayerSet& layers, const RunContext& context);

// Guides of 1/factor the sides, to be compared with guides of that size: of every block of factor × factor pixels the
// mean coverage, and of its covered pixels the mean light and colours and the mean normal, at unit length again.
// Background where none is covered; a mean normal of length 0 stays 0. Other layers are left out. The sides must be
// multiples of `factor`.
GuideSet AveragedGuides(const GuideSet& guides, int factor);

// Variants with equal text have equal guides; with `rounded` false, guides that take the same time: no rounding and no
// seed is asked for.
std::string GuidesKey(const Variant& variant, const LayerSet& layers, bool rounded);

}  // namespace scumble
