#include "apps/cli/app/verbs.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <memory>
#include <string_view>

namespace scumble {
namespace {

// Prints the help of the command of that name, or of the whole program.
Expected<ExitCode> RunHelpVerb(const CLI::App& app, const std::string& name) {
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (verb->get_name() == name) return Print(verb->help(app.get_name())), ExitCode::kOk;
  }
  if (!name.empty()) return UsageError("there is no command '" + name + "'; scumble help lists them");
  return Print(app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal)), ExitCode::kOk;
}

}  // namespace

void AddVerbs(CLI::App& app, Globals& globals, Action& chosen) {
  AddSphereVerb(app, globals, chosen);
  AddGuidegenVerb(app, globals, chosen);
  AddTransferVerb(app, globals, chosen);
  AddStylizeVerb(app, globals, chosen);
  AddCompareVerb(app, globals, chosen);
  AddCrosscheckVerb(app, globals, chosen);
  AddTradeoffVerb(app, globals, chosen);
  AddInfoVerb(app, globals, chosen);
  AddStylesVerb(app, globals, chosen);
  AddFinishVerb(app, globals, chosen);
  AddStudioVerb(app, globals, chosen);
  auto topic = std::make_shared<std::string>();
  CLI::App* help = app.add_subcommand("help", "this text, or a command's: scumble help stylize");
  help->add_option("command", *topic, "the command to explain")->type_name("COMMAND");
  help->callback([&app, &chosen, topic] { chosen = [&app, topic] { return RunHelpVerb(app, *topic); }; });
  for (CLI::App* verb : app.get_subcommands([](CLI::App*) { return true; })) verb->group("Commands");
}

std::vector<std::string> ArgumentsLastFirst(std::vector<std::string> arguments) {
  constexpr std::string_view kIdiffOptions[] = {"-fail",        "-failrelative", "-failpercent",
                                                "-hardfail",    "-warn",         "-warnrelative",
                                                "-warnpercent", "-hardwarn",     "-allowfailures"};
  for (std::string& argument : arguments) {
    if (std::find(std::begin(kIdiffOptions), std::end(kIdiffOptions), argument) != std::end(kIdiffOptions)) {
      argument.insert(0, "-");
    }
  }
  std::reverse(arguments.begin(), arguments.end());
  return arguments;
}

}  // namespace scumble
