// The trade-off for a terminal.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "measure/tradeoff/parts.h"
#include "measure/tradeoff_report.h"

namespace scumble {
namespace {

using internal::ShortFigure;

constexpr std::size_t kTableCells = 13, kMostWidth = 120;
using Row = std::array<std::string, kTableCells>;

constexpr std::size_t kName = 1;

// Characters: a terminal gives each one column.
std::size_t WidthOf(const std::string& utf8) {
  return static_cast<std::size_t>(std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string CutTo(const std::string& utf8, std::size_t width) {
  if (WidthOf(utf8) <= width) return utf8;
  std::string cut;
  std::size_t taken = 0;
  for (const char c : utf8) {
    if ((c & 0xC0) != 0x80 && ++taken > width - 1) break;
    cut += c;
  }
  return cut + "…";
}

// Without the spaces and the 0 before the point, which would not fit: "0.412±.004".
std::string Narrow(const Estimate& estimate) {
  const std::string wide = internal::ShortEstimate(estimate);
  const std::size_t sign = wide.find(" ± ");
  if (sign == std::string::npos) return wide;
  const std::string error = wide.substr(sign + std::string(" ± ").size());
  return wide.substr(0, sign) + "±" + (error.starts_with("0.") ? error.substr(1) : error);
}

Row RowOf(const TradeMeasure& variant, bool front) {
  return {front ? "*" : "",
          variant.name,
          internal::ShortTime(variant.total_ms),
          internal::ShortMegabytes(variant.memory_bytes),
          ShortFigure(variant.texture),
          Narrow(variant.both),
          Narrow(variant.energy),
          Narrow(variant.missing),
          ShortFigure(variant.guide_degrees),
          internal::ShortPercent(variant.coherence),
          ShortFigure(variant.chunk_area),
          ShortFigure(variant.seam_excess),
          ShortFigure(variant.repetition)};
}

const Row kHeadAbove = {"", "", "time, ms", "memory", "tex-", "", "", "", "off by", "coher.", "chunk", "seam", "repe-"};
const Row kHeadBelow = {"",        "variant", "(quartiles)", "MB", "ture",   "both",  "energy",
                        "missing", "°",       "%",           "px", "excess", "tition"};

std::string Line(const Row& row, const std::array<std::size_t, kTableCells>& widths) {
  std::string line;
  for (std::size_t column = 0; column < kTableCells; ++column) {
    const std::string cell = CutTo(row[column], std::max<std::size_t>(widths[column], 1));
    const std::string space(widths[column] - std::min(widths[column], WidthOf(cell)), ' ');
    if (column > 0) line += ' ';
    line += column <= kName ? cell + space : space + cell;
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::array<std::size_t, kTableCells> WidthsOf(const std::vector<Row>& rows) {
  std::array<std::size_t, kTableCells> widths{};
  for (const Row& row : rows) {
    for (std::size_t column = 0; column < kTableCells; ++column) {
      widths[column] = std::max(widths[column], WidthOf(row[column]));
    }
  }
  std::size_t others = kTableCells - 1;
  for (std::size_t column = 0; column < kTableCells; ++column) others += column == kName ? 0 : widths[column];
  constexpr std::size_t kLeastName = 8;
  widths[kName] = std::min(widths[kName], std::max(kLeastName, kMostWidth - std::min(others, kMostWidth)));
  return widths;
}

// The error of the guides themselves, of the few variants whose guides are not exact.
std::string GuideTable(const TradeReport& report) {
  std::string text;
  for (const std::size_t i : ByAxis(report)) {
    const TradeMeasure& variant = report.variants[i];
    if (variant.guide_rms.value_or(0.0) == 0.0 && variant.guide_flip.value_or(0.0) == 0.0) continue;
    if (text.empty()) text = "\nGuides against the exact ones: root mean square, and FLIP (0 to 1)\n";
    text += fmt::format("  {:<30} {:>10} {:>10}\n", CutTo(variant.name, 30), ShortFigure(variant.guide_rms),
                        ShortFigure(variant.guide_flip));
  }
  return text;
}

std::string Notes(const TradeReport& report) {
  std::string text;
  for (const TradeMeasure& variant : report.variants) {
    if (!variant.note.empty()) text += "  " + variant.name + ": " + variant.note + "\n";
  }
  for (const std::string& line : report.left_out) text += "  left out: " + line + "\n";
  return text.empty() ? "" : "\nNotes\n" + text;
}

}  // namespace

std::string TradeTable(const TradeReport& report) {
  std::string text = internal::TradeTitle(report) + "\n" + internal::TradeSetup(report) + "\n\n";
  if (report.variants.empty()) return text + "nothing was measured\n";
  const std::vector<bool> front = internal::OnFront(report);
  const std::vector<std::size_t> order = ByAxis(report);
  std::vector<Row> rows{kHeadAbove, kHeadBelow};
  for (const std::size_t i : order) rows.push_back(RowOf(report.variants[i], front[i]));
  const auto widths = WidthsOf(rows);
  for (std::size_t line = 0; line < rows.size(); ++line) {
    const bool new_axis = line > 2 && report.variants[order[line - 2]].axis != report.variants[order[line - 3]].axis;
    if (new_axis || line == 2) text += "\n";
    text += Line(rows[line], widths);
  }
  text +=
      "\n* nothing else is as fast and has paint that looks more like the exemplar's, by `texture` and more than "
      "chance:\n";
  if (report.texture_floor) {
    const std::optional<double> chance = ChanceOf(report);
    text += fmt::format(
        "  halves of the exemplar differ by {}, {}.\n", ShortFigure(report.texture_floor),
        chance ? "other seeds of the style by " + ShortFigure(chance) : "what is chance was not measured (axis seed)");
  }
  text +=
      "  both: what of the picture is not the exemplar's (energy) and what of the exemplar is not in the picture "
      "(missing).\n"
      "  coher.: neighbours whose paint was side by side; seam: larger steps across chunks than inside;\n"
      "  repetition: how often a shown pixel of the exemplar shows.\n";
  return text + GuideTable(report) + Notes(report);
}

}  // namespace scumble
