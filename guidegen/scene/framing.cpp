#include "guidegen/scene/framing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "core/image/check.h"

namespace scumble {
namespace {

using std::numbers::pi;

constexpr double kRadiansPerDegree = pi / 180.0;
constexpr double kFramingYfovDegrees = 35.0;
constexpr double kFramingMargin = 1.1;  // the sphere takes 1 / 1.1 of the narrower side

struct Sphere {
  glm::dvec3 center{0.0};
  double radius = 1.0;
};

template <class Visit>
void ForEachPoint(const Scene& scene, Visit visit) {
  for (const Instance& instance : scene.instances) {
    for (const glm::vec3& position : scene.meshes[std::size_t(instance.mesh)].positions) {
      visit(glm::dvec3(instance.world_from_object * glm::dvec4(glm::dvec3(position), 1.0)));
    }
  }
}

// Around the middle of the bounding box: at most √3 times too large, and independent of the order of vertices.
Sphere BoundingSphere(const Scene& scene) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  ForEachPoint(scene, [&](const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  });
  if (!(low.x <= high.x)) return {};
  Sphere sphere{0.5 * low + 0.5 * high, 0.0};
  ForEachPoint(scene,
               [&](const glm::dvec3& p) { sphere.radius = std::max(sphere.radius, glm::length(p - sphere.center)); });
  if (!(sphere.radius > 0.0)) sphere.radius = 1.0;
  return sphere;
}

// Rotation whose +Z points at (azimuth, elevation), +X level. Built from the angles and not from a world "up", so that
// straight up and straight down need no special case.
glm::dmat4 Facing(double azimuth_degrees, double elevation_degrees) {
  const glm::dvec3 level = DirectionFromAngles(azimuth_degrees, 0.0);
  const glm::dvec3 right(level.z, 0.0, -level.x), back = DirectionFromAngles(azimuth_degrees, elevation_degrees);
  const glm::dvec3 up = glm::cross(back, right);
  return glm::dmat4(glm::dvec4(right, 0.0), glm::dvec4(up, 0.0), glm::dvec4(back, 0.0), glm::dvec4(0.0, 0.0, 0.0, 1.0));
}

std::string Names(const std::vector<Camera>& cameras) {
  std::string names;
  for (const Camera& camera : cameras) names += (names.empty() ? "'" : ", '") + camera.name + "'";
  return names;
}

std::string FramingNote(const Scene& scene, const ViewAngles& view, bool asked_for) {
  std::ostringstream note;
  if (!asked_for) note << scene.name << " has no camera: ";
  note << "seen from azimuth " << view.azimuth << "°, elevation " << view.elevation << "°";
  if (view.distance > 0.0) {
    note << ", " << view.distance << " m away";
  } else {
    note << ", framed whole";
  }
  return note.str();
}

std::string BorderNote(const Camera& camera) {
  const CameraBorder& border = *camera.border;
  if (!border.crop) return "drawn within the render border alone, the rest is background";
  return "the picture is the render border, to which it is cropped" +
         (camera.border_size.empty() ? "" : ": " + camera.border_size + " pixels in the file");
}

}  // namespace

Camera FramingCamera(const Scene& scene, const ViewAngles& view, double aspect) {
  SCUMBLE_CHECK(aspect > 0.0 && std::isfinite(aspect));
  const Sphere sphere = BoundingSphere(scene);
  const double half_y = 0.5 * kFramingYfovDegrees * kRadiansPerDegree;
  const double half_narrow = std::min(half_y, std::atan(std::tan(half_y) * aspect));
  // The margin widens the picture, not the distance, so it is an equal share of the picture at any angle of view.
  const double half_framed = std::atan(std::tan(half_narrow) / kFramingMargin);
  const double distance = view.distance > 0.0 ? view.distance : sphere.radius / std::sin(half_framed);
  Camera camera;
  camera.name = "framing";
  camera.yfov_degrees = kFramingYfovDegrees;
  camera.world_from_camera = Facing(view.azimuth, view.elevation);
  const glm::dvec3 back(camera.world_from_camera[2]);
  camera.world_from_camera[3] = glm::dvec4(sphere.center + distance * back, 1.0);
  return camera;
}

Light KeyLight(const Camera& camera, double azimuth, double elevation) {
  Light light;
  light.name = "key";
  light.type = LightType::kSun;
  light.intensity = pi;
  light.world_from_light = camera.world_from_camera * Facing(azimuth, elevation);
  return light;
}

namespace {

enum class LightOf { kNone, kGlow, kLamps };

// Surfaces that emit are lamps. Where a texture says at which places a surface glows, as a helmet's lights, they hardly
// light anything; all of Blender's Emission does.
LightOf FindLight(const Scene& scene) {
  if (!scene.lights.empty() || scene.world_radiance != glm::vec3(0.0f)) return LightOf::kLamps;
  LightOf found = LightOf::kNone;
  for (const Instance& instance : scene.instances) {
    const Material& material = scene.materials[scene.meshes[instance.mesh].material];
    if (material.emission == glm::vec3(0.0f)) continue;
    if (material.emission_texture.texture < 0 || material.bsdf == Bsdf::kEmission) return LightOf::kLamps;
    found = LightOf::kGlow;
  }
  return found;
}

}  // namespace

Expected<PreparedView> PrepareView(Scene& scene, const std::string& camera_name, const std::optional<ViewAngles>& view,
                                   double aspect, bool needs_light) {
  PreparedView prepared;
  if (!camera_name.empty()) {
    if (view) return UsageError("camera '" + camera_name + "' and a view are both asked for: give one of them");
    const auto found = std::find_if(scene.cameras.begin(), scene.cameras.end(),
                                    [&](const Camera& camera) { return camera.name == camera_name; });
    if (found == scene.cameras.end()) {
      return UsageError(scene.name + " has no camera '" + camera_name + "'; " +
                        (scene.cameras.empty() ? "it has none: leave the camera out to have the scene framed"
                                               : "there are: " + Names(scene.cameras)));
    }
    prepared.camera = *found;
  } else if (view || scene.cameras.empty()) {
    const ViewAngles angles = view.value_or(ViewAngles{});
    prepared.camera = FramingCamera(scene, angles, aspect);
    prepared.notes.push_back(FramingNote(scene, angles, view.has_value()));
  } else {
    prepared.camera = scene.cameras.front();
    if (scene.cameras.size() > 1) {
      prepared.notes.push_back("seen by camera '" + prepared.camera.name + "', the first of " + Names(scene.cameras));
    }
  }
  if (prepared.camera.border) prepared.notes.push_back(BorderNote(prepared.camera));
  const LightOf light = needs_light ? FindLight(scene) : LightOf::kLamps;
  if (light != LightOf::kLamps) {
    scene.lights.push_back(KeyLight(prepared.camera));
    std::ostringstream note;
    note << scene.name << (light == LightOf::kGlow ? " has no light but textures that glow" : " has no light")
         << ": lit by a sun at azimuth " << kKeyLightAzimuth << "°, elevation " << kKeyLightElevation
         << "° of the view";
    prepared.notes.push_back(note.str());
  }
  return prepared;
}

}  // namespace scumble
