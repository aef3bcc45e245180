// scumble transfer, scumble stylize.
#include <memory>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/progress_bar.h"
#include "cli/transfer_run.h"
#include "io/guide_file.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

struct TransferVerb {
  std::string guides;
  std::string view_layer;
  StyleOptions style;
  PictureOptions picture;
};

Expected<ExitCode> RunTransferVerb(const TransferVerb& verb, const Globals& globals) {
  SCUMBLE_ASSIGN(const Style style, OpenStyle(verb.style));
  Stopwatch watch;
  GuideReadOptions read;
  read.required = RequiredLayers(style.transfer);
  read.view_layer = verb.view_layer;
  SCUMBLE_ASSIGN(const GuideSet guides, ReadGuides(verb.guides, read));
  ProgressBar bar("transfer", globals.quiet);
  return RunTransfer(style, guides, verb.picture, globals, bar.Part(0.0, 1.0), {{"read", watch.Lap()}});
}

struct StylizeVerb {
  SceneOptions scene;
  StyleOptions style;
  PictureOptions picture;
};

Expected<ExitCode> RunStylizeVerb(const StylizeVerb& verb, const Globals& globals) {
  Stopwatch watch;
  SCUMBLE_ASSIGN(const Style style, OpenStyle(verb.style));
  const double style_ms = watch.Lap();
  ProgressBar bar("stylize", globals.quiet);
  SCUMBLE_ASSIGN(SceneGuides made,
                 MakeGuides(verb.scene, RequiredLayers(style.transfer), globals, bar.Part(0.0, 0.5), false));
  if (verb.scene.explain) Say(globals, PlanToText(made.plan));
  SCUMBLE_RETURN_IF_ERROR(made.guides.Validate(verb.scene.scene));
  made.times.insert(made.times.begin(), {"style", style_ms});
  return RunTransfer(style, made.guides, verb.picture, globals, bar.Part(0.5, 1.0), made.times);
}

}  // namespace

void AddTransferVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<TransferVerb>();
  CLI::App* sub = app.add_subcommand("transfer", "guides + style -> picture");
  sub->add_option("guides", verb->guides, "guide file: .exr")->required();
  sub->add_option("--view-layer", verb->view_layer, "which view layer of a multilayer file");
  AddStyleOptions(*sub, verb->style, true);
  AddPictureOptions(*sub, verb->picture);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunTransferVerb(*verb, globals); }; });
}

void AddStylizeVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<StylizeVerb>();
  CLI::App* sub = app.add_subcommand("stylize", "scene + style -> picture");
  AddSceneOptions(*sub, verb->scene);
  AddStyleOptions(*sub, verb->style, true);
  AddPictureOptions(*sub, verb->picture);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunStylizeVerb(*verb, globals); }; });
}

}  // namespace scumble
