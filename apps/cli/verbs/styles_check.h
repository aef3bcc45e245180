// scumble styles check: reads styles as a transfer would and reports the usual mistakes.
#pragma once

#include <string>
#include <vector>

#include "apps/cli/app/command.h"

namespace scumble {

struct StylesCheck {
  std::vector<std::string> styles;  // as --style takes them
  bool strict = false;              // mistakes are exit code 1
};

// Prints a report for each style, and for several a summary; warns of mistakes. An unreadable style does not stop the
// others: it is reported as an error, and the last one decides the exit code.
Expected<ExitCode> CheckStyles(const StylesCheck& check, const Globals& globals);

}  // namespace scumble
