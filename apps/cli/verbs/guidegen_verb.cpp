// scumble guidegen.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/cli/app/command.h"
#include "apps/cli/app/frame_report.h"
#include "apps/cli/app/options.h"
#include "apps/cli/app/picture_options.h"
#include "core/io/guide_file.h"
#include "pipeline/run_requests.h"

namespace scumble {
namespace {

struct GuidegenVerb {
  SceneOptions scene;
  StyleOptions style;
  std::string layers;
  std::string compression = "zip";
  bool fast_io = false;
  bool cryptomatte = false;
  std::string output;
  SequenceOptions sequence;
};

Expected<GuidegenRequest> ToRequest(const GuidegenVerb& verb) {
  GuidegenRequest request;
  SCUMBLE_ASSIGN(request.layers, ParseLayers(verb.layers));
  if (verb.output.empty() && !verb.scene.explain) {
    return UsageError("scumble guidegen: -o FILE is required; with --explain and no -o the plan is printed alone");
  }
  if (verb.style.request.style.empty() && !verb.style.sets.empty())
    return UsageError("--set changes a style: give --style too");
  if (verb.style.request.style.empty() && !verb.style.request.assigned.empty()) {
    return UsageError("--assign goes with a style for all the rest: give --style too");
  }
  if (verb.style.request.style.empty() && !verb.style.request.finishes.empty()) {
    return UsageError("--finish comes after a style: give --style too, or ask for --layers");
  }
  SCUMBLE_ASSIGN(request.scene, ToRequest(verb.scene));
  SCUMBLE_ASSIGN(request.sequence, ToRequest(verb.sequence));
  if (!verb.style.request.style.empty()) {
    SCUMBLE_ASSIGN(request.style, ToRequest(verb.style));
  }
  request.write = {request.scene.half, verb.fast_io ? kFastCompression : verb.compression, verb.cryptomatte};
  request.output = verb.output;
  request.explain = verb.scene.explain;
  return request;
}

Expected<ExitCode> RunGuidegenVerb(const GuidegenVerb& verb, const Globals& globals) {
  SCUMBLE_ASSIGN(GuidegenRequest request, ToRequest(verb));
  SequencePrinter printer(globals);
  SCUMBLE_ASSIGN(const RunReport report, RunGuidegen(std::move(request), printer.Listener(), globals));
  return PrintRun(report, globals, printer);
}

}  // namespace

void AddGuidegenVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<GuidegenVerb>();
  CLI::App* sub =
      app.add_subcommand("guidegen", "scene -> guides: what a renderer tells the transfer about every pixel");
  AddSceneOptions(*sub, verb->scene);
  AddStyleOptions(*sub, verb->style, false);
  sub->add_option("--frame", verb->scene.request.blender.frame,
                  "frame of a scene that moves; left out: of a .blend the one it was saved at, of glTF the nodes as "
                  "they stand")
      ->type_name("N");
  AddFpsOption(*sub, verb->scene.fps,
               "frames a second of a glTF animation, as 24 or 24000/1001: frame N is at N / RATE s; left out: 24. Of a "
               ".blend what its guides say to transfer; left out: its own");
  AddLightPathOptions(*sub, verb->scene);
  sub->add_option(
         "--layers", verb->layers,
         "layers on top of A, normal, depth, object and material, with commas between: position, pref, albedo, "
         "luminance, shadow, lpe.full, lpe.LDE, lpe.LSE, lpe.LDDE, lpe.LD12E, cosine, uv, outline; with --frame or "
         "--frames motion, to the next frame")
      ->type_name("LIST");
  auto* compression =
      sub->add_option("--compression", verb->compression, "none, rle, zips, zip or piz; all are lossless");
  compression->type_name("NAME")->capture_default_str();
  AddFastIoOption(*sub, verb->fast_io)->excludes(compression);
  sub->add_flag("--cryptomatte", verb->cryptomatte,
                "for compositors: write objects and materials as Cryptomatte too, with their names, and their ids as "
                "the passes object_id and material_id; transfer reads the ids in any case");
  sub->add_option("-o,--output", verb->output, "guide file to write, .exr; required unless --explain is given")
      ->type_name("FILE");
  AddSequenceOptions(*sub, verb->sequence);
  AddTimingOption(*sub, globals);
  AddMemoryOption(*sub, globals);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunGuidegenVerb(*verb, globals); }; });
}

}  // namespace scumble
