// The camera of a render, found from what it saw.
//
// Blender's header holds no camera, but its Position and Depth passes do: planar depth is linear in world position,
// z = b·P + d with |b| = 1, and so are x·z and y·z of a perspective view, or x and y of an orthographic one. Given the
// direction b, what is left (roll, focal length, lens shift, place) is one linear least-squares problem in which square
// pixels and a right-handed view are built in.
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

// Solves, then proves by reprojection: 99.9% of the pixels within 0.02 px, beyond what rounding positions to float
// explains. Cycles of Blender 3.4 keeps the first sample's position, which lies at the pixel's centre whatever the
// filter; slight depth of field, or a renderer whose filter moves that sample, scatters it: positions may be up to 3 px
// off, as long as no part of the picture is off on average. Refuses with ErrorKind::kInput: fewer than 64 pixels, all
// in one plane, depth that is not planar, pixels that are not square, a mirrored picture, and whatever no camera
// explains. `name` stands for the file in messages. O(pixels), the fit itself on some 100,000 of them; deterministic;
// thread-safe.
Expected<SolvedCamera> SolveCamera(const SolveCameraInput& input, const std::string& name);

}  // namespace scumble
