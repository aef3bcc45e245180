// scumble styles tune: proposes keys for a style by which its paint looks more like the exemplar's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/cli/app/command.h"
#include "apps/cli/app/options.h"
#include "pipeline/requests.h"

namespace scumble {

struct StylesTune {
  StyleOptions style;
  std::vector<std::string> scenes;  // empty: the sample scenes
  std::string size = "640x360";
  std::uint64_t seed = 0;
  std::string folder;  // for the contact sheet; empty: none
  int write = 0;       // the proposal that goes into style.toml, from 1; 0: none
};

Expected<ExitCode> RunStylesTune(const StylesTune& tune, const Globals& globals);

}  // namespace scumble
