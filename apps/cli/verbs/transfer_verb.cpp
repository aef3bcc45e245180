// scumble transfer.
#include <CLI/CLI.hpp>
#include <memory>
#include <utility>

#include "apps/cli/app/command.h"
#include "apps/cli/app/frame_report.h"
#include "apps/cli/app/options.h"
#include "apps/cli/app/picture_options.h"
#include "pipeline/run_requests.h"
#include "pipeline/scene_guides.h"

namespace scumble {
namespace {

struct TransferVerb {
  std::string guides, view_layer, light_layer, camera;
  StyleOptions style;
  PictureOptions picture;
  BudgetOptions budget;
  SequenceOptions sequence;
};

Expected<TransferRequest> ToRequest(const CLI::App& sub, const TransferVerb& verb, const Globals& globals) {
  if (IsScene(verb.guides)) {
    return InputError(verb.guides +
                      " is a scene: transfer takes guides; use `scumble stylize`, or `scumble guidegen` first");
  }
  TransferRequest request{verb.guides, verb.view_layer, verb.light_layer, verb.camera, {}, {}, {}, {}};
  SCUMBLE_ASSIGN(request.style, ToRequest(verb.style));
  SCUMBLE_ASSIGN(request.picture, ToRequest(verb.picture, globals));
  request.picture.over_view_layer = verb.view_layer;
  SCUMBLE_ASSIGN(request.budget, ToRequest(sub, verb.budget));
  SCUMBLE_ASSIGN(request.sequence, ToRequest(verb.sequence));
  return request;
}

Expected<ExitCode> RunTransferVerb(const CLI::App& sub, const TransferVerb& verb, const Globals& globals) {
  SCUMBLE_ASSIGN(TransferRequest request, ToRequest(sub, verb, globals));
  SequencePrinter printer(globals);
  SCUMBLE_ASSIGN(const RunReport report, RunTransfer(std::move(request), printer.Listener(), globals));
  return PrintRun(report, globals, printer);
}

}  // namespace

void AddTransferVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<TransferVerb>();
  CLI::App* sub =
      app.add_subcommand("transfer", "guides + style -> picture, from a guide file of guidegen or a Blender render");
  sub->add_option("guides", verb->guides, "guide file: .exr")->type_name("FILE")->required();
  sub->add_option("--view-layer", verb->view_layer, "which view layer of a multilayer file, and of --over")
      ->type_name("NAME");
  sub->add_option("--light-layer", verb->light_layer,
                  "the view layer of a Blender render whose passes Diffuse Direct and Shadow give the light, as one "
                  "with a white material override; left out: that of all else")
      ->type_name("NAME")
      ->check(RefuseEmpty);
  sub->add_option("--camera", verb->camera,
                  "the .camera file of a Blender render; left out: found from its Position pass")
      ->type_name("FILE");
  AddStyleOptions(*sub, verb->style, true);
  AddPictureOptions(*sub, verb->picture, true);
  AddBudgetOptions(*sub, verb->budget, false);
  AddSequenceOptions(*sub, verb->sequence);
  AddTimingOption(*sub, globals);
  AddMemoryOption(*sub, globals);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, sub, &globals, &chosen] {
    chosen = [verb, sub, &globals] { return RunTransferVerb(*sub, *verb, globals); };
  });
}

}  // namespace scumble
