// All commands, and the arguments in the form that their parser takes.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/cli/app/command.h"

namespace scumble {

// Adds every command to the parser, `help` included. `app`, `globals` and `chosen` must outlive the parser.
void AddVerbs(CLI::App& app, Globals& globals, Action& chosen);

// The arguments after the program's name, in CLI11's order. idiff writes its long options with one dash, and people
// paste them: they get a second dash.
std::vector<std::string> ArgumentsLastFirst(std::vector<std::string> arguments);

}  // namespace scumble
