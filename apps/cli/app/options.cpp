#include "apps/cli/app/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <system_error>

#include "pipeline/memory/memory_estimate.h"
#include "pipeline/scene/needed_textures.h"
#include "pipeline/run/sequence.h"
#include "apps/cli/app/timing.h"
#include "core/io/guide_file.h"
#include "core/style/style_file.h"

namespace scumble {

namespace fs = std::filesystem;

void AddGlobalOptions(CLI::App& verb, Globals& globals) {
  verb.add_flag("-q,--quiet", globals.quiet, "say nothing on stderr but errors and warnings");
  verb.add_flag("--json", globals.json, "print the result as JSON");
  verb.add_option("--threads", globals.threads, "threads to use; 0: all")
      ->type_name("N")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

CLI::Option* AddFastIoOption(CLI::App& verb, bool& fast_io) {
  return verb.add_flag("--fast-io", fast_io,
                       "of EXR files the compression that is written and read in the least time, rle: the same pixels, larger "
                       "files");
}

std::string RefuseNegative(const std::string& text) {
  return text.rfind('-', 0) == 0 ? text + " is negative: expected a whole number, 0 or more" : "";
}

std::function<std::string(const std::string&)> RefuseNoAmount(const std::string& example) {
  return [example](const std::string& text) -> std::string {
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto [read, failure] = std::from_chars(text.data(), end, value);
    if (failure == std::errc() && read == end && std::isfinite(value) && value > 0.0) return "";
    return "'" + text + "' is no number above 0: expected " + example;
  };
}

std::string RefuseEmpty(const std::string& text) { return text.empty() ? "it is empty: give a name, or leave it out" : ""; }

Expected<Size> ParseSize(const std::string& text) {
  const std::size_t cross = text.find_first_of("xX");
  const std::string first = text.substr(0, cross);
  const std::string second = cross == std::string::npos ? first : text.substr(cross + 1);
  const auto side = [](const std::string& digits) {
    int value = 0;
    const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return failure == std::errc() && end == digits.data() + digits.size() ? value : 0;
  };
  const Size size{side(first), side(second)};
  if (size.width < 1 || size.height < 1 || size.width > kMaxImageSide || size.height > kMaxImageSide) {
    return UsageError("--size " + text + ": expected WIDTHxHEIGHT, as in 1920x1080, each 1 to " +
                      std::to_string(kMaxImageSide));
  }
  if (std::int64_t(size.width) * size.height > kMaxPicturePixels) {
    return UsageError("--size " + text + ": expected at most " + std::to_string(kMaxPicturePixels) +
                      " pixels in all, as in 16384x16384");
  }
  return size;
}

Expected<std::vector<double>> ParseNumbers(const std::string& text, std::size_t least, std::size_t most,
                                           const std::string& what) {
  std::vector<double> numbers;
  const char* position = text.data();
  const char* const end = text.data() + text.size();
  while (position <= end) {
    double value = 0;
    const auto [next, failure] = std::from_chars(position, end, value);
    if (failure != std::errc() || (next != end && *next != ',') || !(value >= -1e9 && value <= 1e9)) break;
    numbers.push_back(value);
    if (next == end) {
      if (numbers.size() < least || numbers.size() > most) break;
      return numbers;
    }
    position = next + 1;
  }
  return UsageError(what + " " + text + ": expected " + std::to_string(least) +
                    (most > least ? " to " + std::to_string(most) : "") + " numbers with commas between");
}

void AddViewOptions(CLI::App& verb, SceneOptions& options) {
  verb.add_option("scene", options.scene,
                  "scene file: .glb, .gltf, .obj, .ply, or .blend, which Blender 3.4 exports first")
      ->type_name("FILE")
      ->required();
  verb.add_option("--size", options.size, "pixels of the picture; one number makes a square")
      ->type_name("WIDTHxHEIGHT")
      ->capture_default_str();
  verb.add_option("--camera", options.camera, "camera by name; left out: the scene's first")->type_name("NAME");
  verb.add_option(
          "--view", options.view,
          "look at the scene's centre instead of through a camera: AZIMUTH,ELEVATION[,DISTANCE] in degrees from "
          "+Z towards +X, degrees above the horizon, metres; without DISTANCE the scene is framed")
      ->type_name("AZ,EL[,DIST]");
}

void AddCastOptions(CLI::App& verb, SceneOptions& options) {
  verb.add_option("--aa", options.aa, "N x N subsamples of the silhouette's coverage, 1 to 16")
      ->type_name("N")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  verb.add_option("--normal-frame", options.normal_frame,
                  "camera: normals in view space; eye: relative to each pixel's own view, for wide cameras")
      ->type_name("camera|eye")
      ->check(CLI::IsMember({"camera", "eye"}))
      ->capture_default_str();
  verb.add_option("--isa", options.isa,
                  "Embree's instruction set: sse2, sse4.2, avx, avx2 or avx512; left out: the best of this machine. "
                  "Name one where several machines must give the same bytes")
      ->type_name("NAME");
  verb.add_option("--blender", options.blender.program,
                  "the Blender that exports a .blend scene; left out: blender in PATH")
      ->type_name("PATH")
      ->check(RefuseEmpty);
}

void AddAnimationOption(CLI::App& verb, SceneOptions& options) {
  verb.add_option("--animation", options.animation,
                  "which animation of a .glb or .gltf scene to play, with a frame's number: its name, or * for all at "
                  "once; left out: the first. scumble info lists them")
      ->type_name("NAME")
      ->check(RefuseEmpty);
}

void AddSceneOptions(CLI::App& verb, SceneOptions& options) {
  AddViewOptions(verb, options);
  AddAnimationOption(verb, options);
  AddCastOptions(verb, options);
  verb.add_flag("!--no-robust", options.robust,
                "without Embree's robust mode: rays may pass where two triangles meet; scumble tradeoff shows what it gains");
  verb.add_flag("--half", options.half, "16-bit half floats for colour layers; data layers stay 32-bit");
  verb.add_flag("--explain", options.explain, "print the plan: each layer, why, and what it costs");
}

void AddSampleOptions(CLI::App& verb, SceneOptions& options) {
  verb.add_option("--samples", options.samples, "paths a pixel, for lpe.* layers and under lights with extent")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxSamples))
      ->each([&options](const std::string&) { options.samples_given = true; })
      ->capture_default_str();
  verb.add_option("--max-bounces", options.max_bounces, "reflections after the first surface's; 0: direct light alone")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxBounces))
      ->capture_default_str();
}

void AddLightPathOptions(CLI::App& verb, SceneOptions& options) {
  verb.add_option("--seed", options.seed, "another seed, other noise of the same size; the same seed, the same bytes")
      ->type_name("N")
      ->check(RefuseNegative)
      ->capture_default_str();
  AddSampleOptions(verb, options);
  verb.get_option("--samples")->description(
      "paths a pixel, for lpe.* layers and under lights with extent; with --noise or --time-budget the most there may be");
  verb.add_option("--noise", options.noise, "sample lpe.* layers, 16 times or more, until the estimated error, RMS over mean, is below this")
      ->type_name("X")
      ->check(RefuseNoAmount("an error, as 0.05"));
  verb.add_option("--time-budget", options.time_budget_seconds,
                  "sample lpe.* layers for so many seconds, once at least; the samples that repeat it are printed")
      ->type_name("SECONDS")
      ->check(RefuseNoAmount("seconds, as 2.5"));
}

namespace {

Expected<std::optional<ViewAngles>> ParseView(const std::string& text) {
  if (text.empty()) return std::optional<ViewAngles>();
  SCUMBLE_ASSIGN(const auto numbers, ParseNumbers(text, 2, 3, "--view"));
  if (numbers[1] < -90.0 || numbers[1] > 90.0) return UsageError("--view " + text + ": elevation must be -90 to 90");
  if (numbers.size() == 3 && numbers[2] < 0.0) return UsageError("--view " + text + ": distance must be 0 or more");
  return std::optional(ViewAngles{numbers[0], numbers[1], numbers.size() == 3 ? numbers[2] : 0.0});
}

void WarnIfNothingShows(const GuideSet& guides, const std::string& scene) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  if (std::any_of(coverage.begin(), coverage.end(), [](float a) { return a > 0.0f; })) return;
  Warn(scene + ": the camera sees nothing, the picture is empty; try --view or another --camera");
}

Expected<Scene> LoadAnyScene(const SceneOptions& options, const Globals& globals, BlenderFilm* film) {
  BlenderOptions blender = options.blender;
  blender.wants_start = !options.view.empty();
  if (IsBlenderScene(options.scene)) return LoadBlenderScene(options.scene, blender, globals, film);
  return LoadScene(options.scene, TextureLoading::kWhenNeeded);
}

}  // namespace

Expected<Scene> OpenScene(const SceneOptions& options, const Globals& globals, BlenderFilm* film, bool warns) {
  SCUMBLE_ASSIGN(Scene scene, LoadAnyScene(options, globals, film));
  if (!warns) return scene;
  for (const std::string& warning : scene.warnings) Warn(options.scene + ": " + warning);
  return scene;
}

namespace {

// In letters of either case.
bool EndsWithOneOf(const std::string& path, std::initializer_list<const char*> endings) {
  std::string ending = fs::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

}  // namespace

bool IsScene(const std::string& path) { return EndsWithOneOf(path, {".glb", ".gltf", ".obj", ".ply", ".blend"}); }

bool IsExr(const std::string& path) { return EndsWithOneOf(path, {".exr"}); }

namespace {

Status CheckScene(const std::string& scene) {
  std::error_code failed;
  if (fs::is_directory(scene, failed)) return InputError(scene + " is a folder: name a scene file in it");
  const bool has_ending = IsScene(scene);
  if (!fs::exists(scene, failed) && has_ending) {
    const Expected<FrameName> name = FrameName::Parse(scene);
    if (!name || name->must_have_frame()) {
      return UsageError(scene + ": a scene of one file a frame is not read as a sequence; call scumble once a frame, with " +
                        "its file and --frame N, or export one animated .glb");
    }
  }
  if (has_ending) return Ok();
  const std::string ending = fs::path(scene).extension().string().substr(0, 40);
  return InputError(scene + " has " + (ending.empty() ? "no ending" : "the ending '" + ending + "'") +
                    "; expected a scene in .glb, .gltf, .obj, .ply or .blend");
}

}  // namespace

Status CheckSceneOptions(const SceneOptions& options) {
  SCUMBLE_RETURN_IF_ERROR(CheckScene(options.scene));
  if (!options.fps.empty()) SCUMBLE_RETURN_IF_ERROR(ParseFps(options.fps));
  SCUMBLE_RETURN_IF_ERROR(ParseSize(options.size));
  SCUMBLE_RETURN_IF_ERROR(ParseView(options.view));
  if (IsBlenderScene(options.scene)) {
    if (options.animation.empty()) return Ok();
    return UsageError("--animation is for glTF files; " + options.scene + " has a time of its own: leave it out");
  }
  if (options.blender.program.empty()) return Ok();
  return UsageError("--blender is for .blend scenes; " + options.scene + " is read without Blender: leave it out");
}

Expected<SceneGuides> MakeGuidesOf(Scene& scene, const SceneOptions& options, const LayerSet& layers,
                                   const Globals& globals, const Progress& progress, bool plan_only) {
  SCUMBLE_ASSIGN(const PreparedView prepared, ViewScene(scene, options, layers));
  for (const std::string& note : prepared.notes) Say(globals, note);
  return CastScene(scene, prepared.camera, nullptr, options, layers, globals, progress, plan_only);
}

Expected<PreparedView> ViewScene(Scene& scene, const SceneOptions& options, const LayerSet& layers) {
  SCUMBLE_ASSIGN(const Size size, ParseSize(options.size));
  SCUMBLE_ASSIGN(const auto view, ParseView(options.view));
  const double aspect = static_cast<double>(size.width) / size.height;
  bool needs_light = layers.Has(Layer::kLuminance) || layers.Has(Layer::kShadow);
  for (const Layer layer : {Layer::kLpeFull, Layer::kLpeLDE, Layer::kLpeLSE, Layer::kLpeLDDE, Layer::kLpeLD12E}) {
    needs_light = needs_light || layers.Has(layer);
  }
  needs_light = needs_light && options.key_light;
  return PrepareView(scene, options.camera, view, aspect, needs_light);
}

std::string GuideSettings(const SceneOptions& options) {
  std::string text = fmt::format("scumble {}; aa {}; normals {}; seed {}", SCUMBLE_VERSION, options.aa,
                                 options.normal_frame, options.seed);
  const auto add = [&](const char* name, std::string value) {
    std::replace(value.begin(), value.end(), ';', ',');
    text += fmt::format("; {} '{}'", name, value);
  };
  add("camera", options.camera), add("view", options.view), add("animation", options.animation);
  add("fps", options.fps == kUsualFps ? "" : options.fps);
  // All of them always: what a file does not name differs.
  const bool open_ended = options.noise > 0.0 || options.time_budget_seconds > 0.0;
  return text + fmt::format("; robust {}; samples {}; bounces {}; noise {}", options.robust ? "yes" : "no",
                            open_ended && !options.samples_given ? kMaxSamples : options.samples, options.max_bounces,
                            options.noise);
}

Expected<SceneGuides> CastScene(Scene& scene, const Camera& camera, const NextFrame* next,
                                const SceneOptions& options, const LayerSet& layers, const Globals& globals,
                                const Progress& progress, bool plan_only) {
  SCUMBLE_ASSIGN(const Size size, ParseSize(options.size));
  SceneGuides result;
  GuidegenOptions guidegen;
  guidegen.width = size.width, guidegen.height = size.height;
  guidegen.layers = layers;
  guidegen.aa = options.aa;
  guidegen.normal_frame = options.normal_frame == "eye" ? NormalFrame::kEye : NormalFrame::kCamera;
  guidegen.threads = globals.threads;
  guidegen.isa = options.isa;
  guidegen.robust = options.robust;
  guidegen.progress = progress;
  guidegen.samples = options.samples;
  guidegen.max_bounces = options.max_bounces;
  guidegen.noise = options.noise;
  guidegen.seed = options.seed;
  guidegen.time_budget_seconds = options.time_budget_seconds;
  if (options.samples_given) guidegen.max_samples = options.samples;
  result.plan = PlanGuides(scene, guidegen);
  AddProgram(globals.threads, result.memory);
  AddScene(scene, CountNeededPixels(scene, options, layers), result.memory);
  AddGuides(size, layers, options, result.memory);
  if (options.more_memory) options.more_memory(size, layers, result.memory);
  if (plan_only) return result;
  SCUMBLE_RETURN_IF_ERROR(CheckMemory(result.memory, globals, "take a smaller --size, or fewer layers"));
  Stopwatch watch;
  SCUMBLE_ASSIGN(result.cost, DecodeNeededTextures(scene, options, layers));
  const double textures_ms = watch.Lap();
  EndStage(globals, "scene");
  SCUMBLE_ASSIGN(GuidegenResult rendered, next ? RenderGuides(scene, camera, *next, guidegen)
                                               : RenderGuides(scene, camera, guidegen));
  result.times.emplace_back("build", rendered.build_ms);
  result.times.emplace_back("rays", rendered.render_ms);
  result.guides = std::move(rendered.guides);
  result.cost.rays = rendered.rays, result.cost.work = rendered.work;
  result.samples = rendered.samples, result.noise = rendered.noise;
  if (options.half) RoundColorLayersToHalf(result.guides);
  result.guides.attributes["scumble:settings"] = GuideSettings(options);
  if (!scene.instances.empty()) WarnIfNothingShows(result.guides, options.scene);
  EndStage(globals, "guides", result.times);
  if (result.cost.textures_decoded > 0) result.times.insert(result.times.begin(), {"textures", textures_ms});
  return result;
}

void NameStyleInPlan(std::vector<PlanItem>& plan, const Style& style) {
  const LayerSet read = RequiredLayers(style);
  for (PlanItem& item : plan) {
    for (const LayerInfo& info : AllLayers()) {
      if (read.Has(info.layer) && item.layer == info.name) item.reason += ", read by style " + style.name;
    }
  }
}

std::string PlanToText(const std::vector<PlanItem>& plan) {
  std::size_t widest_layer = 5, widest_reason = 3;
  for (const PlanItem& item : plan) {
    widest_layer = std::max(widest_layer, item.layer.size());
    widest_reason = std::max(widest_reason, item.reason.size());
  }
  std::string text = fmt::format("{:<{}}  {:<{}}  {}\n", "layer", widest_layer, "why", widest_reason, "cost");
  for (const PlanItem& item : plan) {
    text += fmt::format("{:<{}}  {:<{}}  {}\n", item.layer, widest_layer, item.reason, widest_reason, item.cost);
  }
  return text;
}

nlohmann::ordered_json PlanToJson(const std::vector<PlanItem>& plan) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const PlanItem& item : plan) {
    json.push_back({{"layer", item.layer}, {"reason", item.reason}, {"cost", item.cost}});
  }
  return json;
}

void AddOneStyleOptions(CLI::App& verb, StyleOptions& options, bool required) {
  const std::string what = "style folder, style.toml, picture of a painted sphere, or a bundled style's name";
  auto* style = verb.add_option("--style", options.style, required ? what : what + "; adds the layers that it needs");
  style->type_name("STYLE");
  if (required) style->required();
  verb.add_option("--set", options.sets,
                  "overrides a key of style.toml, as transfer.blend_radius=0, in all styles of the picture; "
                  "NAME:transfer.scale=0.5 only in the one that --style or --assign gives as NAME; repeatable, the later "
                  "wins. scumble styles --keys lists them")
      ->type_name("[NAME:]KEY=VALUE")
      ->allow_extra_args(false);
}

void AddStyleOptions(CLI::App& verb, StyleOptions& options, bool required) {
  AddOneStyleOptions(verb, options, required);
  verb.add_option("--assign", options.assigned,
                  "another style for an object or material, * stands for any text, as 'Tree*=charcoal'; "
                  "NAME=rendered leaves it as it is, for --over; NAME=catcher shows only the shadows on it, with "
                  "transfer.shadow=paint; @FILE reads one such assignment a line, # begins a comment; repeatable, the "
                  "later wins")
      ->type_name("NAME=STYLE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb.add_flag("!--no-scene-styles", options.scene_styles,
                "do not heed the styles that the scene gives its objects and materials (custom property "
                "scumble_style); --assign goes before them in any case");
}

std::vector<fs::path> DataRoots(const std::string& name) {
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return {};
  const fs::path above = program.parent_path().parent_path();
  std::vector<fs::path> roots;
  for (const fs::path& root : {above / name, above / "share" / "scumble" / name}) {
    if (fs::is_directory(root, failed)) roots.push_back(root);
  }
  return roots;
}

std::vector<fs::path> StyleRoots() { return DataRoots("exemplars"); }

Expected<Style> OpenStyle(const StyleOptions& options) {
  SCUMBLE_ASSIGN(const fs::path found, FindStyle(options.style));
  return LoadStyle(found, options.sets);
}

Expected<fs::path> FindStyle(const std::string& name, const fs::path& base) {
  std::error_code failed;
  if (fs::exists(base / name, failed)) return base / name;
  std::string bundled;
  for (const fs::path& root : StyleRoots()) {
    for (const fs::path& style : FindStyles(root)) {
      if (style.filename() == name) return style;
      bundled += (bundled.empty() ? "" : ", ") + style.filename().string();
    }
  }
  return InputError("there is no style '" + name + "': expected a file, a folder, or " +
                    (bundled.empty() ? "a bundled style, of which none are found beside this program"
                                     : "one of the bundled styles " + bundled));
}

}  // namespace scumble
