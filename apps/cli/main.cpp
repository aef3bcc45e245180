// scumble: paint a sphere, stylise a scene. One program, one command a task; `scumble help` prints commands and exit
// codes.
#include <fcntl.h>
#include <tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <sstream>

#include "apps/cli/app/command.h"
#include "apps/cli/app/fatal_error.h"
#include "apps/cli/app/help_format.h"
#include "apps/cli/app/signal_cleanup.h"
#include "apps/cli/app/verbs.h"
#include "core/filter/more_workers.h"
#include "core/image/check.h"
#include "core/io/library.h"

namespace scumble {

namespace {

int Code(ExitCode code) { return static_cast<int>(code); }

constexpr const char* kExitCodes =
    "Exit codes: 0 ok · 1 compared and differs · 2 usage · 3 unreadable or invalid input · 4 cannot write ·\n"
    "            5 not built in · 6 internal error\n";

int Fail(const Error& error) {
  std::fprintf(stderr, "scumble: error: %s\n", error.message.c_str());
  return Code(ExitCodeFor(error.kind));
}

// If standard output is closed, the next opened file would take its number and receive the printed text. These
// placeholders refuse every read and write, so a lost result stays an error.
void OccupyStandardStreams() {
  for (const int descriptor : {0, 1, 2}) {
    if (::fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    if (::open("/dev/null", descriptor == 0 ? O_WRONLY : O_RDONLY) < 0) return;
  }
}

int Run(int argc, char** argv) {
  CLI::App app("Scumble: paint a sphere, stylise a scene.", "scumble");
  app.formatter(std::make_shared<HelpFormat>());
  app.footer(kExitCodes);
  app.set_help_flag("-h,--help", "print this help");
  app.set_version_flag("--version", std::string("scumble ") + SCUMBLE_VERSION, "print the version");
  app.require_subcommand(1);
  Globals globals;
  ConnectToTerminal(globals);
  Action chosen;
  AddVerbs(app, globals, chosen);
  try {
    app.parse(ArgumentsLastFirst({argv + 1, argv + std::max(argc, 1)}));
  } catch (const CLI::Success& asked) {  // --help, --version
    std::ostringstream text;
    app.exit(asked, text, text);
    chosen = [asked = text.str()]() -> Expected<ExitCode> { return Print(asked), ExitCode::kOk; };
  } catch (const CLI::ParseError& error) {
    return Fail(UsageError(ExplainUsage(app, error)));
  }
  const MoreWorkers workers(globals.threads);
  // oneTBB 2022 hangs if it finds no memory for its first arena: that is made now, and kept, if there is enough for it.
  ::operator delete(::operator new(std::size_t(4) << 20));
  tbb::task_arena first_arena(1, 1);
  first_arena.initialize();
  SetIoThreads(globals.threads);
  const Expected<ExitCode> result = chosen();
  if (!result) return Fail({result.error().kind, OneLine(result.error().message)});
  if (std::fflush(stdout) != 0 || std::ferror(stdout)) return Fail(OutputError("cannot write to standard output"));
  return Code(*result);
}

}  // namespace
}  // namespace scumble

int main(int argc, char** argv) {
  try {
    scumble::OccupyStandardStreams();
    scumble::CleanUpOnSignals();
    scumble::ReportUncaughtExceptions();
    return scumble::Run(argc, argv);
  } catch (...) {
    scumble::ReportAndEnd();
  }
}
