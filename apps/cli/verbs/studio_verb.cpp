// scumble studio: a local page that shows a scene in the paint of a style while both are worked on.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/cli/app/command.h"
#include "apps/cli/app/json_text.h"
#include "apps/cli/app/options.h"
#include "apps/cli/app/signal_cleanup.h"
#include "apps/studio/studio.h"

namespace scumble {
namespace {

struct StudioVerb {
  StudioOptions studio;
  SceneOptions scene;  // becomes studio.scene
};

Expected<ExitCode> RunStudioVerb(const StudioVerb& verb, const Globals& globals) {
  StudioOptions options = verb.studio;
  SCUMBLE_ASSIGN(options.scene, ToRequest(verb.scene));
  options.seed = options.scene.seed;
  options.on_ready = [&globals](const std::string& address) {
    Print(globals.json ? JsonText(nlohmann::json{{"address", address}}) : address + "\n");
    std::fflush(stdout);  // who started this waits for it
  };
  StopOnSignals();
  // While Blender is at work, its guard has the signal first.
  options.is_stopped = [cancelled = globals.is_cancelled] { return cancelled() || StopIsRequested(); };
  RunContext context = globals;
  context.is_cancelled = options.is_stopped;
  const Status run = RunStudio(options, context);
  if (!run && run.error().kind != ErrorKind::kCancelled) return run.error();
  return ExitCode::kOk;
}

}  // namespace

void AddStudioVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<StudioVerb>();
  CLI::App* sub = app.add_subcommand("studio", "a page in the browser: paint, save, and see it on the scene");
  sub->footer(
      "Prints the page's address, serves it to this machine alone, and opens it in the browser. Ctrl-C ends it. To\n"
      "use it from another machine, let ssh pass the port on: ssh -L 8080:127.0.0.1:8080 HOST, with --port 8080.\n");
  AddViewOptions(*sub, verb->scene);
  CLI::Option* const scene = sub->get_option("scene_file");
  scene->required(false)->description(scene->get_description() + "; left out: the bundled scenes to choose from");
  AddAnimationOption(*sub, verb->scene);
  sub->add_option(
         "--frame", verb->scene.request.blender.frame,
         "frame to begin with, of a scene that moves; left out: of a .blend the one it was saved at, otherwise "
         "the animation's first")
      ->type_name("N");
  AddFpsOption(*sub, verb->scene.fps,
               "frames a second of a glTF animation, as 24 or 24000/1001; left out: of a .blend its own, otherwise 24");
  AddCastOptions(*sub, verb->scene);
  AddSampleOptions(*sub, verb->scene);
  sub->add_option("--style", verb->studio.styles,
                  "style folder, style.toml, picture of a painted sphere, or a bundled style's name; repeatable: the "
                  "first is shown, all are there to choose from; left out: the bundled ones")
      ->type_name("STYLE")
      ->allow_extra_args(false)
      ->check(RefuseEmpty);
  sub->add_option("--seed", verb->scene.request.seed,
                  "another seed, another pattern and other noise; the same seed, the same bytes")
      ->type_name("N")
      ->check(RefuseNegative)
      ->capture_default_str();
  sub->add_option("--port", verb->studio.port, "port of 127.0.0.1 to serve on; left out: a free one")
      ->type_name("N")
      ->check(CLI::Range(1024, 65535));
  sub->add_flag("!--no-browser", verb->studio.open_browser, "only print the address");
  sub->add_option("--save-to", verb->studio.save_to,
                  "folder in which Save as makes the folders of new styles; left out: the current one")
      ->type_name("FOLDER")
      ->check(RefuseEmpty);
  sub->add_option("--web", verb->studio.web, "read the page's files from this folder, to work on the page")
      ->type_name("FOLDER")
      ->check(RefuseEmpty);
  AddMemoryOption(*sub, globals);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunStudioVerb(*verb, globals); }; });
}

}  // namespace scumble
