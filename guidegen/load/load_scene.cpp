#include "guidegen/load_scene.h"

#include <cctype>
#include <cmath>
#include <exception>
#include <new>
#include <stdexcept>
#include <system_error>

#include "core/image/check.h"
#include "guidegen/load/gltf/gltf_scene.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/load/obj/obj.h"
#include "guidegen/load/ply.h"
#include "guidegen/scene_textures.h"

namespace scumble {
namespace {

std::string LowerEnding(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

MissingNormals MissingNormalsOf(const LoadOptions& options) {
  const std::optional<double>& degrees = options.auto_smooth_degrees;
  SCUMBLE_CHECK(!degrees || (*degrees >= 0.0 && *degrees <= 180.0));
  return MissingNormals(degrees);
}

// options.on_file, or a listener that does nothing. The scene's own file is told of first.
FileListener ListenerOf(const std::filesystem::path& path, const LoadOptions& options) {
  if (!options.on_file) return [](const std::filesystem::path&) {};
  options.on_file(path);
  return options.on_file;
}

Expected<Scene> LoadByEnding(const std::filesystem::path& path, const LoadOptions& options) {
  const std::string ending = LowerEnding(path);
  const MissingNormals missing = MissingNormalsOf(options);
  const FileListener on_file = ListenerOf(path, options);
  if (ending == ".glb" || ending == ".gltf") return LoadGltfScene(path, missing, on_file);
  if (ending == ".obj") return LoadObjScene(path, missing, on_file);
  if (ending == ".ply") return LoadPlyScene(path, missing, on_file);
  if (ending == ".blend") {
    return UnavailableError(path.string() +
                            ": .blend files cannot be read directly: scumble guidegen and stylize have " +
                            "Blender export them; elsewhere, export the scene to .glb");
  }
  return InputError(path.string() + " has the ending '" + Excerpt(path.extension().string(), 40) +
                    "'; expected a scene in .glb, .gltf, .obj or .ply");
}

// Checks the contract of every loader about its scene (guidegen/scene.h).
void CheckContract(const Scene& scene) {
  SCUMBLE_CHECK(!scene.materials.empty());
  for (const Mesh& mesh : scene.meshes) {
    SCUMBLE_CHECK_EQ(mesh.normals.size(), mesh.IsCurves() ? 0 : mesh.positions.size());
    SCUMBLE_CHECK(mesh.triangles.empty() || !mesh.IsCurves());
    SCUMBLE_CHECK(mesh.material >= 0 && std::size_t(mesh.material) < scene.materials.size());
  }
  for (const Instance& instance : scene.instances) {
    SCUMBLE_CHECK(instance.mesh >= 0 && std::size_t(instance.mesh) < scene.meshes.size());
  }
}

// Calls load() and turns each kind of memory exhaustion into an error.
template <class Load>
auto WithinMemory(const std::filesystem::path& path, Load load) -> decltype(load()) {
  try {
    return load();
  } catch (const std::bad_alloc&) {
    return MemoryError(path.string() + " asks for more memory than there is: simplify the scene");
  } catch (const std::length_error&) {
    return InputError(path.string() +
                      " promises more of something than any file can hold: one of its sizes is wrong, export it again");
  }
}

Status Finish(const std::filesystem::path& path, bool has_geometry, TextureLoading textures, Scene& scene) {
  scene.name = path.string();
  if (scene.materials.empty()) DefaultMaterial(scene);
  if (!has_geometry) scene.warnings.push_back("there is no geometry in the scene, its picture is empty");
  CheckContract(scene);
  if (textures == TextureLoading::kWhenNeeded) return Ok();
  SCUMBLE_ASSIGN(const DecodedTextures decoded, DecodeAllTextures(scene));
  scene.warnings.insert(scene.warnings.end(), decoded.warnings.begin(), decoded.warnings.end());
  return Ok();
}

}  // namespace

Expected<Scene> LoadScene(const std::filesystem::path& path, const LoadOptions& options) {
  return WithinMemory(path, [&]() -> Expected<Scene> {
    SCUMBLE_ASSIGN(Scene scene, LoadByEnding(path, options));
    SCUMBLE_RETURN_IF_ERROR(Finish(path, !scene.instances.empty(), options.textures, scene));
    return scene;
  });
}

Expected<AnimatedScene> AnimatedScene::Load(const std::filesystem::path& path, const AnimationOptions& options) {
  return WithinMemory(path, [&]() -> Expected<AnimatedScene> {
    AnimatedScene animated;
    const std::string ending = LowerEnding(path);
    if (ending != ".glb" && ending != ".gltf") {
      SCUMBLE_ASSIGN(animated.rest_, LoadScene(path, options.load));
      if (options.animation.empty() || options.animation == "*") return animated;
      return UsageError(path.string() + " has no animation \"" + Excerpt(options.animation, 80) +
                        "\": only .glb and .gltf files have any");
    }
    SCUMBLE_ASSIGN(MovingScene loaded, LoadMovingGltfScene(path, options.animation, MissingNormalsOf(options.load),
                                                           ListenerOf(path, options.load)));
    animated.rest_ = std::move(loaded.scene);
    animated.animations_ = std::move(loaded.animations);
    SCUMBLE_RETURN_IF_ERROR(Finish(path, !loaded.rig.instances.empty(), options.load.textures, animated.rest_));
    if (!loaded.rig.animation.empty()) animated.rig_ = std::make_shared<const GltfRig>(std::move(loaded.rig));
    return animated;
  });
}

bool AnimatedScene::moves() const { return rig_ != nullptr; }

std::vector<Instance> AnimatedScene::objects() const {
  if (!rig_) return rest_.instances;
  std::vector<Instance> all;
  for (const RigInstance& one : rig_->instances) all.push_back(one.instance);
  return all;
}

double AnimatedScene::duration_seconds() const { return rig_ ? rig_->animation.duration_seconds() : 0.0; }

Expected<Scene> AnimatedScene::SceneAt(double seconds) const {
  return WithinMemory(rest_.name, [&]() -> Expected<Scene> {
    Scene scene = rest_;
    SCUMBLE_RETURN_IF_ERROR(MoveTo(seconds, scene));
    return scene;
  });
}

Status AnimatedScene::MoveTo(double seconds, Scene& scene) const {
  if (!std::isfinite(seconds)) return UsageError("a scene cannot be seen at " + std::to_string(seconds) + " s");
  if (!rig_) return Ok();
  SCUMBLE_CHECK_EQ(scene.meshes.size(), rest_.meshes.size());
  SCUMBLE_CHECK(scene.cameras.size() >= rest_.cameras.size());
  if (!scene.has_own_lights) {  // lights in place of the file's do not move with its nodes
    std::vector<Light> others = std::exchange(scene.lights, rest_.lights);
    const Status posed = rig_->Pose(seconds, scene);
    scene.lights = std::move(others);
    return posed;
  }
  SCUMBLE_CHECK(scene.lights.size() >= rest_.lights.size());
  return rig_->Pose(seconds, scene);
}

}  // namespace scumble
