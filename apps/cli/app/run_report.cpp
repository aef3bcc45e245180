#include "apps/cli/app/run_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/io/library.h"

namespace scumble {

void CostToJson(const SceneCost& cost, nlohmann::ordered_json& json) {
  const auto& [rays, work, textures_decoded, texture_bytes, textures_left_out, warned] = cost;
  json["rays"] = {
      {"primary", rays.primary}, {"coverage", rays.coverage}, {"shadow", rays.shadow}, {"bounce", rays.bounce}};
  json["work"]["light_samples"] = work.light_samples;
  json["work"]["materials"] = work.materials;
  json["work"]["texture_lookups"] = work.texture_lookups;
  json["work"]["texels"] = work.texels;
  json["work"]["filtered_hits"] = work.filtered_hits;
  json["work"]["textures_decoded"] = textures_decoded;
  json["work"]["texture_bytes"] = texture_bytes;
  json["work"]["plane_bytes"] = work.plane_bytes;
  json["work"]["openimageio"] = IsLibraryLoaded();
}

std::string CostToText(const SceneCost& cost) {
  const RayCounts& rays = cost.rays;
  const WorkCounts& work = cost.work;
  return fmt::format(
      "taken: {} primary rays, {} for coverage, {} for shadows, {} bounced; {} light samples, {} materials, {} texture "
      "lookups; {} textures decoded; {:.1f} MB of planes\n",
      rays.primary, rays.coverage, rays.shadow, rays.bounce, work.light_samples, work.materials, work.texture_lookups,
      cost.textures_decoded, double(work.plane_bytes) * 1e-6);
}

std::string PlanToText(const std::vector<PlanItem>& plan) {
  std::size_t widest_layer = 5, widest_reason = 3;
  for (const PlanItem& item : plan) {
    widest_layer = std::max(widest_layer, item.layer.size());
    widest_reason = std::max(widest_reason, item.reason.size());
  }
  std::string text = fmt::format("{:<{}}  {:<{}}  {}\n", "layer", widest_layer, "why", widest_reason, "cost");
  for (const PlanItem& item : plan) {
    text += fmt::format("{:<{}}  {:<{}}  {}\n", item.layer, widest_layer, item.reason, widest_reason, item.cost);
  }
  return text;
}

nlohmann::ordered_json PlanToJson(const std::vector<PlanItem>& plan) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const PlanItem& item : plan) {
    json.push_back({{"layer", item.layer}, {"reason", item.reason}, {"cost", item.cost}});
  }
  return json;
}

std::string MemoryToText(const MemoryNeed& need) {
  std::string text = "memory  up to " + BytesToText(need.peak());
  const char* separator = ": ";
  for (const MemoryNeed::Part& part : need.parts()) {
    text += fmt::format("{}{} {}", separator, part.name, BytesToText(part.bytes));
    separator = ", ";
  }
  return text + "\n";
}

nlohmann::ordered_json MemoryToJson(const MemoryNeed& need) {
  nlohmann::ordered_json json{{"estimated_peak_bytes", need.peak()}};
  for (const MemoryNeed::Part& part : need.parts()) json["parts"][part.name] = part.bytes;
  return json;
}

std::string ClockToText(const StageClock& clock) {
  std::string text = fmt::format("{:<12} {:>10} {:>10}\n", "stage", "wall ms", "cpu ms");
  for (const Stage& stage : clock.Stages()) {
    text += fmt::format("{:<12} {:>10.1f} {:>10}\n", stage.name, stage.wall_ms,
                        stage.cpu_ms ? fmt::format("{:.1f}", *stage.cpu_ms) : "");
  }
  return text;
}

nlohmann::ordered_json ClockToJson(const StageClock& clock) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Stage& stage : clock.Stages()) {
    nlohmann::ordered_json one{{"stage", stage.name}, {"wall_ms", stage.wall_ms}};
    if (stage.cpu_ms) one["cpu_ms"] = *stage.cpu_ms;
    json.push_back(std::move(one));
  }
  return json;
}

}  // namespace scumble
