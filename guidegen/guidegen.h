// Guides by ray casting: scene + camera + layers → GuideSet. The manual of this library.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/image/direction.h"
#include "core/image/guides.h"
#include "core/image/progress.h"
#include "core/image/status.h"
#include "guidegen/scene.h"

namespace scumble {

inline constexpr int kMaxSamples = 1 << 16;
inline constexpr int kMaxBounces = 1024;

// A light_error that hardly shows: what 64 samples leave in the middle of a penumbra.
inline constexpr double kUnseenLightError = 0.015;
inline constexpr int kLeastLightSamples = 4;  // with a light_error

enum class NormalFrame {
  kCamera,  // view space, the same for every pixel
  kEye,     // rotated to each pixel's own view direction: wide cameras stop stretching
};

struct GuidegenOptions {
  int width = 0;  // pixels, 1 … kMaxImageSide
  int height = 0;
  LayerSet layers;  // the wanted layers besides AlwaysWritten()
  // N × N subsamples of the coverage, 1 … 16; data layers are never averaged. A pixel whose centre is hit counts as at
  // least one subsample, however thin the object.
  int aa = 1;
  NormalFrame normal_frame = NormalFrame::kCamera;
  // Off: shading normals that would reflect the eye's ray into the surface are bent, as in Cycles, in every layer
  // (guidegen/surface/shading_normal.h). On: they stay as they are interpolated and mapped;
  // attributes["scumble:raw_normals"] is "true".
  bool raw_normals = false;
  int threads = 0;  // 0: all
  std::string isa;  // Embree's "isa=" setting: "" (best of this machine), "sse2", "sse4.2", "avx", "avx2", "avx512"
  // Embree's robust mode: rays that hit an edge or a corner never pass between two triangles. Without it the tests of
  // boxes and triangles are slightly faster and may miss there; other hits are equal. If it is off,
  // attributes["scumble:robust"] is "false".
  bool robust = true;
  Progress progress;

  // For light-path layers, and for luminance and shadow under lights with extent. Samples of a pixel, 1 … kMaxSamples.
  // They share the pixel's first surface, so no layer is averaged across a silhouette.
  int samples = 64;
  // Luminance and shadow only. Above 0: each pixel samples each light with extent 4 times at least (8 at the border of
  // a 16 × 16 tile; 16 where there are more than 8 such lights, and directions that look for a near one), and more
  // often, up to `samples`, until the estimated standard error of its light is not larger than this share of the light
  // that the lamps it sees would bring without occluders, together with what it has from lights without extent.
  // Neighbours of a shadow's edge count as on it. 0: `samples` each.
  double light_error = 0.0;
  // Reflections after the first surface's, 0 … kMaxBounces; 0 is direct light alone, as in Cycles.
  int max_bounces = 8;
  // Light-path layers only. Above 0: samples are doubled, to 16 at least, until the estimated error, root mean square
  // over mean, of each layer's luminance is not larger than this; `samples` does not count then.
  double noise = 0.0;
  // Light-path layers only. Above 0: samples are taken until this time is over, or `noise` is reached. At least one
  // sample is taken, whatever it costs. No pass begins that would last longer at the speed so far. The clock decides,
  // so the picture may differ from run to run; GuidegenResult::samples repeats it.
  double time_budget_seconds = 0.0;
  int max_samples = kMaxSamples;  // the most that `noise` and the time budget may take, 1 … kMaxSamples
  std::uint64_t seed = 0;         // another seed, other noise of equal size; in attributes["scumble:seed"] unless 0
  // `noise` and the time budget are a kUsage error where luminance and shadow need samples.
};

// One line of the plan: the layer, the reason for it, and its cost.
struct PlanItem {
  std::string layer;   // "normal", or a step like "shadow rays"
  std::string reason;  // "always written", "asked for"
  std::string cost;    // "primary rays", "1 shadow ray per light and pixel", "none"
};

// The plan of RenderGuides for these options. Depends on the scene only through its lights and materials.
std::vector<PlanItem> PlanGuides(const Scene& scene, const GuidegenOptions& options);

// Numbers of rays, by kind.
struct RayCounts {
  std::size_t primary = 0;
  std::size_t coverage = 0;  // extra subsamples
  std::size_t shadow = 0;    // visibility of lights only
  std::size_t bounce = 0;    // for the next surface of a path
};

// Counters of the inner loops. They are equal for any number of threads.
struct WorkCounts {
  std::size_t light_samples = 0;    // samples of a delta light, of a point on a light, or of a direction
  std::size_t materials = 0;        // evaluations of a material at a point: its colour or emission
  std::size_t texture_lookups = 0;  // samples of a texture
  std::size_t texels = 0;           // read for the samples: 4 each, or 1 without interpolation
  std::size_t filtered_hits = 0;    // hits for which Embree called our filter
  std::size_t plane_bytes = 0;      // of the layers' planes
};

struct GuidegenResult {
  GuideSet guides;
  RayCounts rays;
  WorkCounts work;
  int builds = 0;       // acceleration structures that this call built: 1, or 0 where the RayScene had it
  double build_ms = 0;  // time of that build; 0 without a build
  double render_ms = 0;
  // Samples of each pixel, in light-path layers; 0 where no random numbers are needed. Also in
  // guides.attributes["scumble:samples"].
  int samples = 0;
  double noise = 0.0;  // the estimated error, if `noise` or a time budget was given
  // With options.light_error: nine of ten lit pixels have an estimated error of their light up to this one, which is
  // larger where `samples` are too few. 0: there is no such light. Also in guides.attributes["scumble:light_error"].
  double light_error = 0.0;
};

// Casts rays through pixel centres and returns the guides (conventions in core/image/guides.h). Transforms compose in
// double and Embree's scene is relative to the camera. Deterministic for one isa and one version of Embree, whatever
// the threads; both are recorded in guides.attributes, "scumble:isa" and "scumble:embree". Light-path layers are in
// guidegen/path_layers.h; each is traced only as far as its expression and the scene's lights and materials
// require. A layer that is not supported yet is a kUnavailable error that names it. An empty scene, or a camera that
// sees nothing, is an empty picture and no error. If options.progress returns false, the call ends with kCancelled
// within a fraction of a second. Uses oneTBB and Embree.
Expected<GuidegenResult> RenderGuides(const Scene& scene, const Camera& camera, const GuidegenOptions& options);

// The scene and camera of the next frame, which the layer `motion` is measured against. Objects are matched by name and
// mesh. Both are borrowed.
struct NextFrame {
  const Scene& scene;
  const Camera& camera;
};

// RenderGuides with the layer `motion`: the movement, until the next frame, of the point that a pixel shows, in pixels,
// +X right and +Y down. It is 0 for background and for objects that the next frame lacks or has with other triangles.
// Meshes with rest_positions are followed by these where the triangles differ. It is exactly 0 for points that do not
// move. A point may be hidden in the next frame; `motion` does not show that.
Expected<GuidegenResult> RenderGuides(const Scene& scene, const Camera& camera, const NextFrame& next,
                                      const GuidegenOptions& options);

// A scene before a camera, ready to be cast many times: names and ids, and the acceleration structure, which is built
// by the first cast and kept. Casts may differ in every option. They build again only for another `isa` or `robust`,
// and once more when light is first asked for.
//
// The scene is borrowed, and must outlive this. Between casts lights, the world's radiance and styles may change, and
// DecodeTextures may be called. If anything else of the scene changes, if the camera does, or if DecodeTextures leaves
// a texture out, make a new RayScene: the structure depends on materials, and its triangles are relative to the camera.
//
// Safe to use from several threads at once. A cast that is cancelled or fails leaves it as good as before.
class RayScene {
 public:
  // Fails with kInput where the camera has no direction, or a lens without a picture.
  static Expected<RayScene> Make(const Scene& scene, const Camera& camera);
  static Expected<RayScene> Make(const Scene&& scene,
                                 const Camera& camera) = delete;  // the scene would not outlive this

  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  ~RayScene();

 private:
  struct State;
  explicit RayScene(std::unique_ptr<State> state);
  friend struct RayCast;  // RenderGuides, inside

  std::unique_ptr<State> state_;
};

// RenderGuides for a prepared scene: the same bytes, for any earlier casts.
Expected<GuidegenResult> RenderGuides(const RayScene& scene, const GuidegenOptions& options);
Expected<GuidegenResult> RenderGuides(const RayScene& scene, const NextFrame& next, const GuidegenOptions& options);

struct SphereOptions {
  int size = 512;  // N × N pixels
  LayerSet layers;
  int aa = 1;
  double light_azimuth = kKeyLightAzimuth;  // degrees, as in core/image/direction.h
  double light_elevation = kKeyLightElevation;
  int threads = 0;
  std::string isa;
};

// The exemplar's guides: the unit sphere that exactly fills an N × N orthographic picture, as an Embree sphere
// primitive, lit by a sun of strength π. It is white and matt; lpe.LSE is what it would have with gloss. The object's
// name is "sphere".
Expected<GuidegenResult> RenderSphereGuides(const SphereOptions& options);

}  // namespace scumble
