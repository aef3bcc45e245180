// The report of `scumble tradeoff`: the cost and the error of every variant of a stylised scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "measure/energy.h"

namespace scumble {

struct Quartiles {
  double median = 0.0, lower = 0.0, upper = 0.0;
};

// The figures of one variant. A figure that was not measured, or does not exist for it, is empty; so are a time or
// memory of 0 and an estimate of NaN.
struct TradeMeasure {
  std::string name;     // unique
  std::string axis;     // what it changes of the style's own settings, "levels"; "style": nothing
  std::string value;    // to what, "3"
  std::string options;  // of stylize, that make this picture again; empty: there are none, and `note` gives the reason
  std::string note;     // for the reader; empty: none
  bool chosen = false;  // the unchanged style
  bool exact = false;   // the reference of the others
  // The place of the first variant in the report with an equal picture, if not this.
  std::optional<std::size_t> same_as;
  bool by_chance = false;  // the unchanged style with another random seed: its figures show the seed's influence
  Quartiles guides_ms, transfer_ms, total_ms;  // wall clock
  double prepare_ms = 0.0;              // the style, once, with empty caches: tables, trees, exemplars at this size
  std::size_t memory_bytes = 0;         // the peak
  std::optional<double> texture;        // measure/texture/: paint and outlines; ranks
  Estimate both, energy, missing;       // measure/energy.h
  std::optional<double> guide_degrees;  // mean angle between a pixel's normal and that of its source, exact guides
  std::optional<double> coherence;      // 0 … 1
  std::optional<double> chunk_area;     // mean, pixels
  std::optional<double> seam_excess;    // measure/repetition.h
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
  std::string command = {};       // that measures all this again; empty: unknown
  std::optional<int> frame = {};  // of the scene and the style; none: static
  // Stops that brighten the light of the unchanged style's picture, given or fitted; none: the style uses no light.
  std::optional<double> exposure = {};
  // Of halves of the exemplar from each other: what paint of one kind differs by. None: not measured.
  std::optional<double> texture_floor = {};
  std::vector<TradeMeasure> variants;
  std::vector<std::string> left_out = {};  // variants or figures that were not measured, in words and with the reason
};

// The figure that ranks variants, and its name in files.
inline constexpr const char* kRankedBy = "texture";

// How far `texture` differs by chance: the largest difference between the unchanged style and itself with another
// random seed. None where no other seed was measured.
std::optional<double> ChanceOf(const TradeReport& report);

// Places in `variants` of the Pareto front of median total time and `texture`, by rising time: what is slower is on it
// only where it is nearer to the exemplar by more than chance. Left out are variants that were not measured, that
// differ from the style by their random seed alone, or that `stylize` has no options for. Of several with equal
// pictures one represents them: the first, unless a later one is faster in total by more than the quartiles of both,
// because otherwise timing noise would choose. One run has no quartiles.
std::vector<std::size_t> FrontOf(const TradeReport& report);

// Places in `variants`, axes in the order of their first variants, variants of one axis in the order given.
std::vector<std::size_t> ByAxis(const TradeReport& report);

// A unique name for the picture of variants[i]: "03-levels-4.png". Letters, digits and hyphens alone.
std::string TradePictureName(const TradeReport& report, std::size_t i);

// For a terminal, at most 120 columns wide unless a figure is very long: a line a variant by axis, the front marked
// with a star; the error of the variants' guides, where it was measured; notes.
std::string TradeTable(const TradeReport& report);

// RFC 4180 (lines end in CR LF): a line of column names with their units, then one a variant in the order given.
// Numbers have C's form in any locale, and read back to equal values; yes and no are 1 and 0. Figures that were not
// measured are empty; "nan", "inf" and "-inf" were measured.
std::string TradeCsv(const TradeReport& report);

// The figures as JSON; docs/tradeoff.md has the schema. Figures that were not measured are null.
std::string TradeJson(const TradeReport& report);

// A self-contained SVG on white: time (logarithmic) against `texture`, quartiles as bars, the front as a line with its
// names, a colour and shape for each axis, and what halves of the exemplar differ by. Variants without a time or
// without `texture` are not drawn.
std::string TradeChart(const TradeReport& report);

// One HTML page that loads nothing: the charts, the table, and every picture, embedded. Without scripts it still has
// all of that, with a link from each point to its picture; with them, figures show under the pointer, columns sort, and
// pictures flip against the style's own. Equal pictures are embedded once.
std::string TradeHtml(const TradeReport& report);

}  // namespace scumble
