// All verbs, and the arguments as their parser takes them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/cli/app/command.h"

namespace scumble {

// Adds every verb to the parser, `help` included. `app`, `globals` and `chosen` must outlive what is parsed.
void AddVerbs(CLI::App& app, Globals& globals, Action& chosen);

// The arguments behind the program's name, in the order in which CLI11 takes them. idiff writes its long options with
// one dash, and people paste them: they get their second one.
std::vector<std::string> ArgumentsLastFirst(std::vector<std::string> arguments);

}  // namespace scumble
