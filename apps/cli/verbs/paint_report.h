// What `scumble styles check` says of one painting, in words and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "measure/painting/paint_faults.h"
#include "measure/painting/paint_traits.h"

namespace scumble {

// All figures. Lengths and places are pixels of the file, `margin` being what was cut off it; shares are percent.
nlohmann::ordered_json TraitsToJson(const PaintTraits& traits, int margin);

// The figures that a painter looks for, one indented line each.
std::string TraitsToText(const PaintTraits& traits);

nlohmann::ordered_json FaultToJson(const std::string& image, const PaintFault& fault);

// "lit.png: what is wrong; how to mend it"
std::string FaultToText(const std::string& image, const PaintFault& fault);

}  // namespace scumble
