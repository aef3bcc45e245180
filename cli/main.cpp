// scumble: paint a sphere, stylise a scene. One binary, one verb a task; `scumble help` prints verbs and exit codes.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iterator>
#include <new>
#include <string_view>
#include <vector>

#include "cli/command.h"
#include "image/check.h"
#include "io/library.h"

namespace scumble {

ExitCode ExitCodeFor(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage: return ExitCode::kUsage;
    case ErrorKind::kInput: return ExitCode::kInput;
    case ErrorKind::kOutput: return ExitCode::kOutput;
    case ErrorKind::kUnavailable: return ExitCode::kNotBuiltIn;
    case ErrorKind::kCancelled: return ExitCode::kInternal;
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
  constexpr std::string_view kIdiffOptions[] = {"-fail",     "-failrelative", "-failpercent", "-hardfail", "-warn",
                                                "-warnrelative", "-warnpercent", "-hardwarn", "-allowfailures"};
  std::vector<std::string> arguments;
  for (int i = argc - 1; i >= 1; --i) {  // CLI11 takes them last first
    const bool idiff = std::find(std::begin(kIdiffOptions), std::end(kIdiffOptions), argv[i]) != std::end(kIdiffOptions);
    arguments.push_back(idiff ? std::string("-") + argv[i] : argv[i]);
  }
  return arguments;
}

int Fail(const Error& error) {
  std::fprintf(stderr, "scumble: error: %s\n", error.message.c_str());
  return Code(ExitCodeFor(error.kind));
}

int Run(int argc, char** argv) {
  CLI::App app("Scumble: paint a sphere, stylise a scene.", "scumble");
  app.footer(kExitCodes);
  app.set_version_flag("--version", std::string("scumble ") + SCUMBLE_VERSION);
  app.require_subcommand(1);
  Globals globals;
  Action chosen;
  AddSphereVerb(app, globals, chosen);
  AddGuidegenVerb(app, globals, chosen);
  AddTransferVerb(app, globals, chosen);
  AddStylizeVerb(app, globals, chosen);
  AddCompareVerb(app, globals, chosen);
  AddInfoVerb(app, globals, chosen);
  AddStylesVerb(app, globals, chosen);
  app.add_subcommand("help", "this text")->callback([&] {
    chosen = [&app]() -> Expected<ExitCode> {
      Print(app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal));
      return ExitCode::kOk;
    };
  });
  try {
    app.parse(ReadArguments(argc, argv));
  } catch (const CLI::Success& asked) {  // --help, --version
    app.exit(asked);
    return Code(ExitCode::kOk);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "scumble: error: %s\nscumble VERB --help lists its options.\n", error.what());
    return Code(ExitCode::kUsage);
  }
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
    return scumble::Run(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("scumble: error: out of memory; ask for a smaller picture\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "scumble: internal error: %s; please report it with the command that led here\n", error.what());
  }
  return static_cast<int>(scumble::ExitCode::kInternal);
}
