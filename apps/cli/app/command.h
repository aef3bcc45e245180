// What all verbs share: exit codes, global options, how results and talk are printed.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/image/status.h"

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

class Timing;

// Options that every verb takes.
struct Globals {
  bool quiet = false;
  bool json = false;
  int threads = 0;
  std::uint64_t max_memory = 0;    // bytes, of --max-memory; 0: what the machine has
  std::shared_ptr<Timing> timing;  // null unless --timing was given, which not every verb takes
};

// A verb's work: returns the exit code, or the error that decides it.
using Action = std::function<Expected<ExitCode>()>;

// Each verb adds itself to the parser; when it is chosen, `chosen` becomes its work.
void AddSphereVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddGuidegenVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddTransferVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddStylizeVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddCrosscheckVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddCompareVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddInfoVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddStylesVerb(CLI::App& app, Globals& globals, Action& chosen);
void AddTradeoffVerb(CLI::App& app, Globals& globals, Action& chosen);

ExitCode ExitCodeFor(ErrorKind kind);

// Talk, to stderr: silent under --quiet.
void Say(const Globals& globals, const std::string& line);
// Warnings, to stderr, always.
void Warn(const std::string& line);
// Results, to stdout; the error of a closed or full stdout is looked at once, when the program ends.
void Print(const std::string& text);

}  // namespace scumble
