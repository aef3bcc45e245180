#include "apps/cli/app/command.h"

#include <cstdio>

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

}  // namespace scumble
