#include "guidegen/framing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
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

template <class Visit>
void ForEachPoint(const Scene& scene, Visit visit) {
  for (const Instance& instance : scene.instances) {
    for (const glm::vec3& position : scene.meshes[std::size_t(instance.mesh)].positions) {
      visit(glm::dvec3(instance.world_from_object * glm::dvec4(glm::dvec3(position), 1.0)));
    }
  }
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
  if (view.right != 0.0 || view.up != 0.0) note << ", moved " << view.right << " m right, " << view.up << " m up";
  return note.str();
}

std::string BorderNote(const Camera& camera) {
  const CameraBorder& border = *camera.border;
  if (!border.crop) return "drawn within the render border alone, the rest is background";
  return "the picture is the render border, to which it is cropped" +
         (camera.border_size.empty() ? "" : ": " + camera.border_size + " pixels in the file");
}

// The picture's height as a share of the side that the camera's angle or scale is of.
double VerticalShare(const Camera& camera, double aspect) {
  const bool horizontal = camera.fit == CameraFit::kHorizontal || (camera.fit == CameraFit::kLonger && aspect >= 1.0);
  if (horizontal) return 1.0 / aspect;
  if (camera.fit == CameraFit::kVertical && camera.aspect && *camera.aspect > aspect) return *camera.aspect / aspect;
  return 1.0;
}

// Half the picture's vertical angle of a perspective camera, in radians.
double HalfHeightOf(const Camera& camera, double aspect) {
  const double half = std::tan(0.5 * camera.yfov_degrees * kRadiansPerDegree);
  return std::atan(half * VerticalShare(camera, aspect));
}

Error WrongMember(const char* member, const char* expected, double found) {
  char text[120];
  std::snprintf(text, sizeof text, "%s must be %s, found %g", member, expected, found);
  return UsageError(text);
}

}  // namespace

Status CheckView(const ViewAngles& view) {
  SCUMBLE_RETURN_IF_ERROR(CheckLight({view.azimuth, view.elevation}));
  if (!(view.distance >= 0.0 && std::isfinite(view.distance)))
    return WrongMember("distance", "0 or more, finite", view.distance);
  if (!std::isfinite(view.right)) return WrongMember("right", "finite", view.right);
  if (!std::isfinite(view.up)) return WrongMember("up", "finite", view.up);
  if (!(view.fov >= 0.0 && view.fov < 180.0)) return WrongMember("fov", "0 to below 180", view.fov);
  return Ok();
}

Status CheckLight(const LightAngles& light) {
  if (!std::isfinite(light.azimuth)) return WrongMember("azimuth", "finite", light.azimuth);
  if (!(light.elevation >= -90.0 && light.elevation <= 90.0))
    return WrongMember("elevation", "-90 to 90", light.elevation);
  return Ok();
}

SceneSphere SphereAround(const Scene& scene) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  ForEachPoint(scene, [&](const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  });
  if (!(low.x <= high.x)) return {};
  SceneSphere sphere{0.5 * low + 0.5 * high, 0.0};
  ForEachPoint(scene,
               [&](const glm::dvec3& p) { sphere.radius = std::max(sphere.radius, glm::length(p - sphere.center)); });
  if (!(sphere.radius > 0.0)) sphere.radius = 1.0;
  return sphere;
}

Camera FramingCamera(const Scene& scene, const ViewAngles& view, double aspect) {
  SCUMBLE_CHECK(aspect > 0.0 && std::isfinite(aspect));
  const SceneSphere sphere = SphereAround(scene);
  const double yfov = view.fov > 0.0 ? view.fov : kFramingYfovDegrees;
  const double half_y = 0.5 * yfov * kRadiansPerDegree;
  const double half_narrow = std::min(half_y, std::atan(std::tan(half_y) * aspect));
  // The margin widens the picture, not the distance, so it is an equal share of the picture at any angle of view.
  const double half_framed = std::atan(std::tan(half_narrow) / kFramingMargin);
  const double distance = view.distance > 0.0 ? view.distance : sphere.radius / std::sin(half_framed);
  Camera camera;
  camera.name = "framing";
  camera.yfov_degrees = yfov;
  camera.world_from_camera = Facing(view.azimuth, view.elevation);
  const glm::dvec3 right(camera.world_from_camera[0]), up(camera.world_from_camera[1]);
  const glm::dvec3 back(camera.world_from_camera[2]);
  const glm::dvec3 target = sphere.center + view.right * right + view.up * up;
  camera.world_from_camera[3] = glm::dvec4(target + distance * back, 1.0);
  return camera;
}

ViewAngles OrbitOf(const SceneSphere& sphere, const Camera& camera, double aspect) {
  const glm::dmat4& world = camera.world_from_camera;
  const glm::dvec3 back = glm::normalize(glm::dvec3(world[2])), side(world[0]);
  ViewAngles view;
  view.elevation = std::asin(std::clamp(back.y, -1.0, 1.0)) / kRadiansPerDegree;
  // Straight up and straight down the direction has no azimuth, but the picture's right has.
  const bool level = std::hypot(back.x, back.z) > 1e-9;
  view.azimuth = (level ? std::atan2(back.x, back.z) : std::atan2(-side.z, side.x)) / kRadiansPerDegree;
  const glm::dmat4 facing = Facing(view.azimuth, view.elevation);
  const glm::dvec3 from_center = glm::dvec3(world[3]) - sphere.center;
  view.right = glm::dot(from_center, glm::dvec3(facing[0]));
  view.up = glm::dot(from_center, glm::dvec3(facing[1]));
  if (camera.orthographic) {
    constexpr double kFarAwayDegrees = 1.0;
    view.fov = kFarAwayDegrees;
    view.distance = camera.ymag * VerticalShare(camera, aspect) / std::tan(0.5 * kFarAwayDegrees * kRadiansPerDegree);
    return view;
  }
  view.distance = std::max(glm::dot(from_center, back), 1e-6 * sphere.radius);
  view.fov = 2.0 * HalfHeightOf(camera, aspect) / kRadiansPerDegree;
  return view;
}

Light KeyLight(const Camera& camera, double azimuth, double elevation) {
  Light light;
  light.name = "key";
  light.type = LightType::kSun;
  light.intensity = pi;
  light.world_from_light = camera.world_from_camera * Facing(azimuth, elevation);
  return light;
}

void ReplaceLights(Scene& scene, const Camera& camera, const LightAngles& light) {
  scene.lights = {KeyLight(camera, light.azimuth, light.elevation)};
  scene.world_radiance = glm::vec3(0.0f);
  scene.has_own_lights = false;
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
  } else if (!view && !scene.lost_camera.empty()) {
    return InputError(scene.name + ": its active camera " + scene.lost_camera + ": give " +
                      (scene.cameras.empty() ? "" : "--camera NAME, of " + Names(scene.cameras) + ", or ") + "--view");
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
