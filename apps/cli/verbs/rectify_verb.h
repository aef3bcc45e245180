// scumble sphere --rectify: from a scan of the painted template to the exemplar.
#pragma once

#include <string>

#include "apps/cli/app/command.h"

namespace scumble {

struct RectifyRequest {
  std::string scan;
  bool square = false;
  bool no_white_balance = false;
  int size = 0;  // from the verb's own options
  std::string output;
};

void AddRectifyOptions(CLI::App& verb, RectifyRequest& request);

// `verb` tells which options were given: those that say how a template is drawn are refused. Where --size is not among
// them the kit's guides beside the output say it.
Expected<ExitCode> RunRectify(const CLI::App& verb, const RectifyRequest& request, const Globals& globals);

}  // namespace scumble
