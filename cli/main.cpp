// scumble: paint a sphere, stylise a scene. One binary, one verb a task; `scumble help` prints verbs and exit codes.
#include <fcntl.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <iterator>
#include <memory>
#include <sstream>
#include <string_view>
#include <vector>

#include "cli/command.h"
#include "cli/ending_signals.h"
#include "cli/help_format.h"
#include "cli/last_words.h"
#include "image/check.h"
#include "io/library.h"

namespace scumble {

ExitCode ExitCodeFor(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return ExitCode::kUsage;
    case ErrorKind::kInput:
      return ExitCode::kInput;
    case ErrorKind::kOutput:
      return ExitCode::kOutput;
    case ErrorKind::kUnavailable:
      return ExitCode::kNotBuiltIn;
    case ErrorKind::kCancelled:
    case ErrorKind::kMemory:
      return ExitCode::kInternal;
  }
  return ExitCode::kInternal;
}

void Say(const Globals& globals, const std::string& line) {
  if (!globals.quiet) std::fprintf(stderr, "%s\n", line.c_str());
}
void Warn(const std::string& line) { std::fprintf(stderr, "scumble: warning: %s\n", line.c_str()); }
void Print(const std::string& text) { std::fputs(text.c_str(), stdout); }

namespace {

int Code(ExitCode code) { return static_cast<int>(code); }

constexpr const char* kExitCodes =
    "Exit codes: 0 ok · 1 compared and differs · 2 usage · 3 unreadable or invalid input · 4 cannot write ·\n"
    "            5 not built in · 6 internal error\n";

// idiff writes its long options with one dash; people paste them.
std::vector<std::string> ReadArguments(int argc, char** argv) {
  constexpr std::string_view kIdiffOptions[] = {"-fail",        "-failrelative", "-failpercent",
                                                "-hardfail",    "-warn",         "-warnrelative",
                                                "-warnpercent", "-hardwarn",     "-allowfailures"};
  std::vector<std::string> arguments;
  for (int i = argc - 1; i >= 1; --i) {  // CLI11 takes them last first
    const bool idiff =
        std::find(std::begin(kIdiffOptions), std::end(kIdiffOptions), argv[i]) != std::end(kIdiffOptions);
    arguments.push_back(idiff ? std::string("-") + argv[i] : argv[i]);
  }
  return arguments;
}

int Fail(const Error& error) {
  std::fprintf(stderr, "scumble: error: %s\n", error.message.c_str());
  return Code(ExitCodeFor(error.kind));
}

// A file opened while standard output is closed would take its number, and receive what is printed. These stand-ins
// refuse every read and write, so a result that nobody gets stays an error.
void OccupyStandardStreams() {
  for (const int descriptor : {0, 1, 2}) {
    if (::fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    if (::open("/dev/null", descriptor == 0 ? O_WRONLY : O_RDONLY) < 0) return;
  }
}

// Prints the help of the verb of that name, or of the whole program.
Expected<ExitCode> RunHelpVerb(const CLI::App& app, const std::string& name) {
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (verb->get_name() == name) return Print(verb->help(app.get_name())), ExitCode::kOk;
  }
  if (!name.empty()) return UsageError("there is no verb '" + name + "'; scumble help lists them");
  return Print(app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal)), ExitCode::kOk;
}

void AddVerbs(CLI::App& app, Globals& globals, Action& chosen) {
  AddSphereVerb(app, globals, chosen);
  AddGuidegenVerb(app, globals, chosen);
  AddTransferVerb(app, globals, chosen);
  AddStylizeVerb(app, globals, chosen);
  AddCompareVerb(app, globals, chosen);
  AddCrosscheckVerb(app, globals, chosen);
  AddInfoVerb(app, globals, chosen);
  AddStylesVerb(app, globals, chosen);
  auto topic = std::make_shared<std::string>();
  CLI::App* help = app.add_subcommand("help", "this text, or a verb's: scumble help stylize");
  help->add_option("verb", *topic, "the verb to explain")->type_name("VERB");
  help->callback([&app, &chosen, topic] { chosen = [&app, topic] { return RunHelpVerb(app, *topic); }; });
  for (CLI::App* verb : app.get_subcommands([](CLI::App*) { return true; })) verb->group("Verbs");
}

int Run(int argc, char** argv) {
  CLI::App app("Scumble: paint a sphere, stylise a scene.", "scumble");
  app.formatter(std::make_shared<HelpFormat>());
  app.footer(kExitCodes);
  app.set_help_flag("-h,--help", "print this help");
  app.set_version_flag("--version", std::string("scumble ") + SCUMBLE_VERSION, "print the version");
  app.require_subcommand(1);
  Globals globals;
  Action chosen;
  AddVerbs(app, globals, chosen);
  try {
    app.parse(ReadArguments(argc, argv));
  } catch (const CLI::Success& asked) {  // --help, --version
    std::ostringstream text;
    app.exit(asked, text, text);
    chosen = [asked = text.str()]() -> Expected<ExitCode> { return Print(asked), ExitCode::kOk; };
  } catch (const CLI::ParseError& error) {
    return Fail(UsageError(ExplainUsage(app, error)));
  }
  // More threads than cores, where they are asked for: the library would refuse them, and say so itself.
  const tbb::global_control workers(tbb::global_control::max_allowed_parallelism,
                                    std::size_t(std::max(globals.threads, tbb::this_task_arena::max_concurrency())));
  SetIoThreads(globals.threads);
  const Expected<ExitCode> result = chosen();
  if (!result) return Fail(result.error());
  if (std::fflush(stdout) != 0 || std::ferror(stdout)) return Fail(OutputError("cannot write to standard output"));
  return Code(*result);
}

}  // namespace
}  // namespace scumble

int main(int argc, char** argv) {
  try {
    scumble::OccupyStandardStreams();
    scumble::CleanUpOnSignals();
    scumble::TellOfWhatNobodyCatches();
    return scumble::Run(argc, argv);
  } catch (...) {
    return scumble::TellOf(std::current_exception());
  }
}
