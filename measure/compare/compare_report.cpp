#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "measure/compare.h"
#include "measure/json_number.h"

namespace scumble {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const DifferenceStats& stats) {
  Json json = {{"values", stats.values},
               {"different", stats.different},
               {"incomparable", stats.incomparable},
               {"mean", JsonNumber(stats.mean)},
               {"rms", JsonNumber(stats.rms)},
               {"psnr_db", JsonNumber(stats.psnr_db)},
               {"peak", JsonNumber(stats.peak)},
               {"worst", nullptr}};
  if (stats.worst) {
    json["worst"] = {{"channel", stats.worst->channel},
                     {"x", stats.worst->x},
                     {"y", stats.worst->y},
                     {"a", JsonNumber(stats.worst->a)},
                     {"b", JsonNumber(stats.worst->b)},
                     {"difference", JsonNumber(stats.worst->difference)}};
  }
  return json;
}

Json ToJson(const PixelCounts& counts) {
  return {{"over_warn", counts.over_warn},
          {"over_fail", counts.over_fail},
          {"over_hardwarn", counts.over_hardwarn},
          {"over_hardfail", counts.over_hardfail}};
}

Json ToJson(const AngularStats& angles) {
  return {
      {"pixels", angles.pixels},           {"unmatched", angles.unmatched},     {"mean_degrees", angles.mean_degrees},
      {"p50_degrees", angles.p50_degrees}, {"p99_degrees", angles.p99_degrees}, {"p99_9_degrees", angles.p99_9_degrees},
      {"max_degrees", angles.max_degrees}, {"worst_x", angles.worst_x},         {"worst_y", angles.worst_y}};
}

Json ToJson(const DifferenceThresholds& thresholds) {
  return {{"absolute", JsonNumber(thresholds.absolute)},
          {"relative", JsonNumber(thresholds.relative)},
          {"percent", JsonNumber(thresholds.percent)},
          {"hard", JsonNumber(thresholds.hard)}};
}

std::string Row(std::size_t name_width, const std::string& name, const DifferenceStats& stats) {
  const std::string head =
      fmt::format("  {:<{}} {:>11.4g} {:>11.4g} {:>8.2f} ", name, name_width, stats.mean, stats.rms, stats.psnr_db);
  if (!stats.worst) return head + fmt::format("{:>11.4g}\n", 0.0);
  const WorstValue& worst = *stats.worst;
  return head + fmt::format("{:>11.4g}  at ({}, {}) {}: {:.7g} against {:.7g}\n", worst.difference, worst.x, worst.y,
                            worst.channel, worst.a, worst.b);
}

std::string AnglesText(std::size_t name_width, const AngularStats& angles) {
  std::string text = fmt::format("  {:<{}} ", "", name_width);
  if (angles.pixels == 0) {
    text += "no pixel has a unit normal in both";
  } else {
    text += fmt::format(
        "degrees: mean {:.4g}, median {:.4g}, 99 % {:.4g}, 99.9 % {:.4g}, max {:.4g} at ({}, {}), {} pixels",
        angles.mean_degrees, angles.p50_degrees, angles.p99_degrees, angles.p99_9_degrees, angles.max_degrees,
        angles.worst_x, angles.worst_y, angles.pixels);
  }
  if (angles.unmatched > 0) text += fmt::format("; a unit normal in only one of the two: {} pixels", angles.unmatched);
  return text + "\n";
}

}  // namespace

std::string CompareToJson(const CompareReport& report) {
  Json layers = Json::array();
  for (const LayerReport& layer : report.layers) {
    Json channels = Json::array();
    for (const ChannelReport& channel : layer.channels) {
      channels.push_back({{"name", channel.name}, {"stats", ToJson(channel.stats)}});
    }
    Json item = {{"name", layer.name},
                 {"stats", ToJson(layer.stats)},
                 {"pixels", ToJson(layer.pixels)},
                 {"channels", std::move(channels)}};
    if (layer.angles) item["angles"] = ToJson(*layer.angles);
    layers.push_back(std::move(item));
  }
  const Json options = {{"fail", ToJson(report.options.fail)},
                        {"warn", ToJson(report.options.warn)},
                        {"allow_failures", report.options.allow_failures},
                        {"layers", report.options.layers}};
  const Json json = {{"name_a", report.name_a},
                     {"name_b", report.name_b},
                     {"width", report.width},
                     {"height", report.height},
                     {"verdict", VerdictName(report.verdict)},
                     {"reasons", report.reasons},
                     {"options", options},
                     {"stats", ToJson(report.stats)},
                     {"pixels", ToJson(report.pixels)},
                     {"only_in_a", report.only_in_a},
                     {"only_in_b", report.only_in_b},
                     {"layers", std::move(layers)}};
  // File names may hold bytes that are not UTF-8; they are replaced rather than refused.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string CompareToText(const CompareReport& report) {
  std::size_t name_width = 5;
  for (const LayerReport& layer : report.layers) {
    name_width = std::max(name_width, layer.name.size());
    for (const ChannelReport& channel : layer.channels) name_width = std::max(name_width, channel.name.size() + 2);
  }
  std::string text = fmt::format("{} against {}, {}×{}\n", report.name_a, report.name_b, report.width, report.height);
  text += fmt::format("  {:<{}} {:>11} {:>11} {:>8} {:>11}\n", "layer", name_width, "mean", "RMS", "PSNR dB", "max");
  for (const LayerReport& layer : report.layers) {
    text += Row(name_width, layer.name, layer.stats);
    const bool alone = layer.channels.size() == 1 && layer.channels[0].name == layer.name;
    for (const ChannelReport& channel : layer.channels) {
      if (!alone) text += Row(name_width, "  " + channel.name, channel.stats);
    }
    if (layer.angles) text += AnglesText(name_width, *layer.angles);
    if (layer.stats.incomparable > 0) {
      text +=
          fmt::format("  {:<{}} NaN, or infinite on one side: {} values\n", "", name_width, layer.stats.incomparable);
    }
  }
  if (report.layers.size() > 1) text += Row(name_width, "all", report.stats);
  const double total = std::max(1.0, static_cast<double>(report.width) * report.height);
  const auto count_line = [&](std::size_t count, const char* name, double threshold) {
    return fmt::format("{} {} ({:.3g} %) over {} {:g}\n", count, count == 1 ? "pixel" : "pixels",
                       100.0 * static_cast<double>(count) / total, name, threshold);
  };
  text += count_line(report.pixels.over_warn, "warn", report.options.warn.absolute);
  text += count_line(report.pixels.over_fail, "fail", report.options.fail.absolute);
  for (const std::string& reason : report.reasons) text += reason + "\n";
  return text + fmt::format("{}\n", VerdictName(report.verdict));
}

}  // namespace scumble
