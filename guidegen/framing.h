// The camera and the light of a scene whose file has none.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/image/direction.h"
#include "core/image/status.h"
#include "guidegen/scene.h"

namespace scumble {

// The view of a scene without a camera. Azimuth from +Z towards +X, elevation up from the horizon, degrees.
struct ViewAngles {
  double azimuth = 35.0;
  double elevation = 20.0;  // -90 … 90
  double distance = 0.0;    // m from the centre of the scene's bounding sphere; 0 frames it with a margin
  double right = 0.0;       // m in the picture plane from that centre to what is looked at
  double up = 0.0;          // likewise
  double fov = 0.0;         // the picture's vertical angle of view, below 180; 0: 35
};

// The direction of a sun in the camera's view space, degrees (core/image/direction.h).
struct LightAngles {
  double azimuth = kKeyLightAzimuth;
  double elevation = kKeyLightElevation;
};

// kUsage where an angle or length is outside its range or not finite; the message begins with the member's name.
Status CheckView(const ViewAngles& view);
Status CheckLight(const LightAngles& light);  // elevation -90 … 90

// Around the middle of a scene's bounding box: at most √3 times too large, and independent of the order of vertices.
struct SceneSphere {
  glm::dvec3 center{0.0};
  double radius = 1.0;
};
SceneSphere SphereAround(const Scene& scene);

// A perspective camera that looks at the scene's centre. `aspect` is width / height of the picture.
Camera FramingCamera(const Scene& scene, const ViewAngles& view, double aspect);

// The view whose FramingCamera stands where the camera stands, looks where it looks, and has its angle of view. Roll,
// shift, border and clipping are left out. A camera that has the scene's centre behind it is moved forward to it. An
// orthographic one becomes a view from far away, of a degree, that shows as much of the centre's plane.
ViewAngles OrbitOf(const SceneSphere& sphere, const Camera& camera, double aspect);

// A sun of strength π (white Lambert facing it has radiance 1) at these angles (core/image/direction.h) of the given
// camera's view space.
Light KeyLight(const Camera& camera, double azimuth = kKeyLightAzimuth, double elevation = kKeyLightElevation);

// Puts one KeyLight from these angles in place of the scene's lights and its world.
void ReplaceLights(Scene& scene, const Camera& camera, const LightAngles& light);

// Prepares the scene for rendering. Picks the camera by name (empty: the first; none in the file or `view` given: a
// framing one). Adds the key light to the scene if it has no light and `needs_light`; a surface that glows by a texture
// is no light. Each such decision is one line of `notes`, for stderr. An unknown camera name is a usage error that
// lists the names in the file. kInput where the first would be taken, and Blender's active camera was left out.
struct PreparedView {
  Camera camera;
  std::vector<std::string> notes;
};
Expected<PreparedView> PrepareView(Scene& scene, const std::string& camera_name, const std::optional<ViewAngles>& view,
                                   double aspect, bool needs_light);

}  // namespace scumble
