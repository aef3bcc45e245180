// Scenes from files: glTF 2.0 (.glb, .gltf), Wavefront OBJ with MTL, PLY.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/scene/scene.h"

namespace scumble {

enum class TextureLoading {
  kNow,         // the scene is complete
  kWhenNeeded,  // DecodeTextures is called before the scene is rendered, and tells what is wrong with them
};

// Loads by the file's ending. Missing normals are made smooth, weighted by angle. A scene without geometry is legal
// (a warning says so). Errors name the file and what is wrong with it: unreadable, corrupt, an accessor that points
// outside its buffer, an index that points outside its attributes, a texture that is missing. Never reads outside the
// file's data. A scene that moves is seen at rest: its nodes as they stand, skins and morph weights applied.
Expected<Scene> LoadScene(const std::filesystem::path& path, TextureLoading textures = TextureLoading::kNow);

struct AnimationOptions {
  std::string animation;  // by name; "": the file's first, "*": all of them at once
  TextureLoading textures = TextureLoading::kNow;
};

struct GltfRig;

// A scene over time: the file is parsed once, then it can be seen at any time. What does not move (textures, materials,
// shapes at rest) is loaded once and kept by whoever holds the Scene. Files that know no time, and glTF without an
// animation, are scenes that stand still. Immutable once loaded; free to use from any thread.
class AnimatedScene {
 public:
  // Errors as LoadScene has them, and those of the animation and the skins, which name the place. An unknown animation
  // name is a usage error that lists the names there are.
  static Expected<AnimatedScene> Load(const std::filesystem::path& path, const AnimationOptions& options = {});

  bool moves() const;
  const Scene& rest() const { return rest_; }  // as LoadScene sees it
  std::vector<Instance> objects() const;       // all that are seen at any time, as at rest
  double duration_seconds() const;             // of the last key, from 0; Blender puts frame N at N / fps
  const std::vector<std::string>& animations() const { return animations_; }  // the file's, by name

  // A copy at that time. Before the first key and after the last one everything stands still. The result depends on
  // the time alone, not on what was asked before. Fails where the animation has no sense at that time (a camera scaled
  // to nothing).
  Expected<Scene> SceneAt(double seconds) const;

  // The same in place, for sequences: `scene` came from SceneAt. Rewrites instances, matrices of cameras and lights of
  // the file, and deformed shapes; lights and cameras that were added behind the file's stay, and textures are not
  // touched. After an error `scene` is only good for another MoveTo.
  Status MoveTo(double seconds, Scene& scene) const;

 private:
  AnimatedScene() = default;

  Scene rest_;
  std::shared_ptr<const GltfRig> rig_;  // null: nothing moves
  std::vector<std::string> animations_;
};

}  // namespace scumble
