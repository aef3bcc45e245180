// scumble stylize.
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

struct StylizeVerb {
  SceneOptions scene;
  StyleOptions style;
  PictureOptions picture;
  BudgetOptions budget;
  SequenceOptions sequence;
};

Expected<StylizeRequest> ToRequest(const CLI::App& sub, const StylizeVerb& verb, const Globals& globals) {
  StylizeRequest request;
  SCUMBLE_ASSIGN(request.scene, ToRequest(verb.scene));
  SCUMBLE_ASSIGN(request.style, ToRequest(verb.style));
  request.explain = verb.scene.explain;
  SCUMBLE_ASSIGN(request.picture, ToRequest(verb.picture, globals));
  SCUMBLE_ASSIGN(request.budget, ToRequest(sub, verb.budget));
  SCUMBLE_ASSIGN(request.sequence, ToRequest(verb.sequence));
  return request;
}

Expected<ExitCode> RunStylizeVerb(const CLI::App& sub, const StylizeVerb& verb, const Globals& globals) {
  SCUMBLE_ASSIGN(StylizeRequest request, ToRequest(sub, verb, globals));
  SequencePrinter printer(globals);
  SCUMBLE_ASSIGN(const RunReport report, RunStylize(std::move(request), printer.Listener(), globals));
  return PrintRun(report, globals, printer);
}

}  // namespace

void AddStylizeVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<StylizeVerb>();
  CLI::App* sub = app.add_subcommand("stylize", "scene + style -> picture: guidegen and transfer in one go");
  AddSceneOptions(*sub, verb->scene);
  AddSampleOptions(*sub, verb->scene);
  AddStyleOptions(*sub, verb->style, true);
  AddPictureOptions(*sub, verb->picture, false);
  AddBudgetOptions(*sub, verb->budget, true);
  AddSequenceOptions(*sub, verb->sequence);
  AddTimingOption(*sub, globals);
  AddMemoryOption(*sub, globals);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, sub, &globals, &chosen] {
    chosen = [verb, sub, &globals] { return RunStylizeVerb(*sub, *verb, globals); };
  });
}

}  // namespace scumble
