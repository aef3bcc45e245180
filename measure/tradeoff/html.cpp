// The trade-off as one self-contained HTML page.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "measure/html_page.h"
#include "measure/tradeoff/parts.h"
#include "measure/tradeoff_report.h"

namespace scumble {
namespace {

using internal::EscapeHtml;
using internal::ShortEstimate;
using internal::ShortFigure;
using internal::ShortTime;

constexpr const char* kTimes[] = {"guides and transfer", "transfer alone", "memory"};
constexpr const char* kErrors[] = {"texture", "both", "energy", "missing"};

std::string LinkTo(const TradeReport& report, std::size_t i) {
  return fmt::format("<a href=\"#variant-{}\">{}</a>", i + 1, EscapeHtml(report.variants[i].name));
}

std::string Costs(const TradeMeasure& variant) {
  return fmt::format("{} ms, texture {}", ShortFigure(variant.total_ms.median), ShortFigure(variant.texture));
}

// The place of the unchanged style.
std::string OwnPlace(const TradeReport& report, const std::vector<std::size_t>& front) {
  const auto own =
      std::find_if(report.variants.begin(), report.variants.end(), [](const auto& variant) { return variant.chosen; });
  if (own == report.variants.end() || !internal::Taken(own->total_ms.median) || !own->texture) return "";
  const std::size_t place = static_cast<std::size_t>(own - report.variants.begin());
  std::string text = "The style as it is takes " + Costs(*own);
  if (std::find(front.begin(), front.end(), place) != front.end()) return text + ", and is on the front.";
  text += ". Faster, and farther from the exemplar by no more than chance:";
  const double most = *own->texture + ChanceOf(report).value_or(0.0);
  const char* comma = " ";
  for (const std::size_t i : front) {
    const TradeMeasure& variant = report.variants[i];
    if (variant.total_ms.median > own->total_ms.median || variant.texture.value_or(most) > most) continue;
    text += comma + LinkTo(report, i) + " (" + Costs(variant) + ")";
    comma = ", ";
  }
  return text + ".";
}

std::string LeftOut(const TradeReport& report) {
  std::string html;
  for (const std::string& line : report.left_out) html += "<p class=\"soft\">Left out: " + EscapeHtml(line) + ".</p>\n";
  return html;
}

std::string Header(const TradeReport& report) {
  const std::vector<std::size_t> front = FrontOf(report);
  std::string html = "<h1>" + EscapeHtml(internal::TradeTitle(report)) +
                     ": speed against accuracy</h1>\n<p class=\"soft\">" + EscapeHtml(internal::TradeSetup(report)) +
                     ".</p>\n";
  if (!report.command.empty()) html += "<p>Repeat with <code>" + EscapeHtml(report.command) + "</code></p>\n";
  if (report.variants.empty()) return html + "<p>Nothing was measured.</p>\n";
  const std::optional<double> chance = ChanceOf(report);
  html += fmt::format(
      "<p>{} of {} variants are on the front: nothing else is as fast and has paint that looks more like the "
      "exemplar's{}. ",
      front.size(), report.variants.size(),
      chance ? fmt::format(", by more than other seeds of the style differ by, {}", ShortFigure(chance)) : "");
  return html + OwnPlace(report, front) + "</p>\n" + LeftOut(report);
}

std::string Choice(const char* name, std::size_t i, const char* label) {
  return fmt::format("<label><input type=\"radio\" name=\"{0}\" id=\"{0}-{1}\"{2}> {3}</label>\n", name, i,
                     i == 0 ? " checked" : "", label);
}

std::string Choices(const TradeReport& report) {
  std::string html = "<form class=\"choose\" autocomplete=\"off\">\n<fieldset><legend>across</legend>\n";
  for (std::size_t t = 0; t < std::size(kTimes); ++t) html += Choice("time", t, kTimes[t]);
  html += "</fieldset>\n<fieldset><legend>up</legend>\n";
  for (std::size_t e = 0; e < std::size(kErrors); ++e) html += Choice("error", e, kErrors[e]);
  html += "</fieldset>\n<fieldset><legend>shown</legend>\n";
  const std::vector<std::string> axes = internal::AxesOf(report);
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    html += fmt::format(
        "<label><input type=\"checkbox\" id=\"axis-{}\" checked> <svg class=\"mark\" viewBox=\"0 0 14 14\" "
        "aria-hidden=\"true\">{}</svg> {}</label>\n",
        axis + 1, internal::ChartMark(axis, 7, 7), EscapeHtml(axes[axis]));
  }
  return html + "</fieldset>\n</form>\n";
}

// The choice works by style sheet alone, so that it needs no scripts.
std::string ChoiceStyle(const TradeReport& report) {
  std::string css = "@supports selector(:has(*)) {\n.plot, .plot.first { display: none; }\n";
  for (std::size_t t = 0; t < std::size(kTimes); ++t) {
    for (std::size_t e = 0; e < std::size(kErrors); ++e) {
      css += fmt::format(
          "#chart:has(#time-{0}:checked):has(#error-{1}:checked) .plot.time-{0}.error-{1} {{ display: block; }}\n", t,
          e);
    }
  }
  for (std::size_t axis = 1; axis <= internal::AxesOf(report).size(); ++axis) {
    css += fmt::format("#chart:has(#axis-{0}:not(:checked)) .axis-{0} {{ display: none; }}\n", axis);
  }
  return css + "}\n";
}

std::string Charts(const TradeReport& report) {
  std::string html = "<section id=\"chart\">\n" + Choices(report);
  for (std::size_t t = 0; t < std::size(kTimes); ++t) {
    for (std::size_t e = 0; e < std::size(kErrors); ++e) {
      const internal::ChartLook look{static_cast<internal::ChartTime>(t), static_cast<internal::ChartError>(e), true};
      html += fmt::format("<div class=\"plot time-{0} error-{1}{2}\">\n", t, e, t + e == 0 ? " first" : "") +
              internal::DrawTradeChart(report, look) + "</div>\n";
    }
  }
  return html +
         "<p id=\"told\" class=\"soft\">Dashed: the front, ringed its points; of memory none is drawn, as most "
         "variants differ by less than two runs of one. Bars are quartiles of the time and, of energies, standard "
         "errors; the thin line is what halves of the exemplar differ by. Each point leads to its "
         "picture.</p>\n</section>\n";
}

struct Column {
  const char* head;
  const char* unit;
  bool number;
};

constexpr Column kColumns[] = {
    {"front", "", false},     {"variant", "", false},    {"changes", "", false},    {"time", "ms", true},
    {"guides", "ms", true},   {"transfer", "ms", true},  {"prepare", "ms", true},   {"memory", "MB", true},
    {"texture", "", true},    {"both", "", true},        {"energy", "", true},      {"missing", "", true},
    {"off by", "°", true},    {"coherence", "%", true},  {"chunk", "px", true},     {"seam excess", "", true},
    {"repetition", "", true}, {"guides' RMS", "", true}, {"guides' FLIP", "", true}};

std::string Cell(const std::optional<double>& value, const std::string& shown) {
  return fmt::format("<td class=\"number\" data-v=\"{}\">{}</td>", value ? fmt::format("{}", *value) : "", shown);
}

std::string TimeCell(const Quartiles& time) { return Cell(internal::Taken(time.median), ShortTime(time)); }

std::string EstimateCell(const Estimate& estimate) { return Cell(internal::Taken(estimate), ShortEstimate(estimate)); }

std::string FigureCell(const std::optional<double>& value) { return Cell(value, ShortFigure(value)); }

std::string VariantRow(const TradeReport& report, std::size_t i, bool front) {
  const TradeMeasure& variant = report.variants[i];
  std::string html = fmt::format("<tr{}><td data-v=\"{}\">{}</td>", variant.chosen ? " class=\"chosen\"" : "",
                                 front ? 0 : 1, front ? "<span aria-label=\"on the front\">★</span>" : "");
  html += fmt::format("<th scope=\"row\" data-v=\"{}\">{}</th><td>{}</td>", EscapeHtml(variant.name), LinkTo(report, i),
                      EscapeHtml(variant.axis));
  html += TimeCell(variant.total_ms) + TimeCell(variant.guides_ms) + TimeCell(variant.transfer_ms);
  html += FigureCell(internal::Taken(variant.prepare_ms));
  html +=
      Cell(internal::Taken(static_cast<double>(variant.memory_bytes)), internal::ShortMegabytes(variant.memory_bytes));
  html += FigureCell(variant.texture);
  html += EstimateCell(variant.both) + EstimateCell(variant.energy) + EstimateCell(variant.missing);
  html += FigureCell(variant.guide_degrees) + Cell(variant.coherence, internal::ShortPercent(variant.coherence));
  for (const auto& value :
       {variant.chunk_area, variant.seam_excess, variant.repetition, variant.guide_rms, variant.guide_flip}) {
    html += FigureCell(value);
  }
  return html + "</tr>\n";
}

std::string Table(const TradeReport& report) {
  std::string html = "<section>\n<table id=\"variants\"><thead><tr>";
  for (const Column& column : kColumns) {
    html += fmt::format("<th scope=\"col\"{}>{}{}</th>", column.number ? " class=\"number\"" : "", column.head,
                        *column.unit ? fmt::format(", {}", column.unit) : "");
  }
  html += "</tr></thead><tbody>\n";
  const std::vector<bool> front = internal::OnFront(report);
  for (const std::size_t i : ByAxis(report)) html += VariantRow(report, i, front[i]);
  return html + "</tbody></table>\n</section>\n";
}

// The text under a picture: its figures and its command.
std::string Caption(const TradeReport& report, std::size_t i, bool front) {
  const TradeMeasure& variant = report.variants[i];
  std::string html = "<figcaption><b>" + EscapeHtml(variant.name) + "</b>";
  if (variant.chosen) html += ", the style as it is";
  if (variant.exact) html += ", what the others are measured against";
  if (front) html += ", <span class=\"star\">★ on the front</span>";
  html += fmt::format("<br>{} ms; texture {}, both {}, energy {}, missing {}", ShortTime(variant.total_ms),
                      ShortFigure(variant.texture), ShortEstimate(variant.both), ShortEstimate(variant.energy),
                      ShortEstimate(variant.missing));
  if (!variant.options.empty()) html += "<br><code>" + EscapeHtml(variant.options) + "</code>";
  if (!variant.note.empty()) html += "<br>" + EscapeHtml(variant.note);
  return html + "</figcaption>";
}

std::string_view BytesOf(const std::vector<std::uint8_t>& data) {
  return {reinterpret_cast<const char*>(data.data()), data.size()};
}

std::string Figures(const TradeReport& report) {
  std::string html;
  const std::vector<bool> front = internal::OnFront(report);
  std::map<std::string_view, std::size_t> shown;  // by their bytes
  for (const std::size_t i : ByAxis(report)) {
    const TradeMeasure& variant = report.variants[i];
    const auto [first, is_new] = shown.try_emplace(BytesOf(variant.picture_png), i);
    const bool has_picture = !variant.picture_png.empty();
    html += fmt::format("<figure id=\"variant-{}\" class=\"variant{}\"{}>\n", i + 1, variant.chosen ? " chosen" : "",
                        has_picture && !is_new ? fmt::format(" data-same=\"{}\"", first->second + 1) : "");
    if (!has_picture) {
      html += "<p class=\"soft\">No picture was kept.</p>\n";
    } else if (!is_new) {
      html += "<p>The same picture as " + LinkTo(report, first->second) + ", byte for byte.</p>\n";
    } else {
      html +=
          fmt::format("<img loading=\"lazy\" decoding=\"async\" width=\"{}\" height=\"{}\" alt=\"{}\" src=\"{}\">\n",
                      report.width, report.height, EscapeHtml(internal::TradeTitle(report) + ", " + variant.name),
                      internal::PngAddress(std::as_bytes(std::span(variant.picture_png))));
    }
    html += Caption(report, i, front[i]) + "\n</figure>\n";
  }
  return html.empty() ? "" : "<h2>Pictures</h2>\n<div class=\"variants\">\n" + html + "</div>\n";
}

// Two pictures at full size, opened by the script.
constexpr const char* kFlip = R"(<dialog id="flip" aria-labelledby="flip-name">
<div class="bar"><span><b id="flip-name"></b> <span id="flip-words" class="soft"></span></span>
<span><button type="button" id="flip-side" aria-pressed="true">side by side</button>
<button type="button" id="flip-before" aria-label="the variant before">↑</button>
<button type="button" id="flip-next" aria-label="the next variant">↓</button>
<button type="button" id="flip-close">close</button></span></div>
<div class="stage" id="flip-stage"></div>
<p class="soft">← → or a click flip between this variant and the style as it is; ↑ ↓ go to other variants;
s shows both side by side; Esc closes.</p>
</dialog>
)";

}  // namespace

std::string TradeHtml(const TradeReport& report) {
  std::string html = internal::PageHead(internal::TradeTitle(report) + ": speed against accuracy",
                                        internal::kTradePageStyle + ChoiceStyle(report));
  html += Header(report);
  if (!report.variants.empty()) html += Charts(report) + Table(report) + Figures(report) + kFlip;
  return html + "<script>" + internal::kTradePageScript + "</script>\n</body></html>\n";
}

}  // namespace scumble
