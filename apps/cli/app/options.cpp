#include "apps/cli/app/options.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include "core/image/guides.h"
#include "pipeline/memory_limit.h"
#include "pipeline/stage_clock.h"

namespace scumble {

void AddGlobalOptions(CLI::App& verb, Globals& globals) {
  verb.add_flag("-q,--quiet", globals.quiet, "say nothing on stderr but errors and warnings");
  verb.add_flag("--json", globals.json, "print the result as JSON");
  verb.add_option("--threads", globals.threads, "threads to use; 0: all")
      ->type_name("N")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

CLI::Option* AddFastIoOption(CLI::App& verb, bool& fast_io) {
  return verb.add_flag(
      "--fast-io", fast_io,
      "of EXR files the compression that is written and read in the least time, rle: the same pixels, larger "
      "files");
}

std::string RefuseNegative(const std::string& text) {
  if (text.rfind('-', 0) == 0) return text + " is negative: expected a whole number, 0 or more";
  std::uint64_t value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return read.ec == std::errc::result_out_of_range ? text + " is too large: expected less than 2^64" : "";
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

std::string RefuseEmpty(const std::string& text) {
  return text.empty() ? "it is empty: give a name, or leave it out" : "";
}

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
  SCUMBLE_RETURN_IF_ERROR(CheckSize(size, text));
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
    const bool is_number = (failure == std::errc() && !std::isnan(value)) || failure == std::errc::result_out_of_range;
    if (!is_number || (next != end && *next != ',')) break;
    if (failure != std::errc() || std::abs(value) > 1e9)
      return UsageError(what + " " + text + ": expected numbers from -1e9 to 1e9");
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

namespace {

std::string RefuseNoSmoothing(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [read, failure] = std::from_chars(text.data(), end, value);
  if (failure == std::errc() && read == end && value >= 0.0 && value <= 180.0) return "";
  return "'" + text + "' is no angle: expected degrees, 0 to 180";
}

}  // namespace

void AddViewOptions(CLI::App& verb, SceneOptions& options) {
  // CLI11 2.4 allows no argument of an option's name, --scene.
  verb.add_option(
          "scene_file", options.request.scene,
          "scene file: .glb, .gltf, .obj, .ply, or .blend, which Blender exports first (3.4.1 and 4.3.2 tested)")
      ->type_name("FILE")
      ->required();
  verb.add_option("--size", options.size, "pixels of the picture; one number makes a square")
      ->type_name("WIDTHxHEIGHT")
      ->capture_default_str();
  verb.add_option("--camera", options.request.camera, "camera by name; left out: the scene's first")->type_name("NAME");
  verb.add_option(
          "--view", options.view,
          "look at the scene's centre instead of through a camera: AZIMUTH,ELEVATION[,DISTANCE[,RIGHT,UP[,FOV]]] in "
          "degrees from +Z towards +X, degrees above the horizon, metres; without DISTANCE, or with 0, the scene is "
          "framed; RIGHT and UP move what is looked at in the picture plane, metres; FOV is the vertical angle of "
          "view, degrees, otherwise 35")
      ->type_name("AZ,EL[,DIST[,RIGHT,UP[,FOV]]]");
  verb.add_option("--light", options.light,
                  "one sun in place of the scene's lights and world: AZIMUTH,ELEVATION in degrees of the view, 0,0 "
                  "from the viewer, 90,0 from the right, 0,90 from above; surfaces that glow still do")
      ->type_name("AZ,EL");
  verb.add_option("--auto-smooth", options.request.auto_smooth_degrees,
                  "where the file gives no normals, faces up to so many degrees apart are smooth, 0 to 180; 0: flat. "
                  "Left out: glTF is flat, OBJ as its smoothing groups say, other OBJ and PLY smooth up to 60")
      ->type_name("DEGREES")
      ->check(RefuseNoSmoothing);
}

void AddCastOptions(CLI::App& verb, SceneOptions& options) {
  verb.add_option("--aa", options.request.aa,
                  "N x N subsamples, 1 to 16, for smooth outlines and borders between objects")
      ->type_name("N")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  verb.add_option("--normal-frame", options.normal_frame,
                  "camera: normals in view space; eye: relative to each pixel's own view, for wide cameras")
      ->type_name("camera|eye")
      ->check(CLI::IsMember({"camera", "eye"}))
      ->capture_default_str();
  verb.add_flag("--raw-normals", options.request.raw_normals,
                "keep shading normals that would mirror the line of sight into the surface, as on coarse smooth "
                "meshes; left out: they are bent, in guides and in light, as Cycles does");
  verb.add_option("--isa", options.request.isa,
                  "Embree's instruction set: sse2, sse4.2, avx, avx2 or avx512; left out: the best of this machine. "
                  "Name one where several machines must give the same bytes")
      ->type_name("NAME");
  AddBlenderOptions(verb, options.request.blender);
}

void AddBlenderOptions(CLI::App& verb, BlenderRequest& request) {
  verb.add_option("--blender", request.program, "the Blender that exports a .blend scene; left out: blender in PATH")
      ->type_name("PATH")
      ->check(RefuseEmpty);
  AddSceneNameOptions(verb, request.scene, request.view_layer);
}

void AddSceneNameOptions(CLI::App& verb, std::string& scene, std::string& view_layer) {
  verb.add_option("--scene", scene,
                  "which scene of a .blend, by name; left out: the one that was open when it was saved")
      ->type_name("NAME")
      ->check(RefuseEmpty);
  verb.add_option("--view-layer", view_layer,
                  "which view layer of a .blend's scene, by name; left out: the first one that is rendered")
      ->type_name("NAME")
      ->check(RefuseEmpty);
}

void AddAnimationOption(CLI::App& verb, SceneOptions& options) {
  verb.add_option("--animation", options.request.animation,
                  "which animation of a .glb or .gltf scene to play, with a frame's number: its name, or * for all at "
                  "once; left out: the first. scumble info lists them")
      ->type_name("NAME")
      ->check(RefuseEmpty);
}

void AddSceneOptions(CLI::App& verb, SceneOptions& options) {
  AddViewOptions(verb, options);
  AddAnimationOption(verb, options);
  AddCastOptions(verb, options);
  verb.add_flag(
      "!--no-robust", options.request.robust,
      "without Embree's robust mode: rays may pass where two triangles meet; scumble tradeoff shows what it gains");
  verb.add_flag("--half", options.request.half, "16-bit half floats for colour layers; data layers stay 32-bit");
  verb.add_flag("--explain", options.explain, "print the plan: each layer, why, and what it costs");
}

void AddSampleOptions(CLI::App& verb, SceneOptions& options) {
  verb.add_option(
          "--samples", options.request.samples,
          "paths a pixel, for lpe.* layers and under lights with extent; left out, each pixel takes 4 to 64 for "
          "luminance and shadow, until more would hardly show")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxSamples))
      ->each([&options](const std::string&) { options.request.samples_given = true; })
      ->capture_default_str();
  verb.add_option("--max-bounces", options.request.max_bounces,
                  "reflections after the first surface's; 0: direct light alone")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxBounces))
      ->capture_default_str();
}

void AddLightPathOptions(CLI::App& verb, SceneOptions& options) {
  verb.add_option("--seed", options.request.seed,
                  "another seed, other noise of the same size; the same seed, the same bytes")
      ->type_name("N")
      ->check(RefuseNegative)
      ->capture_default_str();
  AddSampleOptions(verb, options);
  verb.get_option("--samples")
      ->description(
          "paths a pixel, for lpe.* layers and under lights with extent; left out, each pixel takes 4 to 64 for "
          "luminance and shadow, until more would hardly show; with --noise or --time-budget the most there may be");
  verb.add_option("--noise", options.request.noise,
                  "sample lpe.* layers, 16 times or more, until the estimated error, RMS over mean, is below this")
      ->type_name("X")
      ->check(RefuseNoAmount("an error, as 0.05"));
  verb.add_option("--time-budget", options.request.time_budget_seconds,
                  "sample lpe.* layers for so many seconds, once at least; the samples that repeat it are printed")
      ->type_name("SECONDS")
      ->check(RefuseNoAmount("seconds, as 2.5"));
}

namespace {

Expected<std::optional<ViewAngles>> ParseView(const std::string& text) {
  if (text.empty()) return std::optional<ViewAngles>();
  SCUMBLE_ASSIGN(auto numbers, ParseNumbers(text, 2, 6, "--view"));
  if (numbers.size() == 4) return UsageError("--view " + text + ": RIGHT needs UP: AZ,EL,DIST,RIGHT,UP");
  numbers.resize(6, 0.0);
  const ViewAngles view{numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]};
  if (const Status good = CheckView(view); !good.ok())
    return UsageError("--view " + text + ": " + good.error().message);
  return std::optional(view);
}

Expected<std::optional<LightAngles>> ParseLight(const std::string& text) {
  if (text.empty()) return std::optional<LightAngles>();
  SCUMBLE_ASSIGN(const auto numbers, ParseNumbers(text, 2, 2, "--light"));
  const LightAngles light{numbers[0], numbers[1]};
  if (const Status good = CheckLight(light); !good.ok()) {
    return UsageError("--light " + text + ": " + good.error().message);
  }
  return std::optional(light);
}

}  // namespace

Expected<SceneRequest> ToRequest(const SceneOptions& options) {
  SceneRequest request = options.request;
  SCUMBLE_ASSIGN(request.size, ParseSize(options.size));
  SCUMBLE_ASSIGN(request.view, ParseView(options.view));
  SCUMBLE_ASSIGN(request.light, ParseLight(options.light));
  request.normal_frame = options.normal_frame == "eye" ? NormalFrame::kEye : NormalFrame::kCamera;
  if (!options.fps.empty()) {
    SCUMBLE_ASSIGN(request.fps, ParseFrameRate(options.fps));
  }
  return request;
}

Expected<StyleRequest> ToRequest(const StyleOptions& options) {
  StyleRequest request = options.request;
  SCUMBLE_ASSIGN(request.sets, ParseStyleOverrides(options.sets));
  return request;
}

void AddOneStyleOptions(CLI::App& verb, StyleOptions& options, bool required) {
  const std::string what = "style folder, style.toml, picture of a painted sphere, or a bundled style's name";
  auto* style =
      verb.add_option("--style", options.request.style, required ? what : what + "; adds the layers that it needs");
  style->type_name("STYLE");
  if (required) style->required();
  verb.add_option(
          "--set", options.sets,
          "overrides a key of style.toml, as transfer.blend_radius=0, in all styles of the picture; "
          "NAME:transfer.scale=0.5 only in the one that --style or --assign gives as NAME; repeatable, the later "
          "wins. scumble styles --keys lists them")
      ->type_name("[NAME:]KEY=VALUE")
      ->allow_extra_args(false);
}

void AddFinishOptions(CLI::App& verb, std::vector<std::string>& finishes, std::optional<FinishMeasures>& measures) {
  verb.add_option("--finish", finishes,
                  "finishing effects after the transfer: a preset, an effect or a preset's file; `scumble finish "
                  "--list` names them; none leaves out the style's own; repeatable")
      ->type_name("NAME")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb.add_option_function<std::string>(
          "--finish-measures",
          [&measures](const std::string& text) {
            const std::vector<double> given = ParseNumbers(text, 5, 5, "").value();
            measures = FinishMeasures{given[0], given[1], given[2], given[3], given[4]};
          },
          "what --finish measures on the first picture that shows a surface, as a run prints it: near, middle and far "
          "depth, and how bright luminance and lpe.full are; for frames that are made by several runs")
      ->type_name("A,B,C,D,E")
      ->check([](const std::string& text) {
        const auto given = ParseNumbers(text, 5, 5, "--finish-measures");
        if (!given) return given.error().message;
        return (*given)[3] > 0.0 && (*given)[4] > 0.0 ? std::string() : "the last two must be above 0";
      });
}

void AddStyleOptions(CLI::App& verb, StyleOptions& options, bool required) {
  StyleRequest& request = options.request;
  AddOneStyleOptions(verb, options, required);
  verb.add_option("--assign", request.assigned,
                  "another style for an object or material, * stands for any text, as 'Tree*=charcoal'; "
                  "NAME=rendered leaves it as it is, for --over; NAME=catcher shows only the shadows on it, with "
                  "transfer.shadow=paint; @FILE reads one such assignment a line, # begins a comment; repeatable, the "
                  "later wins")
      ->type_name("NAME=STYLE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  AddFinishOptions(verb, request.finishes, request.finish_measures);
  verb.add_flag("!--no-scene-styles", request.scene_styles,
                "do not heed the styles that the scene gives its objects and materials (custom property "
                "scumble_style); --assign goes before them in any case");
}

Expected<std::optional<double>> ParseExposure(const std::string& text) {
  if (text == "auto") return std::optional<double>();
  double stops = 0.0;
  const auto [parsed, failure] = std::from_chars(text.data(), text.data() + text.size(), stops);
  if (failure != std::errc() || parsed != text.data() + text.size() || !(std::fabs(stops) <= 64.0)) {
    return UsageError("--exposure " + text + ": expected auto, or stops from -64 to 64");
  }
  return std::optional(stops);
}

namespace {

std::string RefuseEmptyRate(const std::string& text) {
  return text.empty() ? "it is empty: give a rate, or leave it out" : "";
}

}  // namespace

void AddFpsOption(CLI::App& verb, std::string& fps, const std::string& help) {
  verb.add_option("--fps", fps, help)->type_name("RATE")->check(RefuseEmptyRate);
}

void AddMemoryOption(CLI::App& verb, Globals& globals) {
  verb.add_option_function<std::string>(
          "--max-memory", [&globals](const std::string& text) { globals.max_memory = ParseBytes(text).value(); },
          "memory that the run may take, as 4G or 800M, in powers of 1024; it is estimated before it is taken, and "
          "what needs "
          "more is refused. Left out: what the machine, its control group and ulimit -v have")
      ->type_name("SIZE")
      ->check([](const std::string& text) {
        const auto bytes = ParseBytes(text);
        return bytes ? std::string() : bytes.error().message;
      });
}

void AddTimingOption(CLI::App& verb, Globals& globals) {
  verb.add_flag_callback(
      "--timing", [&globals] { globals.clock = std::make_shared<StageClock>(); },
      "print where the time went, from the start of the process: wall and processor time of each stage");
}

}  // namespace scumble
