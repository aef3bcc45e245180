// Scenes from files: glTF 2.0 (.glb, .gltf), Wavefront OBJ with MTL, PLY.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/file_listener.h"
#include "guidegen/scene.h"

namespace scumble {

enum class TextureLoading {
  kNow,         // the scene is complete
  kWhenNeeded,  // DecodeTextures is called before the scene is rendered, and reports damaged ones
};

struct LoadOptions {
  TextureLoading textures = TextureLoading::kNow;
  // Of normals that the file lacks (guidegen/load/auto_smooth.h): 0 … 180 degrees, 0: flat. Empty: glTF is flat, OBJ as
  // its smoothing groups say, other OBJ and PLY smooth up to kDefaultAutoSmooth. The scene's notes say what was done.
  std::optional<double> auto_smooth_degrees;
  FileListener on_file = nullptr;  // also where loading fails; null: nobody
};

// Loads by the file's ending. A scene without geometry is legal, with a warning. Errors name the file and the defect:
// unreadable, corrupt, an accessor that points outside its buffer, an index that points outside its attributes, a
// missing texture. Never reads outside the file's data. A moving scene is loaded at rest: nodes with their own
// transforms, skins and morph weights applied.
Expected<Scene> LoadScene(const std::filesystem::path& path, const LoadOptions& options = {});

struct AnimationOptions {
  std::string animation;  // by name; "": the file's first, "*": all of them at once
  LoadOptions load = {};
};

struct GltfRig;

// A scene over time: the file is parsed once and posed at any time. Static parts (textures, materials, shapes at rest)
// are loaded once and shared by all copies of the Scene. Formats without time, and glTF without an animation, are
// static scenes. Immutable once loaded; free to use from any thread.
class AnimatedScene {
 public:
  // Errors as LoadScene's, and those of the animation and the skins, which name the place. An unknown animation name is
  // a usage error that lists the file's names.
  static Expected<AnimatedScene> Load(const std::filesystem::path& path, const AnimationOptions& options = {});

  bool moves() const;
  const Scene& rest() const { return rest_; }  // as LoadScene returns it
  std::vector<Instance> objects() const;       // all that are visible at any time, as at rest
  double duration_seconds() const;             // of the last key, from 0; Blender puts frame N at N / fps
  const std::vector<std::string>& animations() const { return animations_; }  // the file's, by name

  // A copy at that time. Before the first key and after the last one the scene is static. The result depends on the
  // time alone, not on earlier calls. Fails where the animation is invalid at that time (a camera scaled to nothing).
  Expected<Scene> SceneAt(double seconds) const;

  // SceneAt in place, for sequences: `scene` came from SceneAt. Rewrites instances, matrices of the file's cameras and
  // lights, and deformed shapes. Lights and cameras appended after the file's stay, and textures are not changed. After
  // an error `scene` is only valid for another MoveTo.
  Status MoveTo(double seconds, Scene& scene) const;

 private:
  AnimatedScene() = default;

  Scene rest_;
  std::shared_ptr<const GltfRig> rig_;  // null: nothing moves
  std::vector<std::string> animations_;
};

}  // namespace scumble
