// A cast's input besides the objects: the camera's rays, lights, and the next frame.
#pragma once

#include <optional>
#include <vector>

#include "guidegen/light/direct_light.h"
#include "guidegen/light/key_lamp.h"
#include "guidegen/path_layers.h"
#include "guidegen/rays/camera_rays.h"
#include "guidegen/surface/surface.h"

namespace scumble {

// All in the camera's view space. The objects are the EmbreeScene's.
struct View {
  CameraRays camera;
  bool bends_normals = true;        // as Cycles: surface/shading_normal.h
  std::vector<PlacedLight> lights;  // these and the following members only where a layer needs them
  glm::dvec3 world_radiance{0.0};
  PathSupply supply;
  std::optional<KeyLamp> key_lamp;  // for the layer cosine

  // For the motion layer; empty where it is not wanted. Each of the scene's objects, in their order, as placed before
  // the next frame's camera; without a mesh if the next frame lacks it. Triangles with a corner at NaN have no next
  // place.
  std::vector<PlacedObject> next_objects;
  CameraRays next_camera;
};

}  // namespace scumble
