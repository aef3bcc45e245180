// What `scumble compare` was asked for, and its two measures beside differences of values.
#pragma once

#include <optional>
#include <string>

#include "apps/cli/app/command.h"
#include "measure/compare/compare.h"
#include "measure/compare/flip.h"

namespace scumble {

struct CompareVerb {
  std::string a;
  std::string b;
  CompareOptions options;
  std::string heat_map;
  std::string motion;
  std::string motion_next;
  bool flip = false;
  FlipOptions flip_options;
  std::optional<double> flip_fail;  // largest mean FLIP that is no failure; nothing: none is one
};

// Prints the flicker along the motion, and writes the heat map if one is asked for. Always kOk: it only measures.
Expected<ExitCode> CompareByFlicker(const CompareVerb& verb, const Globals& globals);

// Prints FLIP, and writes the heat map if one is asked for: of the two pictures, or of the one layer of light that
// `options.layers` names, in linear values that are clamped to 0 … 1. kDiffers where the mean is above `flip_fail`.
Expected<ExitCode> CompareByFlip(const CompareVerb& verb, const Globals& globals);

}  // namespace scumble
