#include "measure/tradeoff_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "measure/tradeoff/pareto.h"
#include "measure/tradeoff/parts.h"

namespace scumble {
namespace internal {
namespace {

constexpr const char* kNone = "–";

// Digits after the point for three significant ones.
int Decimals(double value) {
  if (value == 0.0 || !std::isfinite(value)) return 2;
  return std::clamp(2 - static_cast<int>(std::floor(std::log10(std::abs(value)))), 0, 6);
}

}  // namespace

std::optional<double> Taken(double time_or_memory) {
  return time_or_memory > 0.0 ? std::optional(time_or_memory) : std::nullopt;
}

std::optional<double> Taken(const Estimate& estimate) {
  return std::isnan(estimate.mean) ? std::nullopt : std::optional(estimate.mean);
}

std::vector<bool> OnFront(const TradeReport& report) {
  std::vector<bool> on(report.variants.size(), false);
  for (const std::size_t i : FrontOf(report)) on[i] = true;
  return on;
}

std::string ShortFigure(const std::optional<double>& value) {
  return value ? fmt::format("{:.{}f}", *value, Decimals(*value)) : kNone;
}

std::string ShortEstimate(const Estimate& estimate) {
  if (!Taken(estimate)) return kNone;
  const int decimals = Decimals(estimate.mean);
  std::string text = fmt::format("{:.{}f}", estimate.mean, decimals);
  if (estimate.standard_error > 0.0) text += fmt::format(" ± {:.{}f}", estimate.standard_error, decimals);
  return text;
}

std::string ShortTime(const Quartiles& time) {
  if (!Taken(time.median)) return kNone;
  const int decimals = Decimals(time.median);
  return fmt::format("{:.{}f} ({:.{}f}–{:.{}f})", time.median, decimals, time.lower, decimals, time.upper, decimals);
}

std::string ShortMegabytes(std::size_t bytes) { return ShortFigure(Taken(static_cast<double>(bytes) * 1e-6)); }

std::string ShortPercent(const std::optional<double>& share) {
  return share ? fmt::format("{:.1f}", 100.0 * *share) : kNone;
}

std::string TradeTitle(const TradeReport& report) {
  return report.scene + " in " + report.style + (report.frame ? fmt::format(", frame {}", *report.frame) : "");
}

std::string TradeSetup(const TradeReport& report) {
  std::string setup = fmt::format("{}×{} pixels", report.width, report.height);
  if (!report.machine.empty()) setup += ", " + report.machine;
  setup += report.repeats == 1 ? "; one run" : fmt::format("; medians of {} runs", report.repeats);
  return setup + fmt::format("; λ = {:g}", report.lambda);
}

std::vector<std::string> AxesOf(const TradeReport& report) {
  std::vector<std::string> axes;
  for (const TradeMeasure& variant : report.variants) {
    if (std::find(axes.begin(), axes.end(), variant.axis) == axes.end()) axes.push_back(variant.axis);
  }
  return axes;
}

}  // namespace internal

namespace {

bool CanBeChosen(const TradeMeasure& variant) {
  return !variant.by_chance && (variant.chosen || !variant.options.empty());
}

// One run has no quartiles for a comparison.
bool IsSurelyQuicker(const TradeMeasure& variant, const TradeMeasure& other) {
  const bool once = variant.total_ms.lower == variant.total_ms.upper || other.total_ms.lower == other.total_ms.upper;
  return !once && variant.total_ms.upper < other.total_ms.lower;
}

}  // namespace

namespace internal {

std::vector<bool> MayBeOnFront(const TradeReport& report) {
  std::map<std::size_t, std::size_t> standing;  // the representative of a picture, by the first variant that makes it
  for (std::size_t i = 0; i < report.variants.size(); ++i) {
    const TradeMeasure& variant = report.variants[i];
    if (!CanBeChosen(variant) || !Taken(variant.total_ms.median)) continue;
    const auto [place, is_new] = standing.try_emplace(variant.same_as.value_or(i), i);
    if (!is_new && IsSurelyQuicker(variant, report.variants[place->second])) place->second = i;
  }
  std::vector<bool> may(report.variants.size(), false);
  for (const auto& [picture, i] : standing) may[i] = true;
  return may;
}

}  // namespace internal

std::optional<double> ChanceOf(const TradeReport& report) {
  const auto own =
      std::find_if(report.variants.begin(), report.variants.end(), [](const auto& variant) { return variant.chosen; });
  std::optional<double> chance;
  if (own == report.variants.end() || !own->texture) return chance;
  for (const TradeMeasure& variant : report.variants) {
    if (variant.by_chance && variant.texture)
      chance = std::max(chance.value_or(0.0), std::abs(*variant.texture - *own->texture));
  }
  return chance;
}

std::vector<std::size_t> FrontOf(const TradeReport& report) {
  constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
  std::vector<TradePoint> points;
  const std::vector<bool> may = internal::MayBeOnFront(report);
  for (std::size_t i = 0; i < report.variants.size(); ++i) {
    points.push_back({may[i] ? report.variants[i].total_ms.median : kNotMeasured,
                      report.variants[i].texture.value_or(kNotMeasured)});
  }
  return ParetoFront(points, ChanceOf(report).value_or(0.0));
}

std::vector<std::size_t> ByAxis(const TradeReport& report) {
  std::vector<std::size_t> order;
  for (const std::string& axis : internal::AxesOf(report)) {
    for (std::size_t i = 0; i < report.variants.size(); ++i) {
      if (report.variants[i].axis == axis) order.push_back(i);
    }
  }
  return order;
}

std::string TradePictureName(const TradeReport& report, std::size_t i) {
  std::string name = fmt::format("{:02}", i + 1);
  for (const char c : "-" + report.variants[i].name) {
    const char lower = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    const bool plain = (lower >= 'a' && lower <= 'z') || (lower >= '0' && lower <= '9');
    if (plain)
      name += lower;
    else if (name.back() != '-')
      name += '-';
  }
  while (name.back() == '-') name.pop_back();
  return name + ".png";
}

}  // namespace scumble
