// The trade-off for programs.
#include <nlohmann/json.hpp>

#include "measure/json_number.h"
#include "measure/tradeoff/parts.h"
#include "measure/tradeoff_report.h"

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

Json VariantJson(const TradeReport& report, std::size_t i, bool front) {
  const TradeMeasure& variant = report.variants[i];
  Json json{{"variant", variant.name},    {"axis", variant.axis}, {"value", variant.value},
            {"options", variant.options}, {"note", variant.note}, {"chosen", variant.chosen},
            {"exact", variant.exact},     {"front", front}};
  json["guides_ms"] = TimeJson(variant.guides_ms);
  json["transfer_ms"] = TimeJson(variant.transfer_ms);
  json["total_ms"] = TimeJson(variant.total_ms);
  json["prepare_ms"] = NumberJson(internal::Taken(variant.prepare_ms));
  json["memory_bytes"] = variant.memory_bytes > 0 ? Json(variant.memory_bytes) : Json();
  json["texture"] = NumberJson(variant.texture);
  json["both"] = EstimateJson(variant.both);
  json["energy"] = EstimateJson(variant.energy);
  json["missing"] = EstimateJson(variant.missing);
  json["guide_degrees"] = NumberJson(variant.guide_degrees);
  json["coherence"] = NumberJson(variant.coherence);
  json["chunk_area_pixels"] = NumberJson(variant.chunk_area);
  json["seam_excess"] = NumberJson(variant.seam_excess);
  json["repetition"] = NumberJson(variant.repetition);
  json["guide_rms"] = NumberJson(variant.guide_rms);
  json["guide_flip"] = NumberJson(variant.guide_flip);
  json["picture"] = variant.picture_png.empty() ? Json() : Json(TradePictureName(report, i));
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
            {"command", report.command},
            {"ranked_by", kRankedBy},
            {"texture_floor", NumberJson(report.texture_floor)},
            {"texture_chance", NumberJson(ChanceOf(report))}};
  json["front"] = Json::array();
  for (const std::size_t i : FrontOf(report)) json["front"].push_back(report.variants[i].name);
  json["left_out"] = report.left_out;
  json["variants"] = Json::array();
  const std::vector<bool> front = internal::OnFront(report);
  for (std::size_t i = 0; i < report.variants.size(); ++i) json["variants"].push_back(VariantJson(report, i, front[i]));
  // Names may hold any bytes; JSON may not.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace scumble
