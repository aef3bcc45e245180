// Helpers shared by the files of the trade-off's report. Private to measure/tradeoff.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "measure/tradeoff_report.h"

namespace scumble::internal {

// A figure; empty if it was not measured: a time or memory of 0, an estimate of NaN.
std::optional<double> Taken(double time_or_memory);
std::optional<double> Taken(const Estimate& estimate);

// For each variant, whether it may be on a front, given good figures. It was timed, differs by more than its random
// seed, can be chosen by options of `stylize`, and represents its picture, as at FrontOf.
std::vector<bool> MayBeOnFront(const TradeReport& report);

// For each variant, whether it is on the front.
std::vector<bool> OnFront(const TradeReport& report);

// For people, with three significant digits; "–" where there is none.
std::string ShortFigure(const std::optional<double>& value);
std::string ShortEstimate(const Estimate& estimate);           // "0.412 ± 0.004"; no error where all was looked at
std::string ShortTime(const Quartiles& time);                  // "12.3 (11.9–13.0)"
std::string ShortMegabytes(std::size_t bytes);                 // of 10⁶ bytes
std::string ShortPercent(const std::optional<double>& share);  // 0.897 is "89.7"

// Titles: scene, style, size, machine; in one line each.
std::string TradeTitle(const TradeReport& report);  // "suzanne in oil"
std::string TradeSetup(const TradeReport& report);  // "960×540 pixels, AMD …, 2 threads; medians of 5 runs; λ = 10"

// The quantity on a chart's time axis.
enum class ChartTime { kTotal, kTransfer, kMemory };
enum class ChartError { kTexture, kBoth, kEnergy, kMissing };

struct ChartLook {
  ChartTime time = ChartTime::kTotal;
  ChartError error = ChartError::kTexture;
  bool page = false;  // for the page: colours of its style sheet, links from points to pictures; else a separate file
};

// A chart as described at TradeChart.
std::string DrawTradeChart(const TradeReport& report, const ChartLook& look);

// The mark of an axis in charts and legends, an SVG element of about 9 pixels around (x, y). `axis` counts from 0.
std::string ChartMark(std::size_t axis, double x, double y);

// The axes in the order in which they first come.
std::vector<std::string> AxesOf(const TradeReport& report);

// Style sheet and script of the page, beside what all pages share (measure/html_page.h).
extern const char* const kTradePageStyle;
extern const char* const kTradePageScript;

}  // namespace scumble::internal
