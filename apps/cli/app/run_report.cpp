#include "apps/cli/app/run_report.h"

#include <fmt/format.h>

#include "core/io/library.h"

namespace scumble {

void CostToJson(const SceneCost& cost, nlohmann::ordered_json& json) {
  const auto& [rays, work, textures_decoded, texture_bytes] = cost;
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

}  // namespace scumble
