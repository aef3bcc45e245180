// The camera of a render, solved from its passes.
//
// Blender's header holds no camera, but its Position and Depth passes determine one. Planar depth is linear in world
// position, z = b·P + d with |b| = 1. So are x·z and y·z of a perspective view, and x and y of an orthographic one.
// With the direction b known, the unknowns (roll, focal length, lens shift, place) are one linear least-squares problem
// that has square pixels and a right-handed view built in.
#pragma once

#include <span>
#include <string>

#include "core/image/guides.h"
#include "core/image/status.h"

namespace scumble {

// Planes of width × height floats, rows from the top; the caller owns them. A pixel counts where its depth is below
// `background_depth` and above 0, and its position finite.
struct SolveCameraInput {
  int width = 0;
  int height = 0;
  std::span<const float> position[3];  // world space of the caller's choice, m
  std::span<const float> depth;        // planar view depth, m
  float background_depth = 1e9f;       // Blender writes 1e10 where there is nothing
};

struct SolvedCamera {
  GuideCamera camera;  // named "solved"; near and far planes are half the least and twice the largest depth
  bool orthographic = false;
  bool jittered = false;      // positions scatter around pixel centres, as under slight depth of field
  double error_pixels = 0.0;  // root mean square of the reprojection, per axis
};

// Solves, then checks by reprojection: 99.9% of the pixels within 0.02 px, beyond the rounding of positions to float.
// Cycles of Blender 3.4 keeps the first sample's position, which lies at the pixel's centre for any filter. Slight
// depth of field, or a renderer whose filter moves that sample, scatters positions. They may be up to 3 px off if no
// part of the picture is off on average. Refuses with ErrorKind::kInput: fewer than 64 pixels, all in one plane, depth
// that is not planar, pixels that are not square, a mirrored picture, and passes that no camera explains. `name` stands
// for the file in messages. O(pixels), the fit itself on some 100,000 of them; deterministic; thread-safe.
Expected<SolvedCamera> SolveCamera(const SolveCameraInput& input, const std::string& name);

}  // namespace scumble
