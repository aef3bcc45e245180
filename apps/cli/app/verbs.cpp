#include "apps/cli/app/verbs.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <memory>
#include <string_view>
#include <vector>

namespace scumble {
namespace {

// Prints the help of the command that is named, as {"styles", "tune"}, or of the whole program.
Expected<ExitCode> RunHelpVerb(const CLI::App& app, const std::vector<std::string>& names) {
  const CLI::App* command = &app;
  std::string before, path;
  for (const std::string& name : names) {
    before += (before.empty() ? "" : " ") + command->get_name();
    path += (path.empty() ? "" : " ") + name;
    const auto verbs = command->get_subcommands([&](const CLI::App* verb) { return verb->get_name() == name; });
    if (verbs.empty()) return UsageError("there is no command '" + path + "'; scumble help lists them");
    command = verbs.front();
  }
  if (command != &app) return Print(command->help(before)), ExitCode::kOk;
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
  auto topic = std::make_shared<std::vector<std::string>>();
  CLI::App* help = app.add_subcommand("help", "this text, or a command's: scumble help stylize");
  help->add_option("command", *topic, "the command to explain, as: styles tune")->type_name("COMMAND");
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
