// The report of `scumble tradeoff`: what every way to stylise a scene costs and how far off it is.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "measure/energy.h"

namespace scumble {

struct Quartiles {
  double median = 0.0, lower = 0.0, upper = 0.0;
};

// Of one way. What was not measured, or does not exist for it, is empty.
struct TradeMeasure {
  std::string name;     // unique
  std::string axis;     // what it changes of the style's own settings, "levels"; "style": nothing
  std::string value;    // to what, "3"
  std::string options;  // of stylize, that make this picture again; empty: none do, and `note` says why
  std::string note;     // for the reader; empty: none
  bool chosen = false;  // the style as it is
  bool exact = false;   // it is what the others are measured against
  Quartiles guides_ms, transfer_ms, total_ms;  // wall clock
  std::size_t memory_bytes = 0;                // the peak
  Estimate both, energy, missing;              // measure/energy.h; `both` ranks
  std::optional<double> guide_degrees;         // mean angle between a pixel's normal and that of its source, exact guides
  std::optional<double> coherence;             // 0 … 1
  std::optional<double> chunk_area;            // mean, pixels
  std::optional<double> seam_excess;           // measure/repetition.h
  std::optional<double> repetition;
  std::optional<double> guide_rms;  // of its guides against the converged ones: of normals, or of light where it is weighed
  std::optional<double> guide_flip; // mean FLIP of the same, 0 … 1
  std::vector<std::uint8_t> picture_png;
};

struct TradeReport {
  std::string scene, style;  // names, without folders
  int width = 0, height = 0;
  std::string machine;  // processor and threads
  int repeats = 0;
  double lambda = 0.0;
  std::vector<TradeMeasure> ways;
};

// Places in `ways` of the Pareto front of median total time and `both`, by rising time.
std::vector<std::size_t> FrontOf(const TradeReport& report);

}  // namespace scumble
