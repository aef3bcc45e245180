// glTF 2.0 scenes, binary (.glb) and text (.gltf), by tinygltf. Use LoadScene (guidegen/load_scene.h), which also
// does the work common to all formats.
//
// Read: the default scene's node hierarchy; triangles, strips and fans; every component type, sparse accessors and
// strides; base colour, its texture, vertex colours, normal maps, alpha modes; both kinds of camera;
// KHR_lights_punctual, KHR_texture_transform, KHR_mesh_quantization, KHR_node_visibility; EXT_mesh_gpu_instancing, each
// copy an object of its own; skins, morph targets and animations;
// KHR_materials_pbrSpecularGlossiness in part, with a warning. Ignored with a warning: points, lines, the range of
// lights (Blender's lights have none). A mesh without normals, or with none that has a direction, is flat, as glTF
// demands, unless the user says otherwise. A file that *requires* another extension is refused by the extension's name.
//
// An object is named after its node. Where several nodes have one name, the first in the file's list keeps it and the
// others take their path, "Parent/Name", then "Parent/Name#2", …: the additions rename no other object. Names of more
// than 512 MiB in total, counted for each copy, are refused.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/file_listener.h"
#include "guidegen/load/auto_smooth.h"
#include "guidegen/load/gltf/rig.h"
#include "guidegen/scene.h"

namespace scumble {

// At rest: nodes as they stand, skins and morph weights applied.
Expected<Scene> LoadGltfScene(const std::filesystem::path& path, MissingNormals missing, const FileListener& on_file);

struct MovingScene {
  Scene scene;  // at rest
  GltfRig rig;
  std::vector<std::string> animations;  // their names
};
// `animation` as in GltfAnimation::Read.
Expected<MovingScene> LoadMovingGltfScene(const std::filesystem::path& path, const std::string& animation,
                                          MissingNormals missing, const FileListener& on_file);

}  // namespace scumble
