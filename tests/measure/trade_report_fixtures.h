// A report with every kind of figure, made up.
#pragma once

#include <limits>
#include <string>

#include "measure/tradeoff_report.h"

namespace scumble {

inline constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

inline TradeMeasure MadeUpVariant(const std::string& axis, const std::string& value, double total_ms, double error) {
  TradeMeasure variant;
  variant.name = value.empty() ? axis : axis + " " + value;
  variant.axis = axis;
  variant.value = value;
  variant.options = "--set transfer." + axis + "=" + value;
  variant.guides_ms = {total_ms * 0.25, total_ms * 0.24, total_ms * 0.27};
  variant.transfer_ms = {total_ms * 0.75, total_ms * 0.74, total_ms * 0.78};
  variant.total_ms = {total_ms, total_ms * 0.98, total_ms * 1.05};
  variant.prepare_ms = 12.5;
  variant.memory_bytes = 123456789;
  variant.both = {error, 0.0123456789012345};
  variant.energy = {error / 3, 0.004};
  variant.missing = {error / 1.5, 0.008};
  variant.texture = error;
  variant.guide_degrees = 2.25;
  variant.coherence = 0.897;
  variant.chunk_area = 153.25;
  variant.seam_excess = -0.0625;
  variant.repetition = 3.125;
  variant.picture_png = {0x89, 'P', 'N', 'G', static_cast<std::uint8_t>(value.empty() ? 0 : value[0])};
  return variant;
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
  report.variants = {
      MadeUpVariant("style", "", 40.0, 0.5),        MadeUpVariant("levels", "1", 10.0, 0.75),
      MadeUpVariant("radius", "0", 30.0, 0.5),      MadeUpVariant("levels", "3", 20.0, 0.6),
      MadeUpVariant("method", "litsphere", 5.0, 1), MadeUpVariant("method", "bruteforce", 12345.0, 0.45)};
  report.variants[0].name = "the style";
  report.variants[0].options.clear();
  report.variants[0].chosen = true;
  report.variants[5].exact = true;
  report.variants[3].guide_rms = 0.001;
  report.variants[3].guide_flip = 0.02;
  report.texture_floor = 0.25;
  return report;
}

// Names as hostile as files may be called.
inline TradeReport HostileReport() {
  TradeReport report = MadeUpReport();
  report.scene = "a<b>&\"c'.glb";
  report.style = "</script><script>alert(1)</script>";
  report.machine = "<i>";
  report.command = "scumble tradeoff \"a<b>\"";
  report.variants[1].name = "comma, and \"quote\"\nline";
  report.variants[1].axis = "<axis>";
  report.variants[1].options = "--set 'a=\"b\"' & <c>";
  report.variants[1].note = "<note>\r\n";
  return report;
}

}  // namespace scumble
