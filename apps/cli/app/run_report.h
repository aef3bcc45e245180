// Parts of reports as text and as JSON: work, plan, memory, time.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "guidegen/guidegen.h"
#include "pipeline/memory_limit.h"
#include "pipeline/scene_guides.h"
#include "pipeline/stage_clock.h"

namespace scumble {

// Adds "rays" and "work": rays by kind, evaluations of materials, textures and lights, decoded and allocated data, and
// whether OpenImageIO was loaded so far. docs/required.md explains each counter.
void CostToJson(const SceneCost& cost, nlohmann::ordered_json& json);
// CostToJson's numbers in one line.
std::string CostToText(const SceneCost& cost);

// A table: layer, why, cost.
std::string PlanToText(const std::vector<PlanItem>& plan);
nlohmann::ordered_json PlanToJson(const std::vector<PlanItem>& plan);

// "memory  up to 1.2 GiB: guides 0.4 GiB, …", a line for --explain.
std::string MemoryToText(const MemoryNeed& need);
// {"estimated_peak_bytes": …, "parts": {"guides": …}}
nlohmann::ordered_json MemoryToJson(const MemoryNeed& need);

// A table: stage, wall and processor time.
std::string ClockToText(const StageClock& clock);
nlohmann::ordered_json ClockToJson(const StageClock& clock);  // [{"stage": "start", "wall_ms": 4.2, "cpu_ms": 4.1}, …]

}  // namespace scumble
