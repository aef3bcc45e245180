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
#include "core/io/file/atomic_file.h"
#include "core/io/guide_file.h"
#include "guidegen/light/path_layers.h"
#include "guidegen/scene/pure_materials.h"
#include "measure/crosscheck/baseline.h"
#include "measure/crosscheck/crosscheck.h"
#include "measure/crosscheck/html.h"
#include "pipeline/scene/cycles_reference.h"
#include "pipeline/scene/run_inputs.h"
#include "pipeline/scene/scene_guides.h"
#include "pipeline/shell_quote.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBaselineBytes = 16 << 20;

struct CrosscheckVerb {
  std::vector<std::string> scenes;
  std::string size = "640x360";
  std::string camera;
  std::optional<int> frame;
  int samples = 64;
  int max_bounces = 8;
  std::string blender = "blender";
  std::string baseline;
  std::string write_baseline;
  std::string keep;
  bool fast_io = false;
  std::string html;
};

// Counts of samples at which the light is rendered, so that the noise's slope shows: N/16, N/4, N.
std::vector<int> SampleCounts(int samples) {
  std::vector<int> counts;
  for (const int divisor : {16, 4, 1}) {
    if (samples / divisor >= 1) counts.push_back(samples / divisor);
  }
  return counts;
}

// A scene in a baseline.
std::string NameInBaseline(const std::string& scene) { return fs::path(scene).filename().string(); }

// Both sides of a scene, and what there is to say about them.
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

std::string Listed(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

// Our guides: data as authored, light with pure materials.
Status MakeOurs(const CrosscheckVerb& verb, const std::string& path, const std::vector<int>& counts,
                const Globals& globals, const Progress& progress, BothSides& sides) {
  SceneRequest options;
  options.scene = path;
  SCUMBLE_ASSIGN(options.size, ParseSize(verb.size));
  options.camera = verb.camera;
  options.key_light = false;  // Blender would not let one shine
  if (IsBlenderScene(path)) options.blender = {verb.blender, verb.frame};
  SCUMBLE_ASSIGN(Scene scene, OpenScene(options, globals));
  sides.unsupported = scene.warnings;
  SCUMBLE_ASSIGN(SceneGuides data, MakeGuidesOf(scene, options, {Layer::kPosition, Layer::kAlbedo}, globals,
                                                Within(progress, 0.0, 0.02), false));
  sides.ours = std::move(data.guides);
  if (counts.empty()) return Ok();
  if (const std::vector<std::string> replaced = UsePureMaterials(scene); !replaced.empty()) {
    sides.warnings.push_back(
        "light is compared with pure materials on both sides, Lambert or GGX without Fresnel, instead of: " +
        Listed(replaced));
  }
  const RunContext silent = globals.WithoutNotes();  // the camera has been noted
  double begin = 0.02;
  constexpr double kOursEnd = 0.3;
  for (const int count : counts) {
    options.samples = count;
    options.max_bounces = verb.max_bounces;
    const double end = count == counts.back() ? kOursEnd : begin + 0.03;
    SCUMBLE_ASSIGN(SceneGuides light,
                   MakeGuidesOf(scene, options, PathLayers(), silent, Within(progress, begin, end), false));
    sides.ours_light.push_back(std::move(light.guides));
    begin = end;
  }
  return Ok();
}

Expected<BothSides> MakeBothSides(const CrosscheckVerb& verb, const std::string& path, const std::vector<int>& counts,
                                  const Globals& globals) {
  SCUMBLE_ASSIGN(const Size size, ParseSize(verb.size));
  BothSides sides;
  const Progress progress = globals.StartProgress("crosscheck");
  SCUMBLE_RETURN_IF_ERROR(MakeOurs(verb, path, counts, globals, progress, sides));
  ReferenceOptions options{verb.blender, path,       size.width, size.height,
                           verb.camera,  verb.frame, counts,     verb.max_bounces};
  SCUMBLE_ASSIGN(sides.reference,
                 RenderReference(options, globals, Within(progress, counts.empty() ? 0.02 : 0.3, 1.0)));
  for (const std::string& line : sides.reference.unsupported) AddUnknown(line, sides.unsupported);
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
Status KeepGuides(const CrosscheckVerb& verb, const std::string& scene, const GuideSet& reference, const GuideSet& ours,
                  const std::vector<CrosscheckLight>& light, const Globals& globals) {
  const std::string stem = (fs::path(verb.keep) / fs::path(scene).stem()).string();
  GuideSet theirs_whole = reference, ours_whole = ours;
  if (!light.empty()) {
    AddLayers(light.back().reference.guides, theirs_whole);
    AddLayers(light.back().ours, ours_whole);
  }
  GuideWriteOptions write;
  if (verb.fast_io) write.compression = kFastCompression;
  SCUMBLE_RETURN_IF_ERROR(WriteGuides(stem + ".cycles.exr", theirs_whole, write));
  SCUMBLE_RETURN_IF_ERROR(WriteGuides(stem + ".ours.exr", ours_whole, write));
  globals.Note(stem + ".cycles.exr, " + stem + ".ours.exr: the guides of both sides");
  return Ok();
}

Expected<CrosscheckReport> CheckScene(const CrosscheckVerb& verb, const std::string& scene, const Globals& globals) {
  const std::vector<int> counts = SampleCounts(verb.samples);
  SCUMBLE_ASSIGN(BothSides sides, MakeBothSides(verb, scene, counts, globals));
  const CrosscheckOptions options{2, !verb.html.empty(), std::move(sides.reference.only_shines)};
  std::vector<CrosscheckLight> light;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    light.push_back({counts[i], std::move(sides.reference.light[i]), std::move(sides.ours_light[i])});
  }
  if (!verb.keep.empty()) {
    SCUMBLE_RETURN_IF_ERROR(KeepGuides(verb, scene, sides.reference.data, sides.ours, light, globals));
  }
  SCUMBLE_ASSIGN(CrosscheckReport report, Crosscheck(scene, sides.reference.data, sides.ours, options));
  SCUMBLE_RETURN_IF_ERROR(CrosscheckLightLayers(sides.reference.data, sides.ours, light, options, report));
  report.setup.max_bounces = verb.samples > 0 ? verb.max_bounces : 0;
  report.setup.camera = verb.camera;
  report.setup.frame = verb.frame;
  report.unsupported = std::move(sides.unsupported);
  report.warnings = std::move(sides.warnings);
  report.scumble_version = SCUMBLE_VERSION;
  report.blender_version = sides.reference.version;
  return report;
}

// ---- Before the work
// --------------------------------------------------------------------------------------------------

Status CheckScenes(const CrosscheckVerb& verb) {
  std::set<std::string> names, stems;
  for (const std::string& scene : verb.scenes) {
    std::string ending = fs::path(scene).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (ending != ".glb" && ending != ".gltf" && !IsBlenderScene(scene)) {
      return InputError(scene +
                        ": a cross-check needs a scene with a camera that Blender reads too: .glb, .gltf or .blend");
    }
    if (verb.frame && !IsBlenderScene(scene)) {
      return UsageError("--frame is for .blend scenes; " + scene + " has no frames: leave it out");
    }
    if (!names.insert(NameInBaseline(scene)).second && !(verb.baseline.empty() && verb.write_baseline.empty())) {
      return UsageError(NameInBaseline(scene) +
                        " is the file name of two scenes, and a baseline knows scenes by it: check them in "
                        "two runs");
    }
    if (!stems.insert(fs::path(scene).stem().string()).second && !verb.keep.empty()) {
      return UsageError("two scenes would be kept as " + fs::path(scene).stem().string() +
                        ".cycles.exr: keep them in two runs");
    }
  }
  return Ok();
}

// Told before minutes of rendering, not after.
Status CheckTargets(const CrosscheckVerb& verb) {
  RunInputs files;
  for (const std::string& scene : verb.scenes) files.ReadsScene(scene);
  if (!verb.write_baseline.empty()) SCUMBLE_RETURN_IF_ERROR(files.CheckOutput(verb.write_baseline));
  files.Reads("the baseline", verb.baseline);  // which --write-baseline may bring up to date
  if (!verb.html.empty()) SCUMBLE_RETURN_IF_ERROR(files.CheckOutput(verb.html));
  if (verb.keep.empty()) return Ok();
  std::error_code failed;
  fs::create_directories(verb.keep, failed);
  if (!fs::is_directory(fs::status(verb.keep, failed)))
    return OutputError("--keep " + verb.keep + " is no folder and none can be made: " + failed.message());
  for (const std::string& scene : verb.scenes) {
    for (const char* side : {".cycles.exr", ".ours.exr"}) {
      SCUMBLE_RETURN_IF_ERROR(CheckWritable(fs::path(verb.keep) / (fs::path(scene).stem().string() + side)));
    }
  }
  return Ok();
}

Expected<Baseline> ReadBaseline(const std::string& path) {
  SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path, kMaxBaselineBytes));
  return ParseBaseline({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
}

CrosscheckSetup SetupOf(const CrosscheckVerb& verb, const Size& size) {
  return {size.width, size.height, verb.samples, verb.samples > 0 ? verb.max_bounces : 0, verb.camera, verb.frame};
}

// A scene that the baseline cannot judge is an error, unless this run is about to measure it anew.
Status CheckBaselineFits(const CrosscheckVerb& verb, const Baseline& baseline, const Globals& globals) {
  SCUMBLE_ASSIGN(const Size size, ParseSize(verb.size));
  const CrosscheckSetup setup = SetupOf(verb, size);
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

// ---- The work
// ---------------------------------------------------------------------------------------------------------

std::string RepeatCommand(const CrosscheckVerb& verb) {
  std::string command = "scumble crosscheck";
  for (const std::string& scene : verb.scenes) command += " " + Quoted(scene.front() == '-' ? "./" + scene : scene);
  command += fmt::format(" --size {} --samples {}", verb.size, verb.samples);
  if (verb.samples > 0) command += fmt::format(" --max-bounces {}", verb.max_bounces);
  if (!verb.camera.empty()) command += " --camera=" + Quoted(verb.camera);
  if (verb.frame) command += fmt::format(" --frame {}", *verb.frame);
  if (verb.blender != "blender") command += " --blender " + Quoted(verb.blender);
  if (!verb.baseline.empty()) command += " --baseline " + Quoted(verb.baseline);
  return command;
}

// Entries of scenes that this run did not check stay as they are.
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

// An error is what would stop every other scene too: no Blender.
Expected<CheckedScenes> CheckAllScenes(const CrosscheckVerb& verb, const Baseline& baseline, const Globals& globals) {
  SCUMBLE_ASSIGN(const Size size, ParseSize(verb.size));
  CheckedScenes checked;
  for (const std::string& scene : verb.scenes) {
    Expected<CrosscheckReport> made = CheckScene(verb, scene, globals);
    CrosscheckReport report;
    if (made) {
      report = std::move(*made);
      checked.blender_version = report.blender_version;
      if (!verb.baseline.empty()) JudgeByBaseline(verb.baseline, baseline, globals, report);
    } else {
      if (made.error().kind == ErrorKind::kUnavailable && checked.reports.empty()) return made.error();
      report.scene = scene, report.failure = made.error().message, report.setup = SetupOf(verb, size);
      report.scumble_version = SCUMBLE_VERSION;
      if (!checked.first_failure) checked.first_failure = made.error();
    }
    if (!globals.json) Print(CrosscheckToText(report));
    checked.reports.push_back(std::move(report));
  }
  return checked;
}

// The failure decides the exit code; limits that broke elsewhere are not to be lost in it.
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

Expected<ExitCode> RunCrosscheckVerb(const CrosscheckVerb& verb, const Globals& globals) {
  SCUMBLE_RETURN_IF_ERROR(ParseSize(verb.size));
  SCUMBLE_RETURN_IF_ERROR(CheckScenes(verb));
  SCUMBLE_RETURN_IF_ERROR(CheckTargets(verb));
  Baseline baseline;
  if (!verb.baseline.empty()) {
    SCUMBLE_ASSIGN(baseline, ReadBaseline(verb.baseline));
    SCUMBLE_RETURN_IF_ERROR(CheckBaselineFits(verb, baseline, globals));
  }
  SCUMBLE_ASSIGN(const CheckedScenes checked, CheckAllScenes(verb, baseline, globals));
  if (globals.json) Print(CrosscheckToJson(checked.reports));
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
  sub->add_option("--camera", verb->camera, "camera by name; left out: the scene's first")->type_name("NAME");
  sub->add_option("--frame", verb->frame, "frame of .blend scenes; left out: the one that they were saved at")
      ->type_name("N");
  sub->add_option(
         "--samples", verb->samples,
         "paths a pixel for the light layers, on both sides; also a quarter and a sixteenth of it, to show how noise "
         "falls. 0: data layers alone")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxSamples))
      ->capture_default_str();
  sub->add_option("--max-bounces", verb->max_bounces, "reflections after the first surface's; 0: direct light alone")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxBounces))
      ->capture_default_str();
  sub->add_option("--baseline", verb->baseline, "limits from this file, where they are tighter than the built-in ones")
      ->type_name("FILE");
  sub->add_option("--write-baseline", verb->write_baseline, "write what was measured, with some room, as a baseline")
      ->type_name("FILE");
  auto* keep =
      sub->add_option("--keep", verb->keep, "keep both sides' guides here, as SCENE.cycles.exr and SCENE.ours.exr");
  keep->type_name("FOLDER");
  AddFastIoOption(*sub, verb->fast_io)->needs(keep);
  sub->add_option("--blender", verb->blender, "the Blender to run")
      ->type_name("PATH")
      ->check(RefuseEmpty)
      ->capture_default_str();
  sub->add_option("-o,--output", verb->html, "report to write: one .html file, pictures included")->type_name("FILE");
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunCrosscheckVerb(*verb, globals); }; });
}

}  // namespace scumble
