// A report with every kind of figure, made up.
#pragma once

#include <limits>
#include <string>

#include "measure/tradeoff/report.h"

namespace scumble {

inline constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

inline TradeMeasure MadeUpWay(const std::string& axis, const std::string& value, double total_ms, double both) {
  TradeMeasure way;
  way.name = value.empty() ? axis : axis + " " + value;
  way.axis = axis;
  way.value = value;
  way.options = "--set transfer." + axis + "=" + value;
  way.guides_ms = {total_ms * 0.25, total_ms * 0.24, total_ms * 0.27};
  way.transfer_ms = {total_ms * 0.75, total_ms * 0.74, total_ms * 0.78};
  way.total_ms = {total_ms, total_ms * 0.98, total_ms * 1.05};
  way.prepare_ms = 12.5;
  way.memory_bytes = 123456789;
  way.both = {both, 0.0123456789012345};
  way.energy = {both / 3, 0.004};
  way.missing = {both / 1.5, 0.008};
  way.guide_degrees = 2.25;
  way.coherence = 0.897;
  way.chunk_area = 153.25;
  way.seam_excess = -0.0625;
  way.repetition = 3.125;
  way.picture_png = {0x89, 'P', 'N', 'G', static_cast<std::uint8_t>(value.empty() ? 0 : value[0])};
  return way;
}

inline TradeReport MadeUpReport() {
  TradeReport report;
  report.scene = "suzanne";
  report.style = "oil";
  report.width = 960;
  report.height = 540;
  report.machine = "a processor, 2 threads";
  report.repeats = 5;
  report.lambda = 10.0;
  report.command = "scumble tradeoff suzanne.glb --style oil";
  report.ways = {MadeUpWay("style", "", 40.0, 0.5),        MadeUpWay("levels", "1", 10.0, 0.75),
                 MadeUpWay("radius", "0", 30.0, 0.5),      MadeUpWay("levels", "3", 20.0, 0.6),
                 MadeUpWay("method", "litsphere", 5.0, 1), MadeUpWay("method", "bruteforce", 12345.0, 0.45)};
  report.ways[0].name = "the style";
  report.ways[0].options.clear();
  report.ways[0].chosen = true;
  report.ways[5].exact = true;
  report.ways[3].guide_rms = 0.001;
  report.ways[3].guide_flip = 0.02;
  return report;
}

// Names as hostile as files may be called.
inline TradeReport HostileReport() {
  TradeReport report = MadeUpReport();
  report.scene = "a<b>&\"c'.glb";
  report.style = "</script><script>alert(1)</script>";
  report.machine = "<i>";
  report.command = "scumble tradeoff \"a<b>\"";
  report.ways[1].name = "comma, and \"quote\"\nline";
  report.ways[1].axis = "<axis>";
  report.ways[1].options = "--set 'a=\"b\"' & <c>";
  report.ways[1].note = "<note>\r\n";
  return report;
}

}  // namespace scumble
