// The one ray caster under RenderGuides and RenderSphereGuides.
#pragma once

#include <vector>

#include "guidegen/rays/camera_rays.h"
#include "guidegen/light/direct_light.h"
#include "guidegen/guidegen.h"
#include "guidegen/light/path_layers.h"
#include "guidegen/surface/surface.h"

namespace scumble {

// Objects and lights in the camera's view space.
struct View {
  CameraRays camera;
  std::vector<PlacedObject> objects;
  std::vector<PlacedLight> lights;  // looked at only where a layer needs them, as the rest
  glm::dvec3 world_radiance{0.0};
  PathSupply supply;

  // For the motion layer; empty where nobody asks for it. Of each of `objects`, in their order, as it stands in the
  // next frame before that frame's camera; without a mesh where it is gone by then.
  std::vector<PlacedObject> next_objects;
  CameraRays next_camera;
};

// kUsage or kUnavailable where the options make no sense or ask for what is not built in.
Status CheckOptions(const GuidegenOptions& options, bool has_next_frame = false);

// Fills the layers, the camera and the attributes; names of objects and materials are the caller's. `options` have
// passed CheckOptions.
Expected<GuidegenResult> CastGuides(View view, const GuidegenOptions& options);

}  // namespace scumble
