// The request of `scumble compare`, and its two measures beside differences of values.
#pragma once

#include <optional>
#include <string>

#include "apps/cli/app/command.h"
#include "measure/compare.h"
#include "measure/flip.h"

namespace scumble {

struct CompareVerb {
  std::string a;
  std::string b;
  std::string view_layer;  // of files that have several; empty: channels are compared by name where they can be
  std::string camera;      // of a Blender render that is read as guides; empty: found from its Position pass
  CompareOptions options;
  std::string heat_map;
  std::string motion;
  std::string motion_next;
  bool flip = false;
  FlipOptions flip_options;
  std::optional<double> flip_fail;  // largest mean FLIP that is no failure; empty: no limit
};

// Prints the flicker along the motion, and writes the requested heat map. Always kOk: it only measures.
Expected<ExitCode> CompareByFlicker(const CompareVerb& verb, const Globals& globals);

// Prints FLIP, and writes the requested heat map: of the two pictures, or of the one layer of light in
// `options.layers`, in linear values that are clamped to 0 … 1. With `flip_fail`, kDiffers where the mean is above it
// or a value of either file is no number.
Expected<ExitCode> CompareByFlip(const CompareVerb& verb, const Globals& globals);

}  // namespace scumble
