// scumble transfer, scumble stylize.
#include <memory>
#include <utility>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/progress_bar.h"
#include "cli/transfer_run.h"
#include "io/atomic_file.h"
#include "io/guide_file.h"
#include "io/picture_file.h"

namespace scumble {
namespace {

struct TransferVerb {
  std::string guides;
  std::string view_layer;
  std::string camera;
  StyleOptions style;
  PictureOptions picture;
};

Expected<ExitCode> RunTransferVerb(const TransferVerb& verb, const Globals& globals) {
  if (IsBlenderScene(verb.guides)) {
    return InputError(verb.guides + " is a scene: transfer takes guides; use `scumble stylize`, or `scumble guidegen` first");
  }
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(verb.picture.output, {verb.picture.bits}));
  SCUMBLE_RETURN_IF_ERROR(CheckWritable(verb.picture.output));
  SCUMBLE_ASSIGN(const Style style, OpenStyle(verb.style));
  Stopwatch watch;
  GuideReadOptions read;
  read.required = RequiredLayers(style.transfer);
  read.view_layer = verb.view_layer;
  read.blender_camera = verb.camera;
  if (style.transfer.edge_aware) read.mend = "; --set transfer.edge_aware=false does without depth and object";
  SCUMBLE_ASSIGN(const GuideSet guides, ReadGuides(verb.guides, read));
  ProgressBar bar("transfer", globals.quiet);
  const GuideSource source{verb.guides, {{"read", watch.Lap()}}, {}};
  return RunTransfer(style, guides, source, verb.picture, globals, bar.Part(0.0, 1.0));
}

struct StylizeVerb {
  SceneOptions scene;
  StyleOptions style;
  PictureOptions picture;
};

Expected<ExitCode> RunStylizeVerb(const StylizeVerb& verb, const Globals& globals) {
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(verb.picture.output, {verb.picture.bits}));
  SCUMBLE_RETURN_IF_ERROR(CheckWritable(verb.picture.output));
  Stopwatch watch;
  SCUMBLE_ASSIGN(const Style style, OpenStyle(verb.style));
  const double style_ms = watch.Lap();
  ProgressBar bar("stylize", globals.quiet);
  SceneOptions scene = verb.scene;
  scene.blender.frame = verb.picture.frame;
  scene.seed = verb.picture.seed;
  SCUMBLE_ASSIGN(SceneGuides made,
                 MakeGuides(scene, RequiredLayers(style.transfer), globals, bar.Part(0.0, 0.5), false));
  SCUMBLE_RETURN_IF_ERROR(made.guides.Validate(verb.scene.scene));
  made.times.insert(made.times.begin(), {"style", style_ms});
  NameStyleInPlan(made.plan, style);
  if (!verb.scene.explain) made.plan.clear();
  const GuideSource source{verb.scene.scene, std::move(made.times), std::move(made.plan)};
  return RunTransfer(style, made.guides, source, verb.picture, globals, bar.Part(0.5, 1.0));
}

}  // namespace

void AddTransferVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<TransferVerb>();
  CLI::App* sub = app.add_subcommand("transfer", "guides + style -> picture, from a guide file of guidegen or a Blender render");
  sub->add_option("guides", verb->guides, "guide file: .exr")->type_name("FILE")->required();
  sub->add_option("--view-layer", verb->view_layer, "which view layer of a multilayer file")->type_name("NAME");
  sub->add_option("--camera", verb->camera, "the .camera file of a Blender render; left out: found from its Position pass")
      ->type_name("FILE");
  AddStyleOptions(*sub, verb->style, true);
  AddPictureOptions(*sub, verb->picture);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunTransferVerb(*verb, globals); }; });
}

void AddStylizeVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<StylizeVerb>();
  CLI::App* sub = app.add_subcommand("stylize", "scene + style -> picture: guidegen and transfer in one go");
  AddSceneOptions(*sub, verb->scene);
  AddStyleOptions(*sub, verb->style, true);
  AddPictureOptions(*sub, verb->picture);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunStylizeVerb(*verb, globals); }; });
}

}  // namespace scumble
