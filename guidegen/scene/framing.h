// The camera and the light of a scene whose file has none.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/image/direction.h"
#include "core/image/status.h"
#include "guidegen/scene/scene.h"

namespace scumble {

// The view of a scene without a camera. Azimuth from +Z towards +X, elevation up from the horizon, degrees.
struct ViewAngles {
  double azimuth = 35.0;
  double elevation = 20.0;
  double distance = 0.0;  // m from the centre of the scene's bounding sphere; 0 frames it with a margin
};

// A perspective camera that looks at the scene's centre. `aspect` is width / height of the picture.
Camera FramingCamera(const Scene& scene, const ViewAngles& view, double aspect);

// A sun of strength π (white Lambert facing it has radiance 1) at these angles (core/image/direction.h) of the given
// camera's view space.
Light KeyLight(const Camera& camera, double azimuth = kKeyLightAzimuth, double elevation = kKeyLightElevation);

// Prepares the scene for rendering. Picks the camera by name (empty: the first; none in the file or `view` given: a
// framing one). Adds the key light to the scene if it has no light and `needs_light`; a surface that glows by a texture
// is no light. Each such decision is one line of `notes`, for stderr. An unknown camera name is a usage error that
// lists the names in the file.
struct PreparedView {
  Camera camera;
  std::vector<std::string> notes;
};
Expected<PreparedView> PrepareView(Scene& scene, const std::string& camera_name, const std::optional<ViewAngles>& view,
                                   double aspect, bool needs_light);

}  // namespace scumble
