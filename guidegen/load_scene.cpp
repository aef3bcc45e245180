#include "guidegen/load_scene.h"

#include <cctype>
#include <exception>
#include <new>
#include <stdexcept>
#include <system_error>

#include "guidegen/load_gltf.h"
#include "guidegen/load_obj.h"
#include "guidegen/load_ply.h"
#include "guidegen/loader_util.h"
#include "image/check.h"

namespace scumble {
namespace {

std::string LowerEnding(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

Expected<Scene> LoadByEnding(const std::filesystem::path& path) {
  const std::string ending = LowerEnding(path);
  if (ending == ".glb" || ending == ".gltf") return LoadGltfScene(path);
  if (ending == ".obj") return LoadObjScene(path);
  if (ending == ".ply") return LoadPlyScene(path);
  if (ending == ".blend") {
    return UnavailableError(path.string() + ": .blend files cannot be read directly: scumble guidegen and stylize have " +
                            "Blender export them; elsewhere, export the scene to .glb");
  }
  return InputError(path.string() + " has the ending '" + Excerpt(path.extension().string(), 40) +
                    "'; expected a scene in .glb, .gltf, .obj or .ply");
}

// What every loader promises about its scene (guidegen/scene.h).
void CheckPromises(const Scene& scene) {
  SCUMBLE_CHECK(!scene.materials.empty());
  for (const Mesh& mesh : scene.meshes) {
    SCUMBLE_CHECK_EQ(mesh.normals.size(), mesh.positions.size());
    SCUMBLE_CHECK(mesh.material >= 0 && std::size_t(mesh.material) < scene.materials.size());
  }
  for (const Instance& instance : scene.instances) {
    SCUMBLE_CHECK(instance.mesh >= 0 && std::size_t(instance.mesh) < scene.meshes.size());
  }
}

}  // namespace

Expected<Scene> LoadScene(const std::filesystem::path& path) {
  try {
    SCUMBLE_ASSIGN(Scene scene, LoadByEnding(path));
    scene.name = path.string();
    if (scene.materials.empty()) DefaultMaterial(scene);
    if (scene.instances.empty()) scene.warnings.push_back("there is no geometry in the scene, its picture is empty");
    CheckPromises(scene);
    return scene;
  } catch (const std::bad_alloc&) {
    return InputError(path.string() + " asks for more memory than there is: simplify the scene");
  } catch (const std::length_error&) {
    return InputError(path.string() + " asks for more memory than there is: simplify the scene");
  }
}

}  // namespace scumble
