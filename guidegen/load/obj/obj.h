// Wavefront OBJ with MTL, by tinyobjloader. Use LoadScene (guidegen/load_scene.h), which also does the work common
// to all formats.
//
// Each shape (o or g) becomes an object, one instance for each of its materials. A group that is named again, with no
// line o between, goes on. Read: polygons, normals, texture
// coordinates (v flipped), vertex colours (sRGB-encoded), smoothing groups where there are no normals. A material
// library or texture that is missing is a warning, not an error: OBJ files are often passed on without them. Libraries
// are looked for beside the scene, textures beside their library, then beside the scene.
//
// Normals that the file lacks: in a file that speaks of smoothing groups, faces of one group share the normal at a
// place, and faces in group 0 (`s off`) or before the first `s` are flat. Any other file is smooth up to
// kDefaultAutoSmooth. The user's degrees go before both.
//
// Vertices far from 0, as surveyors' are, keep their digits: the objects stand at the middle of what faces use in the
// file instead of at 0. Where the file spans too much for that, those more than 65,536 m and 16 of their sizes from 0
// each stand at the middle of their own shape, or of a neighbour's within 65,536 m. Rest positions are relative to that
// place, and smooth normals continue across objects that share one.
//
// From the MTL, as Blender 3.4 understands it:
//   Kd, map_Kd    base colour, linear; the map stands in place of Kd; -s, -o and -clamp apply
//   Ks            0 or absent: no highlight, Lambert. Else glTF's coat, however strong Ks is; with a black Kd, GGX in
//                 the colour Ks
//   Ns            roughness 1 − √(Ns/1000)
//   illum 3, Ka   a metal, with Ka as its metalness
//   Pr, Pm        roughness and metalness, where above 0, instead of those
//   Ke, map_Ke    emission; the map stands in place of Ke
//   d, norm       opacity; normal map
// Faces without a material are Lambert in Blender's grey of 0.8, or in their vertex colours.
#pragma once

#include <filesystem>

#include "core/image/status.h"
#include "guidegen/file_listener.h"
#include "guidegen/load/auto_smooth.h"
#include "guidegen/scene.h"

namespace scumble {

Expected<Scene> LoadObjScene(const std::filesystem::path& path, MissingNormals missing, const FileListener& on_file);

}  // namespace scumble
