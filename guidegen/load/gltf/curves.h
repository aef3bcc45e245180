// Hair in glTF, of which its specification knows nothing: points with an extra of ours (docs/blender.md).
#pragma once

#include <string>

#include "guidegen/load/gltf/meshes.h"

namespace tinygltf {
struct Primitive;
}

namespace scumble {

// The mesh of a primitive of curves: its control points are POSITION, with radii in _SCUMBLE_RADIUS and perhaps
// TEXCOORD_0; its indices are Curves::segments. `drawn` is what its extras say of it, `name` is for messages. The
// material is the caller's to choose. kInput where something is missing or points outside.
Expected<Mesh> LoadCurves(const GltfLoad& load, const tinygltf::Primitive& primitive, const std::string& name,
                          Curves drawn);

}  // namespace scumble
