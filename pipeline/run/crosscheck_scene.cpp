#include "pipeline/crosscheck_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "core/io/guide_file.h"
#include "guidegen/cycles_version.h"
#include "guidegen/path_layers.h"
#include "guidegen/pure_materials.h"
#include "pipeline/run/cycles_reference.h"
#include "pipeline/scene_guides.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

// Counts of samples at which the light is rendered, so that the noise's slope shows: N/16, N/4, N.
std::vector<int> SampleCounts(int samples) {
  std::vector<int> counts;
  for (const int divisor : {16, 4, 1}) {
    if (samples / divisor >= 1) counts.push_back(samples / divisor);
  }
  return counts;
}

// Both sides of a scene, and what is reported about them.
struct BothSides {
  Reference reference;
  GuideSet ours;
  std::vector<GuideSet> ours_light;  // by sample count
  std::vector<std::string> unsupported;
  std::vector<std::string> warnings;
};

void AddUnknown(const std::string& line, std::vector<std::string>& lines) {
  if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
}

SceneRequest OurRequest(const CrosscheckRequest& request, const std::string& path) {
  SceneRequest options;
  options.scene = path;
  options.size = request.size;
  options.camera = request.camera;
  options.key_light = false;  // Blender would not let one shine
  options.on_file = request.on_file;
  if (IsBlenderScene(path)) {
    options.blender = {request.blender, request.frame, false, request.blender_scene, request.view_layer};
  }
  return options;
}

// Our data layers, as authored.
Status MakeOurData(Scene& scene, const SceneRequest& options, const RunContext& context, const Progress& progress,
                   BothSides& sides) {
  SCUMBLE_ASSIGN(SceneGuides data, MakeGuidesOf(scene, options, {Layer::kPosition, Layer::kAlbedo}, context, progress));
  sides.ours = std::move(data.guides);
  return Ok();
}

// Our light, with pure materials.
Status MakeOurLight(const CrosscheckRequest& request, Scene& scene, SceneRequest options,
                    const std::vector<int>& counts, const RunContext& context, const Progress& progress,
                    BothSides& sides) {
  if (const std::vector<std::string> replaced = UsePureMaterials(scene); !replaced.empty()) {
    sides.warnings.push_back(
        "light is compared with pure materials on both sides, Lambert or GGX without Fresnel, instead of: " +
        fmt::format("{}", fmt::join(replaced, ", ")));
  }
  double begin = 0.0;
  for (const int count : counts) {
    options.samples = count, options.samples_given = true;
    options.max_bounces = request.max_bounces;
    const double end = count == counts.back() ? 1.0 : begin + 0.1;
    SCUMBLE_ASSIGN(SceneGuides light,
                   MakeGuidesOf(scene, options, PathLayers(), context, Within(progress, begin, end)));
    sides.ours_light.push_back(std::move(light.guides));
    begin = end;
  }
  return Ok();
}

Expected<BothSides> MakeBothSides(const CrosscheckRequest& request, const std::string& path,
                                  const std::vector<int>& counts, const RunContext& context) {
  BothSides sides;
  const Progress progress = context.StartProgress("crosscheck");
  const SceneRequest ours = OurRequest(request, path);
  BlenderAnimation named;  // whose files are told of
  SCUMBLE_ASSIGN(Scene scene, OpenScene(ours, context, &named));
  for (Camera& camera : scene.cameras) camera.border.reset();
  sides.unsupported = scene.warnings;
  SCUMBLE_RETURN_IF_ERROR(MakeOurData(scene, ours, context, Within(progress, 0.0, 0.02), sides));
  ReferenceOptions options{request.blender, path,   request.size.width, request.size.height, request.camera,
                           request.frame,   counts, request.max_bounces};
  options.blender_scene = request.blender_scene, options.view_layer = request.view_layer;
  SCUMBLE_ASSIGN(sides.reference,
                 RenderReference(options, context, Within(progress, 0.02, counts.empty() ? 1.0 : 0.7)));
  for (const std::string& line : sides.reference.unsupported) AddUnknown(line, sides.unsupported);
  const RunContext silent = context.WithoutNotes();  // the camera has been noted
  // A .glb is compared with the Cycles that runs, whichever it was made with.
  if (!sides.reference.version.empty() && ShadeAsCycles(sides.reference.version, scene)) {
    SCUMBLE_RETURN_IF_ERROR(MakeOurData(scene, ours, silent, {}, sides));
  }
  if (!counts.empty()) {
    const Progress rest = Within(progress, 0.7, 1.0);
    SCUMBLE_RETURN_IF_ERROR(MakeOurLight(request, scene, ours, counts, silent, rest, sides));
  }
  return sides;
}

void AddLayers(const GuideSet& from, GuideSet& to) {
  for (const LayerInfo& info : AllLayers()) {
    if (!from.Has(info.layer) || to.Has(info.layer)) continue;
    to.Add(info.layer);
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      const auto plane = from.Plane(info.layer, c);
      std::copy(plane.begin(), plane.end(), to.Plane(info.layer, c).begin());
    }
  }
}

// Both sides with the light of the most samples, as files.
Status KeepGuides(const CrosscheckRequest& request, const std::string& scene, const GuideSet& reference,
                  const GuideSet& ours, const std::vector<CrosscheckLight>& light, const RunContext& context) {
  const std::string stem = (fs::path(request.keep) / fs::path(scene).stem()).string();
  GuideSet theirs_whole = reference, ours_whole = ours;
  if (!light.empty()) {
    AddLayers(light.back().reference.guides, theirs_whole);
    AddLayers(light.back().ours, ours_whole);
  }
  GuideWriteOptions write;
  if (request.fast_io) write.compression = kFastCompression;
  SCUMBLE_RETURN_IF_ERROR(WriteGuides(stem + ".cycles.exr", theirs_whole, write));
  SCUMBLE_RETURN_IF_ERROR(WriteGuides(stem + ".ours.exr", ours_whole, write));
  context.Note(stem + ".cycles.exr, " + stem + ".ours.exr: the guides of both sides");
  return Ok();
}

}  // namespace

Expected<CrosscheckReport> CrosscheckScene(const CrosscheckRequest& request, const std::string& scene,
                                           const RunContext& context) {
  const std::vector<int> counts = SampleCounts(request.samples);
  SCUMBLE_ASSIGN(BothSides sides, MakeBothSides(request, scene, counts, context));
  const CrosscheckOptions options{2, request.heat_maps, std::move(sides.reference.only_shines)};
  std::vector<CrosscheckLight> light;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    light.push_back({counts[i], std::move(sides.reference.light[i]), std::move(sides.ours_light[i])});
  }
  if (!request.keep.empty()) {
    SCUMBLE_RETURN_IF_ERROR(KeepGuides(request, scene, sides.reference.data, sides.ours, light, context));
  }
  SCUMBLE_ASSIGN(CrosscheckReport report, Crosscheck(scene, sides.reference.data, sides.ours, options));
  SCUMBLE_RETURN_IF_ERROR(CrosscheckLightLayers(sides.reference.data, sides.ours, light, options, report));
  report.setup.max_bounces = request.samples > 0 ? request.max_bounces : 0;
  report.setup.camera = request.camera;
  report.setup.frame = request.frame;
  report.setup.blender_scene = request.blender_scene, report.setup.view_layer = request.view_layer;
  report.unsupported = std::move(sides.unsupported);
  report.warnings = std::move(sides.warnings);
  report.scumble_version = SCUMBLE_VERSION;
  report.blender_version = sides.reference.version;
  return report;
}

}  // namespace scumble
