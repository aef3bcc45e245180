// The meaning of Blender's passes as guides: multilayer EXRs that Cycles wrote, from any render setup.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/status.h"
#include "core/io/blender/render_light.h"
#include "core/io/guides/cryptomatte.h"

namespace scumble {

// One Cryptomatte of a file. `ranks` are planes of the picture's size by MatteChannel::index, empty where the file
// lacks the channel.
struct Matte {
  std::vector<std::vector<float>> ranks;
  std::map<std::uint32_t, std::string> manifest;
};
using BlenderMattes = std::map<Layer, Matte>;  // kObject, kMaterial

// Turns passes as Blender writes them into guides, in place:
//   - Without `camera` it is solved from Position and Depth (core/io/blender/solve_camera.h); an error says what that
//     lacks.
//   - Normals go from Blender's world (+Z up) into view space and get length 1, positions into glTF's world (+Y up),
//     the background's depth of 1e10 becomes infinity.
//   - object and material come from the Cryptomattes where there are any, else from the pass indices, whose names are
//     "index N". Either way ids are those of the names (IdsForNames).
//   - Where no alpha lies between 0 and 1 the film was opaque, or might as well have been, and an alpha of 1 says
//     nothing: coverage is then that of the object's (else the material's) Cryptomatte; without one, 1 where there is
//     depth; without that, where there is a normal.
//   - A pixel filter averages normals and alpha and leaves position and depth to one sample, which may have missed what
//     covers the rest of the pixel: such pixels take depth and position from the nearest pixel within two that
//     has them, of the same object if there is one. Covered pixels without a normal, as a volume's, do so with the
//     normal, and become background where there is none.
// Layers that the set lacks are left out; A and normal must be there. `name` stands for the file.
//   - luminance and shadow come from passes of light (core/io/blender/render_light.h). Where the pass Shadow Catcher is
//     among them, shadow catchers are covered. A transparent film has none of their alpha. In a pixel's sums their
//     other data count double in Cycles 3, and once in Cycles 4: Cryptomatte's coverage shows them, or the normal's
//     length without it.
Status ConvertBlenderPasses(const std::optional<GuideCamera>& camera, const BlenderMattes& mattes,
                            const BlenderLight& light, const std::string& name, GuideSet& guides);

// Which passes to switch on for layers that are missing, for the end of a message.
std::string BlenderPassesFor(const LayerSet& missing);

}  // namespace scumble
