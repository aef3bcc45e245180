// What `scumble tradeoff` does: each variant is made and measured.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "measure/tradeoff_report.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"

namespace scumble {

struct TradeSetup {
  SceneRequest scene;  // its size is the picture's
  StyleRequest style;
  int repeats = 5;
  bool quick = false;
  bool memory = true;
  std::string only;
  std::optional<int> frame;        // as stylize has it
  std::optional<double> exposure;  // stops, likewise; empty: measured
  bool writes = false;             // the report is to be written too, which counts in the estimate of memory
};

// A run that takes longer than this is not repeated.
inline constexpr double kSlowMs = 5000.0;

// Everything that was measured. Guides are timed first, all variants' in turn, then transfers, those of a few variants
// in turn, quick ones before slow ones: what else the machine does then is spread over variants. Each run is one of a
// single picture (VariantPainter::Paint). Wrong options are kUsage; a scene that shows nothing is kInput; what would
// take more memory than there is, as CheckMemory; memory without RunContext::program is kUnavailable.
Expected<TradeReport> MeasureTradeoff(const TradeSetup& setup, const RunContext& context);

// The command line that measures all this again.
std::string TradeCommand(const TradeSetup& setup, const RunContext& context);

// Makes the picture of one variant, once, and returns the memory that this process has held at most, in bytes; for a
// process of its own.
Expected<std::size_t> PeakOfVariant(const TradeSetup& setup, const std::string& name, const RunContext& context);

}  // namespace scumble
