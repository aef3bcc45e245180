// Shared by all commands: exit codes, global options, printing of results and messages.
#pragma once

#include <functional>
#include <string>

#include "core/image/status.h"
#include "pipeline/run_context.h"

namespace CLI {
class App;
}

namespace scumble {

// Printed by `scumble help`.
enum class ExitCode {
  kOk = 0,
  kDiffers = 1,
  kUsage = 2,
  kInput = 3,
  kOutput = 4,
  kNotBuiltIn = 5,
  kInternal = 6,
};

// Options that every command takes, and the context that they make for the pipeline.
struct Globals : RunContext {
  bool quiet = false;
  bool json = false;
};

// Fills in where this program keeps and finds its files, the environment and what signals do, and prints messages and
// progress to stderr. `globals` must outlive what it is passed to.
void ConnectToTerminal(Globals& globals);

// A command's work: returns the exit code, or the error that decides it.
using Action = std::function<Expected<ExitCode>()>;

// Each command adds itself to the parser; when it is chosen, `chosen` becomes its work.
void AddSphereVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddFinishVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddGuidegenVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddTransferVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddStylizeVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddCrosscheckVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddCompareVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddInfoVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddStylesVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddTradeoffVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddStudioVerb(CLI::App& app, Globals& globals, Action& chosen);

ExitCode ExitCodeFor(ErrorKind kind);

// The text with its control characters escaped, as \n: names in files may hold any.
std::string OneLine(const std::string& text);

// Prints results to stdout; a closed or full stdout is checked once, at the end of the program.
void Print(const std::string& text);

}  // namespace scumble
