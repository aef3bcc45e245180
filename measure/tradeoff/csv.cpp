// The trade-off for spreadsheets.
#include <fmt/format.h>

#include "measure/tradeoff/parts.h"
#include "measure/tradeoff/report.h"

namespace scumble {
namespace {

constexpr const char* kHead =
    "way,axis,value,options,note,chosen,exact,front,"
    "guides_ms_median,guides_ms_lower_quartile,guides_ms_upper_quartile,"
    "transfer_ms_median,transfer_ms_lower_quartile,transfer_ms_upper_quartile,"
    "total_ms_median,total_ms_lower_quartile,total_ms_upper_quartile,prepare_ms,memory_bytes,"
    "both,both_standard_error,energy,energy_standard_error,missing,missing_standard_error,"
    "guide_degrees,coherence,chunk_area_pixels,seam_excess,repetition,guide_rms,guide_flip,picture";

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
  for (std::size_t i = 0; i < report.ways.size(); ++i) {
    const TradeMeasure& way = report.ways[i];
    for (const std::string& text : {way.name, way.axis, way.value, way.options, way.note}) csv += Quoted(text) + ",";
    csv += fmt::format("{:d},{:d},{:d},", way.chosen, way.exact, bool(front[i]));
    for (const Quartiles& time : {way.guides_ms, way.transfer_ms, way.total_ms}) csv += Time(time) + ",";
    csv += Number(internal::Taken(way.prepare_ms)) + ",";
    csv += way.memory_bytes > 0 ? fmt::format("{},", way.memory_bytes) : ",";
    for (const Estimate& estimate : {way.both, way.energy, way.missing}) csv += Figure(estimate) + ",";
    for (const auto& value : {way.guide_degrees, way.coherence, way.chunk_area, way.seam_excess, way.repetition,
                              way.guide_rms, way.guide_flip}) {
      csv += Number(value) + ",";
    }
    csv += (way.picture_png.empty() ? "" : TradePictureName(report, i)) + "\r\n";
  }
  return csv;
}

}  // namespace scumble
