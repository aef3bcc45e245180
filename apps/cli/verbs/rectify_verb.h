// scumble sphere --rectify: from a scan of the painted template to the exemplar.
#pragma once

#include <string>

#include "apps/cli/app/command.h"

namespace scumble {

struct RectifyRequest {
  std::string scan;
  bool square = false;
  bool no_white_balance = false;
  int size = 0;  // from the command's own options
  std::string output;
};

void AddRectifyOptions(CLI::App& verb, RectifyRequest& request);

// `verb` has the given options: those of drawing a template are refused. Without --size the kit's guides beside the
// output set it.
Expected<ExitCode> RunRectify(const CLI::App& verb, const RectifyRequest& request, const Globals& globals);

}  // namespace scumble
