// Which scene is drawn, and how it is seen.
#pragma once

#include <optional>
#include <string>

namespace scumble {

// A view without a camera: at the scene's centre, from a direction.
struct SceneView {
  double azimuth = 35.0;    // degrees, from +Z towards +X
  double elevation = 20.0;  // degrees above the horizon, -90 … 90
  double distance = 0.0;    // metres; 0: the scene is framed
  double right = 0.0;       // metres in the picture plane from that centre to what is looked at
  double up = 0.0;          // likewise
  double fov = 0.0;         // the picture's vertical angle of view, degrees, below 180; 0: 35
};

// The direction of a sun, degrees of the view: (0, 0) is from the viewer, (90, 0) from the right, (0, 90) from above.
struct SceneLight {
  double azimuth = -40.0;
  double elevation = 40.0;  // -90 … 90
};

struct SceneSettings {
  std::string file = {};                 // .glb, .gltf, .obj, .ply; .blend where Blender is installed
  int width = 1280, height = 720;        // pixels, 1 … 32768, and at most 2^28 together
  std::string camera = {};               // by name; empty: the scene's first, or a view that frames it
  std::optional<SceneView> view = {};    // instead of a camera
  std::optional<SceneLight> light = {};  // one sun in place of the scene's lights and world; surfaces still glow
  std::optional<int> frame = {};         // of an animation, -999999999 … 999999999; empty: at rest
  std::string animation = {};            // by name, where a file has several; "*": all; empty: the first
  std::string blender_scene = {};        // of a .blend, by name; empty: the one that was open when it was saved
  std::string view_layer = {};           // of a .blend, by name; empty: the first one that is rendered
  // 0.001 … 1e5, rounded to thousandths, or to N · 1000/1001 where that is nearer (N up to 100), as for 24000.0 / 1001.
  // 0: a .blend's own, otherwise 24.
  double frames_per_second = 0.0;
  // Degrees between faces, 0 … 180, up to which they are smooth where the file gives no normals; 0: flat. Empty: glTF
  // is flat, OBJ as its smoothing groups say, other OBJ and PLY smooth up to 60.
  std::optional<double> auto_smooth = {};
  int coverage_samples = 1;  // N × N samples of the silhouette, 1 … 16
  int light_samples = 0;     // of each pixel, where light is sampled; 0: as many as show, 64 at most
  // On: shading normals that would mirror the eye's ray into the surface stay as they are. Off: they are bent, as in
  // Blender's Cycles.
  bool raw_normals = false;
  std::string instruction_set = {};  // "sse2", "sse4.2", "avx", "avx2", "avx512"; empty: the best of this machine
};

}  // namespace scumble
