// The report of `scumble styles check` on one exemplar, in words and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "measure/paint_faults.h"
#include "measure/paint_traits.h"

namespace scumble {

// All figures. Lengths and places are pixels of the file, which the exemplar may have been cut out of; shares are
// percent.
nlohmann::ordered_json TraitsToJson(const PaintTraits& traits, const Exemplar& exemplar);

// The figures for painters, one indented line each.
std::string TraitsToText(const PaintTraits& traits);

nlohmann::ordered_json FaultToJson(const std::string& image, const PaintFault& fault);

// "lit.png: the fault; the remedy"
std::string FaultToText(const std::string& image, const PaintFault& fault);

}  // namespace scumble
