// scumble crosscheck: our guides against those that Blender's Cycles renders of the same view.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <set>
#include <system_error>

#include "apps/cli/app/command.h"
#include "apps/cli/app/options.h"
#include "core/io/atomic_file.h"
#include "core/io/guide_file.h"
#include "guidegen/path_layers.h"
#include "guidegen/pure_materials.h"
#include "measure/crosscheck.h"
#include "measure/crosscheck_baseline.h"
#include "measure/crosscheck_page.h"
#include "pipeline/crosscheck_scene.h"
#include "pipeline/run_inputs.h"
#include "pipeline/scene_guides.h"
#include "pipeline/shell_quote.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBaselineBytes = 16 << 20;

struct CrosscheckVerb {
  std::vector<std::string> scenes;
  std::string size = "640x360";  // becomes request.size
  CrosscheckRequest request;
  std::string baseline;
  std::string write_baseline;
  std::string html;
};

// A scene in a baseline.
std::string NameInBaseline(const std::string& scene) { return fs::path(scene).filename().string(); }

std::string Listed(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

// ---- Before the work ------------------------------------------------------------------------------------------------

Status CheckScenes(const CrosscheckVerb& verb) {
  std::set<std::string> names, stems;
  for (const std::string& scene : verb.scenes) {
    std::string ending = fs::path(scene).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (ending != ".glb" && ending != ".gltf" && !IsBlenderScene(scene)) {
      return InputError(scene +
                        ": a cross-check needs a scene with a camera that Blender reads too: .glb, .gltf or .blend");
    }
    if (verb.request.frame && !IsBlenderScene(scene)) {
      return UsageError("--frame is for .blend scenes; " + scene + " has no frames: leave it out");
    }
    BlenderRequest blender;
    blender.scene = verb.request.blender_scene, blender.view_layer = verb.request.view_layer;
    if (!IsBlenderScene(scene)) SCUMBLE_RETURN_IF_ERROR(CheckWithoutBlender(scene, blender));
    if (!names.insert(NameInBaseline(scene)).second && !(verb.baseline.empty() && verb.write_baseline.empty())) {
      return UsageError(NameInBaseline(scene) +
                        " is the file name of two scenes, and a baseline knows scenes by it: check them in "
                        "two runs");
    }
    if (!stems.insert(fs::path(scene).stem().string()).second && !verb.request.keep.empty()) {
      return UsageError("two scenes would be kept as " + fs::path(scene).stem().string() +
                        ".cycles.exr: keep them in two runs");
    }
  }
  return Ok();
}

// Checked before minutes of rendering, not after.
Status CheckTargets(const CrosscheckVerb& verb, RunInputs files) {
  if (!verb.write_baseline.empty()) SCUMBLE_RETURN_IF_ERROR(files.CheckOutput(verb.write_baseline));
  files.Reads("the baseline", verb.baseline);  // which --write-baseline may bring up to date
  const std::string ending = fs::path(verb.html).extension().string();
  if (!ending.empty() && ending != ".html" && ending != ".htm")
    return UsageError("-o " + verb.html + " ends in " + ending + ": the report is a page; expected a name in .html");
  if (!verb.html.empty()) SCUMBLE_RETURN_IF_ERROR(files.CheckOutput(verb.html));
  if (verb.request.keep.empty()) return Ok();
  std::error_code failed, unknown;
  fs::create_directories(verb.request.keep, failed);
  if (!fs::is_directory(verb.request.keep, unknown))
    return OutputError("--keep " + verb.request.keep + " is no folder and none can be made: " + failed.message());
  for (const std::string& scene : verb.scenes) {
    for (const char* side : {".cycles.exr", ".ours.exr"}) {
      SCUMBLE_RETURN_IF_ERROR(CheckWritable(fs::path(verb.request.keep) / (fs::path(scene).stem().string() + side)));
    }
  }
  return Ok();
}

Expected<Baseline> ReadBaseline(const std::string& path) {
  SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path, kMaxBaselineBytes));
  return ParseBaseline({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
}

CrosscheckSetup SetupOf(const CrosscheckVerb& verb) {
  return {verb.request.size.width,    verb.request.size.height,
          verb.request.samples,       verb.request.samples > 0 ? verb.request.max_bounces : 0,
          verb.request.camera,        verb.request.frame,
          verb.request.blender_scene, verb.request.view_layer};
}

// A scene that the baseline does not apply to is an error, unless this run measures it anew.
Status CheckBaselineFits(const CrosscheckVerb& verb, const Baseline& baseline, const Globals& globals) {
  const CrosscheckSetup setup = SetupOf(verb);
  std::set<std::string> unchecked;
  for (const auto& [name, scene] : baseline.scenes) unchecked.insert(name);
  for (const std::string& scene : verb.scenes) {
    unchecked.erase(NameInBaseline(scene));
    const std::string mismatch = BaselineMismatch(baseline, NameInBaseline(scene), setup);
    if (mismatch.empty()) continue;
    if (verb.write_baseline.empty()) return InputError(verb.baseline + ": " + mismatch);
    globals.Warn(verb.baseline + ": " + mismatch + "; " + scene + " is judged by the built-in limits alone");
  }
  if (!unchecked.empty()) {
    globals.Warn(verb.baseline + ": this run does not check " + Listed({unchecked.begin(), unchecked.end()}));
  }
  return Ok();
}

// ---- The work -------------------------------------------------------------------------------------------------------

std::string RepeatCommand(const CrosscheckVerb& verb) {
  std::string command = "scumble crosscheck";
  for (const std::string& scene : verb.scenes) command += " " + Quoted(scene.front() == '-' ? "./" + scene : scene);
  command += fmt::format(" --size {} --samples {}", verb.size, verb.request.samples);
  if (verb.request.samples > 0) command += fmt::format(" --max-bounces {}", verb.request.max_bounces);
  if (!verb.request.camera.empty()) command += " --camera=" + Quoted(verb.request.camera);
  if (verb.request.frame) command += fmt::format(" --frame {}", *verb.request.frame);
  if (!verb.request.blender_scene.empty()) command += " --scene=" + Quoted(verb.request.blender_scene);
  if (!verb.request.view_layer.empty()) command += " --view-layer=" + Quoted(verb.request.view_layer);
  if (verb.request.blender != "blender") command += " --blender " + Quoted(verb.request.blender);
  if (!verb.baseline.empty()) command += " --baseline " + Quoted(verb.baseline);
  return command;
}

// Entries of scenes outside this run stay.
Status WriteBaseline(const CrosscheckVerb& verb, const std::vector<CrosscheckReport>& reports, Baseline baseline,
                     const Globals& globals) {
  for (const CrosscheckReport& report : reports) {
    if (!report.KeepsBuiltInLimits()) {
      globals.Warn(verb.write_baseline + " is not written: " + report.scene +
                   (report.failure.empty() ? " does not keep the built-in limits" : " could not be compared"));
      return Ok();
    }
    baseline.blender = report.blender_version;
    RecordInBaseline(report, NameInBaseline(report.scene), baseline);
  }
  SCUMBLE_RETURN_IF_ERROR(WriteFileAtomically(verb.write_baseline, BaselineToJson(baseline)));
  globals.Note(verb.write_baseline + ": the baseline");
  return Ok();
}

// Scenes that could not be compared have the failure as their verdict.
struct CheckedScenes {
  std::vector<CrosscheckReport> reports;
  std::optional<Error> first_failure;
  std::string blender_version;
};

void JudgeByBaseline(const std::string& file, const Baseline& baseline, const Globals& globals,
                     CrosscheckReport& report) {
  const std::string name = NameInBaseline(report.scene);
  if (!baseline.blender.empty() && baseline.blender != report.blender_version) {
    globals.Warn(file + " was measured with Blender " + baseline.blender + ", this is " + report.blender_version);
  }
  report.baseline_mismatch = BaselineMismatch(baseline, name, report.setup);
  if (!report.baseline_mismatch.empty()) return;
  for (const std::string& note : ApplyBaseline(baseline, name, report)) globals.Warn(file + ": " + note);
}

// An error stops every other scene too: Blender is missing. `files` is told what each scene consists of.
Expected<CheckedScenes> CheckAllScenes(const CrosscheckVerb& verb, const Baseline& baseline, const Globals& globals,
                                       RunInputs& files) {
  CheckedScenes checked;
  CrosscheckRequest request = verb.request;
  for (const std::string& scene : verb.scenes) {
    request.on_file = files.ReadsScene(scene);
    Expected<CrosscheckReport> made = CrosscheckScene(request, scene, globals);
    CrosscheckReport report;
    if (made) {
      report = std::move(*made);
      checked.blender_version = report.blender_version;
      if (!verb.baseline.empty()) JudgeByBaseline(verb.baseline, baseline, globals, report);
    } else {
      if (made.error().kind == ErrorKind::kUnavailable && checked.reports.empty()) return made.error();
      report.scene = scene, report.failure = made.error().message, report.setup = SetupOf(verb);
      report.scumble_version = SCUMBLE_VERSION;
      if (!checked.first_failure) checked.first_failure = made.error();
    }
    if (!globals.json) Print(CrosscheckToText(report));
    checked.reports.push_back(std::move(report));
  }
  return checked;
}

// The failure decides the exit code; limits that other scenes broke are reported as well.
Error FailureOf(const CheckedScenes& checked) {
  Error error = *checked.first_failure;
  int failed = 0, other = 0;
  for (const CrosscheckReport& report : checked.reports) {
    failed += !report.failure.empty();
    other += report.failure.empty() && !report.passed();
  }
  if (checked.reports.size() > 1) {
    error.message += fmt::format("; {} of {} scenes could not be compared", failed, checked.reports.size());
    if (other > 0) error.message += fmt::format(", {} more {} not agree", other, other == 1 ? "does" : "do");
  }
  return error;
}

Expected<ExitCode> RunCrosscheckVerb(CrosscheckVerb verb, const Globals& globals) {
  SCUMBLE_ASSIGN(verb.request.size, ParseSize(verb.size));
  verb.request.heat_maps = !verb.html.empty();
  SCUMBLE_RETURN_IF_ERROR(CheckScenes(verb));
  RunInputs files;
  for (const std::string& scene : verb.scenes) files.Reads("the scene", scene);
  SCUMBLE_RETURN_IF_ERROR(CheckTargets(verb, files));
  Baseline baseline;
  if (!verb.baseline.empty()) {
    SCUMBLE_ASSIGN(baseline, ReadBaseline(verb.baseline));
    SCUMBLE_RETURN_IF_ERROR(CheckBaselineFits(verb, baseline, globals));
  }
  SCUMBLE_ASSIGN(const CheckedScenes checked, CheckAllScenes(verb, baseline, globals, files));
  if (globals.json) Print(CrosscheckToJson(checked.reports));
  // Once more: what the scenes consist of is known now.
  if (!verb.html.empty()) SCUMBLE_RETURN_IF_ERROR(files.CheckOutput(verb.html));
  if (!verb.write_baseline.empty()) SCUMBLE_RETURN_IF_ERROR(files.CheckOutput(verb.write_baseline));
  if (!verb.html.empty()) {
    const CrosscheckRun run{"Cycles, Blender " + checked.blender_version, RepeatCommand(verb), verb.baseline};
    SCUMBLE_ASSIGN(const std::string html, CrosscheckToHtml(checked.reports, run));
    SCUMBLE_RETURN_IF_ERROR(WriteFileAtomically(verb.html, html));
    globals.Note(verb.html + ": the report");
  }
  if (!verb.write_baseline.empty()) {
    SCUMBLE_RETURN_IF_ERROR(WriteBaseline(verb, checked.reports, std::move(baseline), globals));
  }
  if (checked.first_failure) return FailureOf(checked);
  const bool passed = std::all_of(checked.reports.begin(), checked.reports.end(),
                                  [](const CrosscheckReport& report) { return report.passed(); });
  return passed ? ExitCode::kOk : ExitCode::kDiffers;
}

}  // namespace

void AddCrosscheckVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<CrosscheckVerb>();
  CLI::App* sub =
      app.add_subcommand("crosscheck", "our guides against those of Blender's Cycles: figures, limits, verdict");
  sub->add_option("scenes", verb->scenes, "scene files with a camera: .glb, .gltf or .blend")
      ->type_name("FILE")
      ->required();
  sub->add_option("--size", verb->size, "pixels of the pictures; one number makes a square")
      ->type_name("WIDTHxHEIGHT")
      ->capture_default_str();
  sub->add_option("--camera", verb->request.camera, "camera by name; left out: the scene's first")->type_name("NAME");
  sub->add_option("--frame", verb->request.frame, "frame of .blend scenes; left out: the one that they were saved at")
      ->type_name("N");
  sub->add_option(
         "--samples", verb->request.samples,
         "paths a pixel for the light layers, on both sides; also a quarter and a sixteenth of it, to show how noise "
         "falls. 0: data layers alone")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxSamples))
      ->capture_default_str();
  sub->add_option("--max-bounces", verb->request.max_bounces,
                  "reflections after the first surface's; 0: direct light alone")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxBounces))
      ->capture_default_str();
  sub->add_option("--baseline", verb->baseline, "limits from this file, where they are tighter than the built-in ones")
      ->type_name("FILE");
  sub->add_option("--write-baseline", verb->write_baseline, "write what was measured, with some room, as a baseline")
      ->type_name("FILE");
  auto* keep = sub->add_option("--keep", verb->request.keep,
                               "keep both sides' guides here, as SCENE.cycles.exr and SCENE.ours.exr");
  keep->type_name("FOLDER");
  AddFastIoOption(*sub, verb->request.fast_io)->needs(keep);
  sub->add_option("--blender", verb->request.blender, "the Blender to run")
      ->type_name("PATH")
      ->check(RefuseEmpty)
      ->capture_default_str();
  AddSceneNameOptions(*sub, verb->request.blender_scene, verb->request.view_layer);
  sub->add_option("-o,--output", verb->html, "report to write: one .html file, pictures included")->type_name("FILE");
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunCrosscheckVerb(*verb, globals); }; });
}

}  // namespace scumble
