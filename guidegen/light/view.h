// What stands before a camera: objects, lights, and the camera's own rays.
#pragma once

#include <vector>

#include "guidegen/light/direct_light.h"
#include "guidegen/light/path_layers.h"
#include "guidegen/rays/camera_rays.h"
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

}  // namespace scumble
