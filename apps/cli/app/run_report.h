// What a run took, counted, for its report.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "apps/cli/app/options.h"

namespace scumble {

// Adds "rays" and "work": how many of each kind were cast, how often materials, textures and lights were asked, what was
// decoded and allocated, and whether OpenImageIO had to be loaded so far. docs/required.md says what each of them counts.
void CostToJson(const SceneCost& cost, nlohmann::ordered_json& json);
// The same in one line.
std::string CostToText(const SceneCost& cost);

}  // namespace scumble
