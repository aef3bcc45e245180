// Guides by ray casting: scene + camera + layers → GuideSet. The manual of this library.
#pragma once

#include <string>
#include <vector>

#include "guidegen/scene.h"
#include "image/direction.h"
#include "image/guides.h"
#include "image/progress.h"
#include "image/status.h"

namespace scumble {

enum class NormalFrame {
  kCamera,  // view space, the same for every pixel
  kEye,     // rotated to each pixel's own view direction: wide cameras stop stretching
};

struct GuidegenOptions {
  int width = 0;  // pixels, 1 … kMaxImageSide
  int height = 0;
  LayerSet layers;  // what is wanted on top of AlwaysWritten()
  // N × N subsamples of the coverage, 1 … 16; data layers are never averaged. A pixel whose centre is hit counts as one
  // subsample at least, however thin what it hit.
  int aa = 1;
  NormalFrame normal_frame = NormalFrame::kCamera;
  int threads = 0;  // 0: all
  std::string isa;  // Embree's "isa=" setting: "" (best of this machine), "sse2", "sse4.2", "avx", "avx2", "avx512"
  Progress progress;
};

// One line of the plan: what is computed, why, and what it costs.
struct PlanItem {
  std::string layer;   // "normal", or a step like "shadow rays"
  std::string reason;  // "always written", "asked for"
  std::string cost;    // "primary rays", "1 shadow ray per light and pixel", "none"
};

// What RenderGuides will do; `options` as there. Depends on the scene only through its lights and materials.
std::vector<PlanItem> PlanGuides(const Scene& scene, const GuidegenOptions& options);

// Rays that were cast, by kind: what a scene made us pay.
struct RayCounts {
  std::size_t primary = 0;
  std::size_t coverage = 0;  // extra subsamples
  std::size_t shadow = 0;
};

struct GuidegenResult {
  GuideSet guides;
  RayCounts rays;
  double build_ms = 0;  // acceleration structure
  double render_ms = 0;
};

// Casts rays through pixel centres and returns the guides (conventions in image/guides.h). Transforms compose in
// double and Embree's scene is relative to the camera. Deterministic for one isa, whatever the threads; the isa in use
// is recorded in guides.attributes["scumble:isa"]. Layers that are not built in yet are a kUnavailable error by name.
// An empty scene, or a camera that sees nothing, is an empty picture and no error. Uses oneTBB and Embree 3.
Expected<GuidegenResult> RenderGuides(const Scene& scene, const Camera& camera, const GuidegenOptions& options);

struct SphereOptions {
  int size = 512;  // N × N pixels
  LayerSet layers;
  int aa = 1;
  double light_azimuth = kKeyLightAzimuth;  // degrees, as in image/direction.h
  double light_elevation = kKeyLightElevation;
  int threads = 0;
  std::string isa;
};

// The exemplar's guides: the unit sphere that exactly fills an N × N orthographic picture, as an Embree sphere
// primitive, lit by a sun of strength π. The object's name is "sphere".
Expected<GuidegenResult> RenderSphereGuides(const SphereOptions& options);

}  // namespace scumble
