#include <algorithm>
#include <glm/gtc/constants.hpp>
#include <string>
#include <vector>

#include "core/image/direction.h"
#include "guidegen/cast/cast_guides.h"
#include "guidegen/guidegen.h"
#include "guidegen/surface/bsdf.h"

namespace scumble {
namespace {

// From the viewer to the sphere's centre: the nearest point of the sphere is 1 m away.
constexpr double kDistance = 2.0;

Camera SphereCamera() {
  Camera camera;
  camera.name = "sphere";
  camera.orthographic = true;
  camera.ymag = 1.0;
  camera.world_from_camera[3] = glm::dvec4(0.0, 0.0, kDistance, 1.0);
  return camera;
}

// It shines down its −Z, so its +Z points to the light's direction.
Light SphereSun(const SphereOptions& options) {
  Light sun;
  sun.name = "key";
  sun.type = LightType::kSun;
  sun.intensity = glm::pi<double>();
  sun.world_from_light[2] = glm::dvec4(DirectionFromAngles(options.light_azimuth, options.light_elevation), 0.0);
  return sun;
}

Expected<GuidegenResult> Render(const SphereOptions& options, const Material& material) {
  GuidegenOptions cast;
  cast.width = cast.height = options.size;
  cast.layers = options.layers;
  cast.aa = options.aa;
  cast.threads = options.threads;
  cast.isa = options.isa;
  SCUMBLE_RETURN_IF_ERROR(CheckOptions(cast));

  View view;
  view.bends_normals = false;  // a sphere is its own geometry
  SCUMBLE_ASSIGN(view.camera, CameraRays::Make(SphereCamera(), options.size, options.size));
  SCUMBLE_ASSIGN(view.lights, PlaceLights({SphereSun(options)}, view.camera));
  view.key_lamp = KeyLamp{true, -view.lights[0].axis};
  view.supply.light = true;
  view.supply.diffuse = MayBeDiffuse(material), view.supply.specular = MayBeSpecular(material);
  PlacedObject sphere = Place(nullptr, &material, {}, view.camera.ViewFromObject(glm::dmat4(1.0)));
  const std::vector<std::string> names = {"sphere"};
  const std::uint32_t id = IdsForNames(names)[0];
  sphere.object_id = id;
  sphere.material_id = id;
  LazyScene objects([&] { return std::vector<PlacedObject>{sphere}; });
  SCUMBLE_ASSIGN(GuidegenResult result, CastGuides(objects, view, cast));
  result.guides.object_names = {{id, names[0]}};
  result.guides.material_names = {{id, names[0]}};
  return result;
}

}  // namespace

Expected<GuidegenResult> RenderSphereGuides(const SphereOptions& options) {
  Material matt;
  matt.bsdf = Bsdf::kDiffuse;
  SCUMBLE_ASSIGN(GuidegenResult result, Render(options, matt));
  if (!options.layers.Has(Layer::kLpeLSE)) return result;
  Material glossy;  // as Blender's Principled BSDF is at first
  glossy.bsdf = Bsdf::kMetallicRoughness;
  glossy.roughness = 0.5f;
  SphereOptions highlight = options;
  highlight.layers = {Layer::kLpeLSE};
  SCUMBLE_ASSIGN(const GuidegenResult more, Render(highlight, glossy));
  for (int c = 0; c < ChannelCount(Layer::kLpeLSE); ++c)
    std::ranges::copy(more.guides.Plane(Layer::kLpeLSE, c), result.guides.Plane(Layer::kLpeLSE, c).begin());
  return result;
}

}  // namespace scumble
