// scumble crosscheck: our guides against those that Blender's Cycles renders of the same view.
#include "measure/crosscheck.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cli/blender_process.h"
#include "cli/command.h"
#include "cli/options.h"
#include "cli/progress_bar.h"
#include "io/atomic_file.h"
#include "io/guide_file.h"
#include "measure/crosscheck_html.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

struct CrosscheckVerb {
  std::vector<std::string> scenes;
  std::string size = "640x360";
  std::string camera;
  std::string blender = "blender";
  std::string html;
};

// Has Cycles render the data passes of the scene and reads them as guides.
Expected<GuideSet> RenderReference(const CrosscheckVerb& verb, const std::string& scene, const Globals& globals) {
  SCUMBLE_ASSIGN(const Size size, ParseSize(verb.size));
  SCUMBLE_ASSIGN(const fs::path script, FindBlenderScript("render_guides.py", scene));
  const ScratchFolder scratch;
  if (scratch.path().empty()) return OutputError("no folder can be made for temporary files: set TMPDIR to one that can");
  const fs::path picture = scratch.path() / "cycles.exr", log = scratch.path() / "log";
  std::vector<std::string> arguments{verb.blender,     "-b", "-noaudio", "--factory-startup", "-P", script.string(), "--",
                                     fs::absolute(scene).string(), picture.string(), "--size",
                                     fmt::format("{}x{}", size.width, size.height)};
  if (!verb.camera.empty()) arguments.insert(arguments.end(), {"--camera", verb.camera});
  Say(globals, scene + ": " + verb.blender + " renders the reference");
  SCUMBLE_ASSIGN(const ProgramEnd end, RunProgram(arguments, log));
  std::error_code failed;
  if (end.signal != 0 || end.code != 0 || !fs::is_regular_file(picture, failed)) {
    return InputError(scene + ": " + verb.blender + " rendered no reference: " + ReasonFrom(LinesOf(log)));
  }
  GuideReadOptions read;
  read.required = {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject, Layer::kPosition, Layer::kAlbedo};
  read.blender_camera = scratch.path() / "cycles.camera";
  return ReadGuides(picture, read);
}

Expected<CrosscheckReport> CrosscheckScene(const CrosscheckVerb& verb, const std::string& scene, const Globals& globals) {
  SceneOptions options;
  options.scene = scene;
  options.size = verb.size;
  options.camera = verb.camera;
  ProgressBar bar("crosscheck", globals.quiet);
  SCUMBLE_ASSIGN(const SceneGuides ours,
                 MakeGuides(options, {Layer::kPosition, Layer::kAlbedo}, globals, bar.Part(0.0, 1.0), false));
  SCUMBLE_ASSIGN(const GuideSet reference, RenderReference(verb, scene, globals));
  return Crosscheck(scene, reference, ours.guides, {2, !verb.html.empty()});
}

Expected<ExitCode> RunCrosscheckVerb(const CrosscheckVerb& verb, const Globals& globals) {
  for (const std::string& scene : verb.scenes) {
    const std::string ending = fs::path(scene).extension().string();
    if (ending != ".glb" && ending != ".gltf" && ending != ".blend") {
      return InputError(scene + ": a cross-check needs a scene with a camera that Blender reads too: .glb, .gltf or .blend");
    }
  }
  std::vector<CrosscheckReport> reports;
  bool passed = true;
  std::string command = "scumble crosscheck";
  for (const std::string& scene : verb.scenes) {
    SCUMBLE_ASSIGN(CrosscheckReport report, CrosscheckScene(verb, scene, globals));
    if (!globals.json) Print(CrosscheckToText(report));
    passed = passed && report.passed();
    command += " " + scene;
    reports.push_back(std::move(report));
  }
  if (globals.json) Print(CrosscheckToJson(reports));
  if (!verb.html.empty()) {
    SCUMBLE_ASSIGN(const std::string html,
                   CrosscheckToHtml(reports, {"Cycles, run by " + verb.blender, command + " --size " + verb.size}));
    SCUMBLE_RETURN_IF_ERROR(WriteFileAtomically(verb.html, html));
    Say(globals, verb.html + ": the report");
  }
  return passed ? ExitCode::kOk : ExitCode::kDiffers;
}

}  // namespace

void AddCrosscheckVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<CrosscheckVerb>();
  CLI::App* sub = app.add_subcommand("crosscheck", "our guides against those of Blender's Cycles: figures, limits, verdict");
  sub->add_option("scenes", verb->scenes, "scene files with a camera: .glb or .blend")->type_name("FILE")->required();
  sub->add_option("--size", verb->size, "pixels of the pictures; one number makes a square")
      ->type_name("WIDTHxHEIGHT")
      ->capture_default_str();
  sub->add_option("--camera", verb->camera, "camera by name; left out: the scene's first")->type_name("NAME");
  sub->add_option("--blender", verb->blender, "the Blender to run")->type_name("PATH")->capture_default_str();
  sub->add_option("-o,--output", verb->html, "report to write: one .html file, pictures included")->type_name("FILE");
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunCrosscheckVerb(*verb, globals); }; });
}

}  // namespace scumble
