#include "guidegen/load/gltf/camera_light.h"

#include <tiny_gltf.h>

#include <cmath>
#include <utility>

#include "guidegen/load/gltf/gltf_extras.h"
#include "guidegen/load/gltf/nodes.h"

namespace scumble {
namespace {

constexpr double kLumensPerWatt = 683.0;

// Reads KHR_lights_punctual, without the light's place.
Expected<Light> ReadPunctualLight(const tinygltf::Model& model, const std::string& file, const RigNode& visit,
                                  int index, WarningCounter& warnings) {
  const auto bad = [&](const std::string& what) {
    return InputError(file + ": the light of " + NodeLabel(model, visit.node) + " " + what + ": export it again");
  };
  if (index < 0 || std::size_t(index) >= model.lights.size()) return bad("does not exist");
  const tinygltf::Light& from = model.lights[std::size_t(index)];
  Light light;
  light.name = from.name.empty() ? "light_" + std::to_string(index) : from.name;
  if (from.type == "directional") {
    light.type = LightType::kSun;
  } else if (from.type == "spot") {
    light.type = LightType::kSpot;
  } else if (from.type != "point") {
    return bad("is of the unknown type '" + Excerpt(from.type, 40) + "'");
  }
  if (!from.color.empty()) {
    if (from.color.size() != 3) return bad("has a colour that is not 3 numbers");
    light.color = glm::vec3(from.color[0], from.color[1], from.color[2]);
  }
  light.intensity = from.intensity / kLumensPerWatt;
  if (light.type != LightType::kSun && from.range > 0.0) {
    warnings.Add("the range of lights is ignored, they reach as far as physics has it", NodeLabel(model, visit.node));
  }
  if (!IsFinite(light.color) || glm::any(glm::lessThan(light.color, glm::vec3(0.0f)))) return bad("has a wrong colour");
  if (!std::isfinite(light.intensity) || light.intensity < 0.0) return bad("has a wrong intensity");
  light.inner_cone_degrees = from.spot.innerConeAngle * kDegreesPerRadian;
  light.outer_cone_degrees = from.spot.outerConeAngle * kDegreesPerRadian;
  if (light.type == LightType::kSpot && !(light.inner_cone_degrees >= 0.0 && light.outer_cone_degrees <= 90.0 + 1e-6 &&
                                          light.inner_cone_degrees <= light.outer_cone_degrees)) {
    return bad("has wrong cone angles");
  }
  return light;
}

// Places a light at its node, whose name it takes if there is one.
Expected<Light> PlaceLight(const tinygltf::Model& model, const std::string& file, const RigNode& visit, Light light) {
  const std::string& name = model.nodes[std::size_t(visit.node)].name;
  if (!name.empty()) light.name = name;
  const std::optional<glm::dmat4> world = WithoutScale(visit.world);
  if (!world) {
    return InputError(file + ": the light of " + NodeLabel(model, visit.node) +
                      " is scaled or sheared until it has no direction: export it again");
  }
  light.world_from_light = *world;
  return light;
}

}  // namespace

Expected<Camera> ReadCamera(const tinygltf::Model& model, const std::string& file, const RigNode& visit) {
  const int index = model.nodes[std::size_t(visit.node)].camera;
  const auto bad = [&](const std::string& what) {
    return InputError(file + ": the camera of " + NodeLabel(model, visit.node) + " " + what + ": export it again");
  };
  if (std::size_t(index) >= model.cameras.size()) return bad("does not exist");
  const tinygltf::Camera& from = model.cameras[std::size_t(index)];
  Camera camera;
  camera.name = model.nodes[std::size_t(visit.node)].name;
  if (camera.name.empty()) camera.name = from.name.empty() ? "camera_" + std::to_string(index) : from.name;
  camera.orthographic = from.type == "orthographic";
  if (camera.orthographic) {
    const auto& lens = from.orthographic;
    camera.ymag = std::abs(lens.ymag);
    camera.aspect = std::abs(lens.xmag) / camera.ymag;
    camera.z_near = lens.znear;
    camera.z_far = lens.zfar;
    if (!(camera.ymag > 0.0) || !std::isfinite(camera.ymag)) return bad("has a height of zero");
  } else {
    const auto& lens = from.perspective;
    camera.yfov_degrees = lens.yfov * kDegreesPerRadian;
    if (lens.aspectRatio != 0.0) camera.aspect = lens.aspectRatio;
    camera.z_near = lens.znear;
    if (lens.zfar != 0.0) camera.z_far = lens.zfar;
    if (!(camera.yfov_degrees > 0.0) || !(camera.yfov_degrees < 180.0)) {
      return bad("has a vertical angle of " + std::to_string(camera.yfov_degrees) + "°, expected 0 … 180");
    }
  }
  if (camera.aspect && (!(*camera.aspect > 0.0) || !std::isfinite(*camera.aspect))) return bad("has no proportions");
  if (!(camera.z_near >= 0.0) || !(camera.z_far > camera.z_near)) return bad("has its far plane before its near one");
  const std::optional<glm::dmat4> world = WithoutScale(visit.world);
  if (!world) return bad("is scaled or sheared until it has no direction");
  SCUMBLE_RETURN_IF_ERROR(
      ReadCameraExtras(model.nodes[std::size_t(visit.node)], file + ": " + NodeLabel(model, visit.node), camera));
  camera.world_from_camera = *world;
  return camera;
}

Expected<std::optional<Light>> ReadLight(const tinygltf::Model& model, const std::string& file, const RigNode& visit,
                                         WarningCounter& warnings) {
  const tinygltf::Node& node = model.nodes[std::size_t(visit.node)];
  SCUMBLE_ASSIGN(std::optional<Light> light, ReadLightExtras(node, file + ": " + NodeLabel(model, visit.node)));
  if (!light) {
    const std::optional<int> index = LightOf(node);
    if (!index) return std::optional<Light>();
    SCUMBLE_ASSIGN(light, ReadPunctualLight(model, file, visit, *index, warnings));
  }
  SCUMBLE_ASSIGN(Light placed, PlaceLight(model, file, visit, *std::move(light)));
  return std::optional(std::move(placed));
}

}  // namespace scumble
