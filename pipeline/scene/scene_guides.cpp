#include "pipeline/scene_guides.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "core/image/stopwatch.h"
#include "core/io/format_dispatch.h"
#include "core/io/guide_file.h"
#include "core/io/guide_precision.h"
#include "pipeline/frame_range.h"
#include "pipeline/memory_estimate.h"
#include "pipeline/scene/needed_textures.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

Status CheckScene(const std::string& scene) {
  std::error_code failed;
  if (fs::is_directory(scene, failed)) return InputError(scene + " is a folder: name a scene file in it");
  const bool has_ending = IsScene(scene);
  if (!fs::exists(scene, failed) && has_ending) {
    const Expected<FrameName> name = FrameName::Parse(scene);
    if (!name || name->must_have_frame()) {
      return UsageError(scene +
                        ": a scene of one file a frame is not read as a sequence; call scumble once a frame, with " +
                        "its file and --frame N, or export one animated .glb");
    }
  }
  if (has_ending) return Ok();
  const std::string ending = fs::path(scene).extension().string().substr(0, 40);
  return InputError(scene + " has " + (ending.empty() ? "no ending" : "the ending '" + ending + "'") +
                    "; expected a scene in .glb, .gltf, .obj, .ply or .blend");
}

void WarnIfNothingShows(const GuideSet& guides, const std::string& scene, const RunContext& context) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  if (std::any_of(coverage.begin(), coverage.end(), [](float a) { return a > 0.0f; })) return;
  context.Warn(scene + ": the camera sees nothing, the picture is empty; try --view or another --camera");
}

// Once a run. Edges of shadows alone keep most pixels below twice the wanted error.
void NoteLightNoise(double error, double wanted, int samples, const RunContext& context) {
  if (!(error > 2.0 * wanted) || !context.noted_light_noise || context.noted_light_noise->exchange(true)) return;
  context.Note(
      fmt::format("luminance and shadow are noisy: {} samples of each light leave a standard error of up to "
                  "{:.1f}% in nine of ten pixels, {:.1f}% is wanted; try --samples {}, or fewer, larger lights",
                  samples, 100.0 * error, 100.0 * wanted, 4 * samples));
}

Expected<Scene> LoadAnyScene(const SceneRequest& options, const RunContext& context, BlenderAnimation* animation) {
  BlenderRequest blender = options.blender;
  blender.wants_start = options.view.has_value();
  if (!IsBlenderScene(options.scene)) return LoadScene(options.scene, LoadOptionsOf(options));
  if (options.on_file) options.on_file(options.scene);
  Expected<Scene> scene = LoadBlenderScene(options.scene, blender, context, animation);
  if (animation) TellFiles(*animation, options);
  return scene;
}

}  // namespace

void TellFiles(BlenderAnimation& animation, const SceneRequest& request) {
  for (const std::string& file : std::exchange(animation.files, {})) {
    if (request.on_file) request.on_file(file);
  }
}

bool IsScene(const std::string& path) { return HasEnding(path, {".glb", ".gltf", ".obj", ".ply", ".blend"}); }

std::string ViewToText(const ViewAngles& view) {
  std::string text = fmt::format("{},{}", view.azimuth, view.elevation);
  const bool has_fov = view.fov > 0.0, is_moved = has_fov || view.right != 0.0 || view.up != 0.0;
  if (is_moved || view.distance > 0.0) text += fmt::format(",{}", view.distance);
  if (is_moved) text += fmt::format(",{},{}", view.right, view.up);
  if (has_fov) text += fmt::format(",{}", view.fov);
  return text;
}

std::string LightToText(const LightAngles& light) { return fmt::format("{},{}", light.azimuth, light.elevation); }

Expected<Scene> OpenScene(const SceneRequest& options, const RunContext& context, BlenderAnimation* animation,
                          bool warns) {
  SCUMBLE_ASSIGN(Scene scene, LoadAnyScene(options, context, animation));
  PassOnNotes(scene, options.scene, context, warns);
  return scene;
}

LoadOptions LoadOptionsOf(const SceneRequest& request) {
  return {TextureLoading::kWhenNeeded, request.auto_smooth_degrees, request.on_file};
}

void PassOnNotes(const Scene& scene, const std::string& file, const RunContext& context, bool warns) {
  for (const std::string& note : scene.notes) context.Note(file + ": " + note);
  if (!warns) return;
  for (const std::string& warning : scene.warnings) context.Warn(file + ": " + warning);
}

Status CheckSceneRequest(const SceneRequest& request) {
  SCUMBLE_RETURN_IF_ERROR(CheckScene(request.scene));
  SCUMBLE_RETURN_IF_ERROR(CheckFrame(request.blender.frame));
  if (IsBlenderScene(request.scene)) {
    if (request.auto_smooth_degrees) {
      return UsageError("--auto-smooth is for files that lack normals; Blender gives those of " + request.scene +
                        ": leave it out");
    }
    if (request.animation.empty()) return Ok();
    return UsageError("--animation is for glTF files; " + request.scene + " has a time of its own: leave it out");
  }
  return CheckWithoutBlender(request.scene, request.blender);
}

Status CheckWithoutBlender(const std::string& path, const BlenderRequest& blender) {
  for (const auto& [option, value] :
       {std::pair("--blender", &blender.program), {"--scene", &blender.scene}, {"--view-layer", &blender.view_layer}}) {
    if (value->empty()) continue;
    return UsageError(std::string(option) + " is for .blend scenes; " + path +
                      " is read without Blender: leave it out");
  }
  return Ok();
}

Expected<SceneGuides> MakeGuidesOf(Scene& scene, const SceneRequest& options, const LayerSet& layers,
                                   const RunContext& context, const Progress& progress) {
  SCUMBLE_ASSIGN(const PreparedView prepared, ViewScene(scene, options, layers));
  for (const std::string& note : prepared.notes) context.Note(note);
  return CastScene({scene, prepared.camera}, options, layers, context, progress);
}

bool DependOnLight(const LayerSet& layers) {
  const auto needs = {Layer::kLuminance, Layer::kShadow, Layer::kCosine,  Layer::kLpeFull,
                      Layer::kLpeLDE,    Layer::kLpeLSE, Layer::kLpeLDDE, Layer::kLpeLD12E};
  return std::any_of(needs.begin(), needs.end(), [&](Layer layer) { return layers.Has(layer); });
}

bool NeedsKeyLight(const SceneRequest& options, const LayerSet& layers) {
  return options.key_light && !options.light && DependOnLight(layers);
}

bool ReplacesLights(const SceneRequest& options, const LayerSet& layers) {
  return options.light && DependOnLight(layers);
}

Expected<PreparedView> ViewScene(Scene& scene, const SceneRequest& options, const LayerSet& layers) {
  const double aspect = static_cast<double>(options.size.width) / options.size.height;
  SCUMBLE_ASSIGN(PreparedView seen,
                 PrepareView(scene, options.camera, options.view, aspect, NeedsKeyLight(options, layers)));
  if (ReplacesLights(options, layers)) ReplaceLights(scene, seen.camera, *options.light);
  return seen;
}

namespace {

// Where samples are not given, pixels choose how many luminance and shadow take.
double LightErrorOf(const SceneRequest& options) { return options.samples_given ? 0.0 : kUnseenLightError; }

}  // namespace

std::string SamplesText(const SceneRequest& options) {
  if (options.samples_given) return std::to_string(options.samples);
  const bool open_ended = options.noise > 0.0 || options.time_budget_seconds > 0.0;
  return open_ended ? std::to_string(kMaxSamples) : fmt::format("{}-{}", kLeastLightSamples, options.samples);
}

std::string GuideSettings(const SceneRequest& options) {
  std::string text = fmt::format("scumble {}; aa {}; normals {}{}; seed {}", SCUMBLE_VERSION, options.aa,
                                 options.normal_frame == NormalFrame::kEye ? "eye" : "camera",
                                 options.raw_normals ? " raw" : "", options.seed);
  const auto add = [&](const char* name, std::string value) {
    std::replace(value.begin(), value.end(), ';', ',');
    text += fmt::format("; {} '{}'", name, value);
  };
  add("camera", options.camera), add("view", options.view ? ViewToText(*options.view) : "");
  if (options.light) add("light", LightToText(*options.light));
  add("animation", options.animation);
  add("auto smooth", options.auto_smooth_degrees ? fmt::format("{}", *options.auto_smooth_degrees) : "");
  add("fps", options.fps && *options.fps != FrameRate() ? FrameRateToText(*options.fps) : "");
  if (!options.blender.scene.empty()) add("scene", options.blender.scene);
  if (!options.blender.view_layer.empty()) add("view_layer", options.blender.view_layer);
  // All of them always: what a file does not name differs.
  return text + fmt::format("; robust {}; samples {}; bounces {}; noise {}", options.robust ? "yes" : "no",
                            SamplesText(options), options.max_bounces, options.noise);
}

void StoreSettings(const SceneRequest& options, GuideSet& guides) {
  guides.attributes[kSettingsKey] = GuideSettings(options);
  guides.attributes[kSamplesKey] = SamplesText(options);
  guides.attributes.erase("scumble:seed");
  if (options.seed != 0) guides.attributes["scumble:seed"] = std::to_string(options.seed);
}

namespace {

GuidegenOptions GuidegenOptionsOf(const SceneRequest& options, const LayerSet& layers, int threads,
                                  const Progress& progress) {
  GuidegenOptions guidegen;
  guidegen.width = options.size.width, guidegen.height = options.size.height;
  guidegen.layers = layers;
  guidegen.aa = options.aa;
  guidegen.normal_frame = options.normal_frame;
  guidegen.raw_normals = options.raw_normals;
  guidegen.threads = threads;
  guidegen.isa = options.isa;
  guidegen.robust = options.robust;
  guidegen.progress = progress;
  guidegen.samples = options.samples;
  guidegen.light_error = LightErrorOf(options);
  guidegen.max_bounces = options.max_bounces;
  guidegen.noise = options.noise;
  guidegen.seed = options.seed;
  guidegen.time_budget_seconds = options.time_budget_seconds;
  if (options.samples_given) guidegen.max_samples = options.samples;
  return guidegen;
}

}  // namespace

SceneGuides PlanScene(const Scene& scene, const SceneRequest& options, const LayerSet& layers,
                      const RunContext& context) {
  SceneGuides result;
  result.plan = PlanGuides(scene, GuidegenOptionsOf(options, layers, context.threads, {}));
  AddProgram(context.threads, result.memory);
  AddScene(scene, CountNeededPixels(scene, options, layers), result.memory);
  AddGuides(options.size, layers, options, result.memory);
  if (options.more_memory) options.more_memory(options.size, layers, result.memory);
  return result;
}

Expected<SceneGuides> CastScene(const SceneToCast& cast, const SceneRequest& options, const LayerSet& layers,
                                const RunContext& context, const Progress& progress) {
  const auto& [scene, camera, next, rays] = cast;
  SceneGuides result = PlanScene(scene, options, layers, context);
  SCUMBLE_RETURN_IF_ERROR(CheckMemory(result.memory, context, "take a smaller --size, or fewer layers"));
  Stopwatch watch;
  Expected<SceneCost> decoded = DecodeNeededTextures(scene, options, layers, context);
  if (rays && (!decoded || decoded->textures_left_out > 0)) rays->reset();
  if (!decoded) return std::move(decoded).error();
  result.cost = *decoded;
  const double textures_ms = watch.Lap();
  context.EndStage("scene");
  const GuidegenOptions guidegen = GuidegenOptionsOf(options, layers, context.threads, progress);
  if (rays && !*rays) {
    SCUMBLE_ASSIGN(*rays, RayScene::Make(scene, camera));
  }
  SCUMBLE_ASSIGN(GuidegenResult rendered, rays && next ? RenderGuides(**rays, *next, guidegen)
                                          : rays       ? RenderGuides(**rays, guidegen)
                                          : next       ? RenderGuides(scene, camera, *next, guidegen)
                                                       : RenderGuides(scene, camera, guidegen));
  result.times.emplace_back("build", rendered.build_ms);
  result.times.emplace_back("rays", rendered.render_ms);
  result.guides = std::move(rendered.guides);
  result.cost.rays = rendered.rays, result.cost.work = rendered.work;
  result.builds = rendered.builds;
  result.samples = rendered.samples, result.noise = rendered.noise;
  if (options.half) RoundColorLayersToHalf(result.guides);
  StoreSettings(options, result.guides);
  if (!scene.instances.empty()) WarnIfNothingShows(result.guides, options.scene, context);
  NoteLightNoise(rendered.light_error, guidegen.light_error, guidegen.samples, context);
  context.EndStage("guides", result.times);
  if (result.cost.textures_decoded > 0) result.times.insert(result.times.begin(), {"textures", textures_ms});
  return result;
}

namespace {

void NameReaderInPlan(std::vector<PlanItem>& plan, const LayerSet& read, const std::string& who) {
  for (PlanItem& item : plan) {
    for (const LayerInfo& info : AllLayers()) {
      if (read.Has(info.layer) && item.layer == info.name) item.reason += ", read by " + who;
    }
  }
}

}  // namespace

void NameStylesInPlan(std::vector<PlanItem>& plan, const StyleSet& styles) {
  const auto name_passes = [&](const FinishChain& chain) {
    for (std::size_t i = 0; i < chain.passes.size(); ++i) {
      LayerSet layers;
      for (const FinishPass& moment : MomentsOf(chain, i)) layers.Add(RequiredLayers(moment));
      NameReaderInPlan(plan, layers, "finish " + chain.passes[i].name);
    }
  };
  for (const Style& style : styles.styles) {
    NameReaderInPlan(plan, TransferLayers(style), "style " + style.name);
    name_passes(FinishOf(style));
  }
  name_passes(styles.finish);
}

}  // namespace scumble
