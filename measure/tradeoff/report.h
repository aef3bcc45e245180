// The report of `scumble tradeoff`: what every variant to stylise a scene costs and how far off it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "measure/energy/energy.h"

namespace scumble {

struct Quartiles {
  double median = 0.0, lower = 0.0, upper = 0.0;
};

// Of one variant. What was not measured, or does not exist for it, is empty; a time or memory of 0 and an estimate of
// NaN too.
struct TradeMeasure {
  std::string name;     // unique
  std::string axis;     // what it changes of the style's own settings, "levels"; "style": nothing
  std::string value;    // to what, "3"
  std::string options;  // of stylize, that make this picture again; empty: none do, and `note` says why
  std::string note;     // for the reader; empty: none
  bool chosen = false;  // the style as it is
  bool exact = false;   // it is what the others are measured against
  std::optional<std::size_t>
      same_as;             // the place of the first way in the report that makes the same picture, if not this
  bool by_chance = false;  // the style as it is with another seed: by how much chance alone moves the figures
  Quartiles guides_ms, transfer_ms, total_ms;  // wall clock
  double prepare_ms = 0.0;  // the style, once, with nothing kept from before: tables, trees, exemplars at this size
  std::size_t memory_bytes = 0;         // the peak
  Estimate both, energy, missing;       // measure/energy/energy.h; `both` ranks
  std::optional<double> guide_degrees;  // mean angle between a pixel's normal and that of its source, exact guides
  std::optional<double> coherence;      // 0 … 1
  std::optional<double> chunk_area;     // mean, pixels
  std::optional<double> seam_excess;    // measure/mosaic/repetition.h
  std::optional<double> repetition;
  std::optional<double>
      guide_rms;  // of its guides against the converged ones: of normals, or of light where it is weighed
  std::optional<double> guide_flip;  // mean FLIP of the same, 0 … 1
  std::vector<std::uint8_t> picture_png;
};

struct TradeReport {
  std::string scene, style;  // names, without folders
  int width = 0, height = 0;
  std::string machine;  // processor and threads
  int repeats = 0;
  double lambda = 0.0;
  std::string command = {};       // that measures all this again; empty: not said
  std::optional<int> frame = {};  // of the scene and the style; none: as they stand
  // Stops by which the light of the style's own picture is brightened, given or fitted; none: the style looks at no
  // light.
  std::optional<double> exposure = {};
  std::vector<TradeMeasure> variants;
  std::vector<std::string> left_out = {};  // ways that were not measured, or figures, in words and with why
};

// Places in `ways` of the Pareto front of median total time and `both`, by rising time. What was not measured is not
// there, nor is what differs from the style by chance alone, nor what `stylize` has no options for. Of the others that
// make the same picture one stands for it: the first, unless a later one is quicker in total by more than the quartiles
// of both, else the moment would choose. One run has no quartiles.
std::vector<std::size_t> FrontOf(const TradeReport& report);

// Places in `ways`, the axes in the order in which they first come, ways of one axis in the order given.
std::vector<std::size_t> ByAxis(const TradeReport& report);

// A name for the picture of variants[i] that no other way has: "03-levels-4.png". Letters, digits and hyphens alone.
std::string TradePictureName(const TradeReport& report, std::size_t i);

// For a terminal, at most 120 columns wide unless a figure is absurdly long: a line a variant by axis, the front marked
// with a star; what the guides of variants differ by, where that was measured; notes.
std::string TradeTable(const TradeReport& report);

// RFC 4180 (lines end in CR LF): a line of column names with their units, then one a variant in the order given.
// Numbers are as C writes them, whatever the locale, and read back to the same value; yes and no are 1 and 0; what was
// not measured is empty; "nan", "inf" and "-inf" are what was measured and is no number.
std::string TradeCsv(const TradeReport& report);

// The same figures; docs/tradeoff.md has the schema. What was not measured is null.
std::string TradeJson(const TradeReport& report);

// A self-contained SVG on white: time (logarithmic) against `both`, quartiles and standard errors as bars, the front as
// a line with its names, a colour and shape for each axis. Variants without a time or without `both` are not drawn.
std::string TradeChart(const TradeReport& report);

// One HTML page that loads nothing: the charts, the table, and every picture, embedded. Without scripts it still has
// all of that, with a link from each point to its picture; with them, figures show under the pointer, columns sort, and
// pictures are flipped against the style's own. A picture that equals an earlier one byte for byte is there once.
std::string TradeHtml(const TradeReport& report);

}  // namespace scumble
