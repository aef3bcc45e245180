// scumble styles check: reads styles as a transfer would and tells the usual mistakes.
#pragma once

#include <string>
#include <vector>

#include "apps/cli/app/command.h"

namespace scumble {

struct StylesCheck {
  std::vector<std::string> styles;  // as --style takes them
  bool strict = false;              // mistakes are exit code 1
};

// Prints a report for each style, and for several a summary; warns of mistakes. A style that cannot be read does not
// hide the others: it is told as an error, and the last one decides the exit code.
Expected<ExitCode> CheckStyles(const StylesCheck& check, const Globals& globals);

}  // namespace scumble
