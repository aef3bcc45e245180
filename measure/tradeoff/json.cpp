// The trade-off for programs.
#include <nlohmann/json.hpp>

#include "measure/report/json_number.h"
#include "measure/tradeoff/parts.h"
#include "measure/tradeoff/report.h"

namespace scumble {
namespace {

using Json = nlohmann::ordered_json;

Json NumberJson(const std::optional<double>& value) { return value ? JsonNumber(*value) : Json(); }

Json TimeJson(const Quartiles& time) {
  if (!internal::Taken(time.median)) return {};
  return {{"median", JsonNumber(time.median)},
          {"lower_quartile", JsonNumber(time.lower)},
          {"upper_quartile", JsonNumber(time.upper)}};
}

Json EstimateJson(const Estimate& estimate) {
  if (!internal::Taken(estimate)) return {};
  return {{"mean", JsonNumber(estimate.mean)}, {"standard_error", JsonNumber(estimate.standard_error)}};
}

Json WayJson(const TradeReport& report, std::size_t i, bool front) {
  const TradeMeasure& way = report.ways[i];
  Json json{{"way", way.name},  {"axis", way.axis},     {"value", way.value}, {"options", way.options},
            {"note", way.note}, {"chosen", way.chosen}, {"exact", way.exact}, {"front", front}};
  json["guides_ms"] = TimeJson(way.guides_ms);
  json["transfer_ms"] = TimeJson(way.transfer_ms);
  json["total_ms"] = TimeJson(way.total_ms);
  json["prepare_ms"] = NumberJson(internal::Taken(way.prepare_ms));
  json["memory_bytes"] = way.memory_bytes > 0 ? Json(way.memory_bytes) : Json();
  json["both"] = EstimateJson(way.both);
  json["energy"] = EstimateJson(way.energy);
  json["missing"] = EstimateJson(way.missing);
  json["guide_degrees"] = NumberJson(way.guide_degrees);
  json["coherence"] = NumberJson(way.coherence);
  json["chunk_area_pixels"] = NumberJson(way.chunk_area);
  json["seam_excess"] = NumberJson(way.seam_excess);
  json["repetition"] = NumberJson(way.repetition);
  json["guide_rms"] = NumberJson(way.guide_rms);
  json["guide_flip"] = NumberJson(way.guide_flip);
  json["picture"] = way.picture_png.empty() ? Json() : Json(TradePictureName(report, i));
  return json;
}

}  // namespace

std::string TradeJson(const TradeReport& report) {
  Json json{{"scene", report.scene},
            {"style", report.style},
            {"frame", report.frame ? Json(*report.frame) : Json()},
            {"exposure", NumberJson(report.exposure)},
            {"width", report.width},
            {"height", report.height},
            {"machine", report.machine},
            {"repeats", report.repeats},
            {"lambda", JsonNumber(report.lambda)},
            {"command", report.command}};
  json["front"] = Json::array();
  for (const std::size_t i : FrontOf(report)) json["front"].push_back(report.ways[i].name);
  json["left_out"] = report.left_out;
  json["ways"] = Json::array();
  const std::vector<bool> front = internal::OnFront(report);
  for (std::size_t i = 0; i < report.ways.size(); ++i) json["ways"].push_back(WayJson(report, i, front[i]));
  // Names may hold any bytes; JSON may not.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace scumble
