// The ray caster behind RenderGuides and RenderSphereGuides.
#pragma once

#include "guidegen/guidegen.h"
#include "guidegen/light/view.h"
#include "guidegen/rays/lazy_scene.h"

namespace scumble {

// kUsage if an option is out of range; kUnavailable if a layer is not built in.
Status CheckOptions(const GuidegenOptions& options, bool has_next_frame = false);

// Casts into `objects`, which are built if this is the first cast with such needs. Fills the layers, the camera and the
// attributes; the caller adds names of objects and materials. `options` have passed CheckOptions.
Expected<GuidegenResult> CastGuides(LazyScene& objects, const View& view, const GuidegenOptions& options);

}  // namespace scumble
