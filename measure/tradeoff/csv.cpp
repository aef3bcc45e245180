// The trade-off for spreadsheets.
#include <fmt/format.h>

#include "measure/tradeoff/parts.h"
#include "measure/tradeoff_report.h"

namespace scumble {
namespace {

constexpr const char* kHead =
    "variant,axis,value,options,note,chosen,exact,front,"
    "guides_ms_median,guides_ms_lower_quartile,guides_ms_upper_quartile,"
    "transfer_ms_median,transfer_ms_lower_quartile,transfer_ms_upper_quartile,"
    "total_ms_median,total_ms_lower_quartile,total_ms_upper_quartile,prepare_ms,memory_bytes,"
    "both,both_standard_error,energy,energy_standard_error,missing,missing_standard_error,"
    "texture,guide_degrees,coherence,chunk_area_pixels,seam_excess,repetition,guide_rms,guide_flip,picture";

std::string Quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

// The shortest text that reads back to the same value.
std::string Number(const std::optional<double>& value) { return value ? fmt::format("{}", *value) : ""; }

std::string Time(const Quartiles& time) {
  if (!internal::Taken(time.median)) return ",,";
  return fmt::format("{},{},{}", time.median, time.lower, time.upper);
}

std::string Figure(const Estimate& estimate) {
  if (!internal::Taken(estimate)) return ",";
  return fmt::format("{},{}", estimate.mean, estimate.standard_error);
}

}  // namespace

std::string TradeCsv(const TradeReport& report) {
  std::string csv = std::string(kHead) + "\r\n";
  const std::vector<bool> front = internal::OnFront(report);
  for (std::size_t i = 0; i < report.variants.size(); ++i) {
    const TradeMeasure& variant = report.variants[i];
    for (const std::string& text : {variant.name, variant.axis, variant.value, variant.options, variant.note})
      csv += Quoted(text) + ",";
    csv += fmt::format("{:d},{:d},{:d},", variant.chosen, variant.exact, bool(front[i]));
    for (const Quartiles& time : {variant.guides_ms, variant.transfer_ms, variant.total_ms}) csv += Time(time) + ",";
    csv += Number(internal::Taken(variant.prepare_ms)) + ",";
    csv += variant.memory_bytes > 0 ? fmt::format("{},", variant.memory_bytes) : ",";
    for (const Estimate& estimate : {variant.both, variant.energy, variant.missing}) csv += Figure(estimate) + ",";
    for (const auto& value : {variant.texture, variant.guide_degrees, variant.coherence, variant.chunk_area,
                              variant.seam_excess, variant.repetition, variant.guide_rms, variant.guide_flip}) {
      csv += Number(value) + ",";
    }
    csv += (variant.picture_png.empty() ? "" : TradePictureName(report, i)) + "\r\n";
  }
  return csv;
}

}  // namespace scumble
