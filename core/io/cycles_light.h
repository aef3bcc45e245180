// Light paths as Cycles renders them: multilayer EXRs of blender_scripts/render_guides.py turned into our layers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/image/guides.h"
#include "core/image/status.h"

namespace scumble {

struct CyclesLight {
  GuideSet guides;                  // lpe.full, lpe.LDE, lpe.LSE, lpe.LDDE and lpe.LD12E, nothing else
  std::vector<std::uint8_t> emits;  // by pixel: 1 where the surface itself emits, so that `full` holds its own light
  bool glossy = false;              // the eye sees a surface with a specular lobe
};

// Reads STEM.all.N.exr, STEM.ldde.N.exr and STEM.ld12e.N.exr, N the samples of a pixel:
//   full  = Combined of `all`
//   LDE   = DiffCol · DiffDir of `all`
//   LSE   = GlossCol · GlossDir of `all`
//   LDDE  = DiffCol · DiffInd of `ldde`, where the second surface from the eye has no specular lobe
//   LD12E = DiffCol · (DiffDir + DiffInd) of `ld12e`, which moreover ends there
// Values are as stored, NaN included. Passes are found by the end of their names, whatever the view layer. Errors: a
// file or a pass is missing, two view layers hold it, the files differ in size.
Expected<CyclesLight> ReadCyclesLight(const std::filesystem::path& stem, int samples);

// Adds the GlossCol pass of the data file to the albedo of `guides`, which was read from that file. Our albedo includes
// the base colour of a specular surface, where DiffCol is black. Returns, by pixel, 1 where the surface only emits: its
// Emit is not black and its albedo is, so there is nothing to compare. Errors: a pass is missing or has another size.
Expected<std::vector<std::uint8_t>> CompleteAlbedo(const std::filesystem::path& file, GuideSet& guides);

}  // namespace scumble
