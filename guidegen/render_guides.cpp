#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/image/check.h"
#include "guidegen/cast/cast_guides.h"
#include "guidegen/guidegen.h"
#include "guidegen/load/mesh_normals.h"
#include "guidegen/path_layers.h"
#include "guidegen/scene_textures.h"

namespace scumble {
namespace {

// The contract of loaders: a file's own mistakes never get here.
void CheckMesh(const Mesh& mesh, const Scene& scene) {
  const std::size_t count = mesh.positions.size();
  const auto fits = [&](std::size_t size) { return size == 0 || size == count; };
  SCUMBLE_CHECK(fits(mesh.normals.size()) && fits(mesh.tangents.size()) && fits(mesh.colors.size()));
  SCUMBLE_CHECK(fits(mesh.rest_positions.size()));
  SCUMBLE_CHECK(fits(mesh.uvs[0].size()) && fits(mesh.uvs[1].size()));
  SCUMBLE_CHECK(mesh.material >= 0 && std::size_t(mesh.material) < scene.materials.size());
  bool inside = true;
  for (const glm::uvec3& triangle : mesh.triangles) {
    inside = inside && triangle.x < count && triangle.y < count && triangle.z < count;
  }
  SCUMBLE_CHECK(inside);
}

void CheckMaterial(const Material& material, const Scene& scene) {
  for (const TextureUse* use :
       {&material.base_color_texture, &material.normal_texture, &material.metallic_roughness_texture,
        &material.emission_texture, &material.bump.height_texture}) {
    SCUMBLE_CHECK(use->texture < 0 || std::size_t(use->texture) < scene.textures.size());
    SCUMBLE_CHECK(use->uv_set == 0 || use->uv_set == 1);
  }
}

// The caller has decoded all needed textures (guidegen/scene_textures.h): white instead would be a silent error.
void CheckTextures(const Scene& scene, const GuidegenOptions& options) {
  const std::vector<bool> needed = NeededTextures(scene, options);
  for (std::size_t i = 0; i < std::min(needed.size(), scene.encoded_textures.size()); ++i) {
    SCUMBLE_CHECK(!needed[i] || !scene.encoded_textures[i]);
  }
}

bool NeedsLight(const LayerSet& layers) {
  for (const LayerInfo& info : AllLayers()) {
    const bool lit = info.layer == Layer::kLuminance || info.layer == Layer::kShadow || info.layer == Layer::kCosine ||
                     PathLayerExpression(info.layer);
    if (lit && layers.Has(info.layer)) return true;
  }
  return false;
}

// Luminance and shadow are cast at once: no pass follows that could take more samples.
Status CheckOpenEnd(const GuidegenOptions& options, const PathSupply& supply) {
  const bool sampled =
      supply.may_be_met && (options.layers.Has(Layer::kLuminance) || options.layers.Has(Layer::kShadow));
  if (!sampled || (options.noise <= 0.0 && options.time_budget_seconds <= 0.0)) return Ok();
  return UsageError(std::string(options.noise > 0.0 ? "a limit of the noise" : "a time budget") +
                    " is for lpe.* layers; luminance and shadow under lights with extent take samples of their own: "
                    "make these two in a run without it");
}

Status CheckRadiance(const std::string& who, const glm::vec3& radiance) {
  for (int i = 0; i < 3; ++i) {
    if (radiance[i] >= 0.0f && std::isfinite(radiance[i])) continue;
    return InputError(who + " has the radiance " + std::to_string(radiance[i]) + ": give it one of 0 or more");
  }
  return Ok();
}

Status CheckEmission(const Scene& scene) {
  for (const Material& material : scene.materials) {
    SCUMBLE_RETURN_IF_ERROR(CheckRadiance("material \"" + material.name + "\"", material.emission));
  }
  return CheckRadiance("the world of " + scene.name, scene.world_radiance);
}

std::vector<std::string> ObjectNames(const Scene& scene) {
  std::vector<std::string> names;
  for (const Instance& instance : scene.instances) names.push_back(instance.object);
  return names;
}

std::vector<std::string> MaterialNames(const Scene& scene) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const std::string& name = scene.materials[i].name;
    names.push_back(name.empty() ? "material_" + std::to_string(i) : name);
  }
  return names;
}

std::map<std::uint32_t, std::string> NamesById(const std::vector<std::uint32_t>& ids,
                                               const std::vector<std::string>& names) {
  std::map<std::uint32_t, std::string> result;
  for (std::size_t i = 0; i < ids.size(); ++i) result[ids[i]] = names[i];
  return result;
}

// Whether each triangle of a mesh is the same piece of surface in the next frame. Exporters merge the vertices at one
// place whose normals are equal, and sort the others by normal, so that a mesh that bends may have other vertices in
// each frame. Then equal triangles are those whose corners meet in the same way: at places at rest where both have
// them.
bool SameTriangles(const Mesh& now, const Mesh& next) {
  if (now.curves.segments != next.curves.segments || now.triangles.size() != next.triangles.size()) return false;
  if (now.triangles == next.triangles) return true;
  const bool rest = !now.rest_positions.empty() && !next.rest_positions.empty();
  const std::vector<std::uint32_t> place = WeldByPosition(rest ? now.rest_positions : now.positions);
  const std::vector<std::uint32_t> next_place = WeldByPosition(rest ? next.rest_positions : next.positions);
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> becomes(place.size(), kNone), was(next_place.size(), kNone);
  for (std::size_t t = 0; t < now.triangles.size(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t from = place[now.triangles[t][corner]], to = next_place[next.triangles[t][corner]];
      if (becomes[from] == kNone && was[to] == kNone) becomes[from] = to, was[to] = from;
      if (becomes[from] != to || was[to] != from) return false;
    }
  }
  return true;
}

// This frame's triangles at the next frame's places, which are found by the places at rest: Blender cuts polygons by
// the deformed shape, along other diagonals in each frame. A vertex whose place the next frame lacks, or has torn
// apart, is NaN. Empty if a mesh has no places at rest.
std::optional<Mesh> FollowByRest(const Mesh& now, const Mesh& next) {
  if (now.IsCurves() || next.IsCurves() || now.rest_positions.empty() || next.rest_positions.empty()) return {};
  const std::size_t count = now.positions.size();
  std::vector<glm::vec3> rest = now.rest_positions;
  rest.insert(rest.end(), next.rest_positions.begin(), next.rest_positions.end());
  const std::vector<std::uint32_t> place = WeldByPosition(rest);
  std::vector<std::optional<glm::vec3>> places(rest.size());
  const glm::vec3 nowhere(std::numeric_limits<float>::quiet_NaN());
  for (std::size_t v = 0; v < next.positions.size(); ++v) {
    std::optional<glm::vec3>& to = places[place[count + v]];
    to = !to || *to == next.positions[v] ? next.positions[v] : nowhere;
  }
  Mesh followed;
  followed.triangles = now.triangles;
  for (std::size_t v = 0; v < count; ++v) followed.positions.push_back(places[place[v]].value_or(nowhere));
  return followed;
}

// The lamp is chosen in the world, so that the camera has no say in which of equal ones it is.
void PlaceKeyLamp(const Scene& scene, View& view) {
  view.key_lamp = FindKeyLamp(scene);
  if (!view.key_lamp) return;
  glm::dvec3& at = view.key_lamp->at;
  at = view.key_lamp->endless ? view.camera.DirectionToView(at) : view.camera.ViewFromWorld(at);
}

// Each instance's name, and how many before it have that name: an object has one for each of its materials. The index
// of a mesh is no name, because an object that appears moves all that follow.
std::vector<std::pair<std::string, int>> PartNames(const Scene& scene) {
  std::map<std::string, int> count;
  std::vector<std::pair<std::string, int>> names;
  for (const Instance& instance : scene.instances) names.emplace_back(instance.object, count[instance.object]++);
  return names;
}

// The instances of the next frame in the order of this one's. The view borrows from `followed`.
Status PlaceNextFrame(const Scene& scene, const NextFrame& next, const GuidegenOptions& options,
                      std::deque<Mesh>& followed, View& view) {
  SCUMBLE_ASSIGN(view.next_camera, CameraRays::Make(next.camera, options.width, options.height));
  const std::vector<std::pair<std::string, int>> names = PartNames(scene), next_names = PartNames(next.scene);
  std::map<std::pair<std::string, int>, const Instance*> by_name;
  for (std::size_t i = 0; i < next_names.size(); ++i) by_name.emplace(next_names[i], &next.scene.instances[i]);
  for (std::size_t i = 0; i < names.size(); ++i) {
    PlacedObject placed;
    const auto found = by_name.find(names[i]);
    if (found != by_name.end()) {
      const Mesh& now = scene.meshes[std::size_t(scene.instances[i].mesh)];
      const Mesh& mesh = next.scene.meshes[std::size_t(found->second->mesh)];
      // Other triangles mean a different object under an old name, or faces that were cut along other diagonals.
      if (SameTriangles(now, mesh)) {
        placed.mesh = &mesh;
      } else if (std::optional<Mesh> made = FollowByRest(now, mesh)) {
        placed.mesh = &followed.emplace_back(*std::move(made));
      }
      if (placed.mesh) placed.view_from_object = view.next_camera.ViewFromObject(found->second->world_from_object);
    }
    view.next_objects.push_back(placed);
  }
  return Ok();
}

// Data that a transfer looks up by id: names, and the styles that the scene's author assigned.
void AddNames(const Scene& scene, const std::vector<std::uint32_t>& object_ids,
              const std::vector<std::uint32_t>& material_ids, GuideSet& guides) {
  guides.object_names = NamesById(object_ids, ObjectNames(scene));
  guides.material_names = NamesById(material_ids, MaterialNames(scene));
  for (std::size_t i = 0; i < object_ids.size(); ++i) {
    if (!scene.instances[i].style.empty()) guides.object_styles[object_ids[i]] = scene.instances[i].style;
  }
  for (std::size_t i = 0; i < material_ids.size(); ++i) {
    if (!scene.materials[i].style.empty()) guides.material_styles[material_ids[i]] = scene.materials[i].style;
  }
}

std::vector<PlacedObject> PlaceObjects(const Scene& scene, const CameraPose& camera,
                                       const std::vector<std::uint32_t>& object_ids,
                                       const std::vector<std::uint32_t>& material_ids) {
  std::vector<PlacedObject> objects;
  objects.reserve(scene.instances.size());
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    const auto material = std::size_t(mesh.material);
    PlacedObject object =
        Place(&mesh, &scene.materials[material], scene.textures, camera.ViewFromObject(instance.world_from_object));
    object.bump_axis = camera.DirectionToView(object.bump_axis);
    object.object_id = object_ids[i];
    object.material_id = material_ids[material];
    objects.push_back(object);
  }
  return objects;
}

}  // namespace

struct RayScene::State {
  State(const Scene& borrowed, const Camera& seen_by, const CameraPose& stands)
      : scene(borrowed),
        camera(seen_by),
        pose(stands),
        object_ids(IdsForNames(ObjectNames(borrowed))),
        material_ids(IdsForNames(MaterialNames(borrowed))),
        objects([this] { return PlaceObjects(scene, pose, object_ids, material_ids); }) {}

  const Scene& scene;
  const Camera camera;
  const CameraPose pose;
  const std::vector<std::uint32_t> object_ids;    // by instance
  const std::vector<std::uint32_t> material_ids;  // by material
  LazyScene objects;                              // locks itself
};

RayScene::RayScene(std::unique_ptr<State> state) : state_(std::move(state)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

Expected<RayScene> RayScene::Make(const Scene& scene, const Camera& camera) {
  for (const Material& material : scene.materials) CheckMaterial(material, scene);
  for (const Mesh& mesh : scene.meshes) CheckMesh(mesh, scene);
  for (const Instance& instance : scene.instances) {
    SCUMBLE_CHECK(instance.mesh >= 0 && std::size_t(instance.mesh) < scene.meshes.size());
  }
  SCUMBLE_ASSIGN(const CameraPose pose, CameraPose::Make(camera));
  return RayScene(std::make_unique<State>(scene, camera, pose));
}

struct RayCast {
  // `next` may be null.
  static Expected<GuidegenResult> Render(const RayScene& ray_scene, const NextFrame* next,
                                         const GuidegenOptions& options) {
    SCUMBLE_RETURN_IF_ERROR(CheckOptions(options, next != nullptr));
    RayScene::State& state = *ray_scene.state_;
    const Scene& scene = state.scene;
    CheckTextures(scene, options);

    std::deque<Mesh> followed;
    View view;
    view.bends_normals = !options.raw_normals;
    SCUMBLE_ASSIGN(view.camera, CameraRays::Make(state.camera, options.width, options.height));
    if (NeedsLight(options.layers)) {
      SCUMBLE_ASSIGN(view.lights, PlaceLights(scene.lights, view.camera));
      SCUMBLE_RETURN_IF_ERROR(CheckEmission(scene));
      view.world_radiance = scene.world_radiance;
      view.supply = SupplyOf(scene);
      SCUMBLE_RETURN_IF_ERROR(CheckOpenEnd(options, view.supply));
      if (options.layers.Has(Layer::kCosine)) PlaceKeyLamp(scene, view);
    }
    if (next && options.layers.Has(Layer::kMotion)) {
      for (const Mesh& mesh : next->scene.meshes) CheckMesh(mesh, next->scene);
      SCUMBLE_RETURN_IF_ERROR(PlaceNextFrame(scene, *next, options, followed, view));
    }
    SCUMBLE_ASSIGN(GuidegenResult result, CastGuides(state.objects, view, options));
    AddNames(scene, state.object_ids, state.material_ids, result.guides);
    return result;
  }

  // Options are checked before the scene.
  static Expected<GuidegenResult> RenderOnce(const Scene& scene, const Camera& camera, const NextFrame* next,
                                             const GuidegenOptions& options) {
    SCUMBLE_RETURN_IF_ERROR(CheckOptions(options, next != nullptr));
    SCUMBLE_ASSIGN(const RayScene ray_scene, RayScene::Make(scene, camera));
    return Render(ray_scene, next, options);
  }
};

Expected<GuidegenResult> RenderGuides(const Scene& scene, const Camera& camera, const GuidegenOptions& options) {
  return RayCast::RenderOnce(scene, camera, nullptr, options);
}

Expected<GuidegenResult> RenderGuides(const Scene& scene, const Camera& camera, const NextFrame& next,
                                      const GuidegenOptions& options) {
  return RayCast::RenderOnce(scene, camera, &next, options);
}

Expected<GuidegenResult> RenderGuides(const RayScene& scene, const GuidegenOptions& options) {
  return RayCast::Render(scene, nullptr, options);
}

Expected<GuidegenResult> RenderGuides(const RayScene& scene, const NextFrame& next, const GuidegenOptions& options) {
  return RayCast::Render(scene, &next, options);
}

}  // namespace scumble
