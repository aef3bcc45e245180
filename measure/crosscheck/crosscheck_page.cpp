#include "measure/crosscheck_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/io/picture_file.h"
#include "measure/crosscheck/chart.h"
#include "measure/crosscheck/parts.h"
#include "measure/html_page.h"

namespace scumble {
namespace {

using internal::EscapeHtml;

Expected<std::string> ImageTag(const Picture& picture, const std::string& caption) {
  SCUMBLE_ASSIGN(const std::vector<std::byte> png, EncodePng(picture));
  return fmt::format("<figure><img loading=\"lazy\" src=\"{}\" alt=\"{}\"><figcaption>{}</figcaption></figure>\n",
                     internal::PngAddress(png), EscapeHtml(caption), EscapeHtml(caption));
}

constexpr const char* kStyle = R"(
tr.broken td { color: var(--bad); font-weight: 600; } td.first { font-weight: 600; } td.again { color: transparent; }
.verdict { display: inline-block; padding: .1rem .7rem; border-radius: 1rem; font-size: .85em; font-weight: 600;
  border: 1.5px solid; }
.agrees { color: var(--good); } .differs { color: var(--bad); } .unproved { color: var(--warn); }
.scale { height: .6rem; border-radius: 3px; margin-top: .4rem; border: 1px solid var(--line); }
.labels { display: flex; justify-content: space-between; color: var(--soft); font-size: .78rem; }
.fails { background: var(--badground); border-left: 4px solid var(--bad); padding: .4rem 1rem; margin: .6rem 0; }
td.state { white-space: nowrap; }
.row { display: grid; grid-template-columns: repeat(3, 1fr); gap: .8rem; } figure { margin: 0; }
svg { max-width: 44rem; width: 100%; font: 12px system-ui, sans-serif; } svg text { fill: var(--soft); }
svg text.label { fill: revert-layer; }
svg .grid { stroke: var(--line); } svg .guide { stroke: var(--soft); stroke-dasharray: 5 5; stroke-width: 1.4; }
)";

// With a mark, because not every viewer separates the colours.
std::string Badge(CrosscheckOutcome outcome) {
  const char* kind = outcome == CrosscheckOutcome::kAgrees      ? "agrees\">✓"
                     : outcome == CrosscheckOutcome::kNotProved ? "unproved\">?"
                                                                : "differs\">✗";
  return fmt::format("<span class=\"verdict {} {}</span>", kind, OutcomeName(outcome));
}

// The worst of all scenes.
CrosscheckOutcome OutcomeOf(const std::vector<CrosscheckReport>& reports) {
  CrosscheckOutcome worst = reports.empty() ? CrosscheckOutcome::kNotCompared : CrosscheckOutcome::kAgrees;
  for (const CrosscheckReport& report : reports) worst = std::max(worst, report.Outcome());
  return worst;
}

std::string Anchor(std::size_t index) { return fmt::format("scene{}", index + 1); }

// The figure nearest to its limit, or farthest beyond it: the most important one of the summary.
const CrosscheckFigure* Tightest(const CrosscheckReport& report) {
  const CrosscheckFigure* tightest = nullptr;
  double most = -1.0;
  for (const CrosscheckFigure& figure : report.figures) {
    const double limit = figure.LimitInForce();
    const double share = !figure.kept() ? HUGE_VAL : limit > 0.0 ? figure.value / limit : 0.0;
    if (share > most) most = share, tightest = &figure;
  }
  return tightest;
}

std::string Summary(const std::vector<CrosscheckReport>& reports) {
  std::string html =
      "<section><table><tr><th>scene</th><th>verdict</th><th class=\"number\">pixels</th><th class=\"number\">"
      "samples</th><th>nearest to its limit</th><th class=\"number\">measured</th><th class=\"number\">limit</th>"
      "<th></th></tr>\n";
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const CrosscheckReport& report = reports[i];
    html += fmt::format(
        "<tr><td class=\"first\"><a href=\"#{}\">{}</a></td><td>{}</td><td class=\"number\">{}</td>"
        "<td class=\"number\">{}</td>",
        Anchor(i), EscapeHtml(report.scene), Badge(report.Outcome()), report.compared,
        report.setup.samples > 0 ? std::to_string(report.setup.samples) : "data only");
    if (const CrosscheckFigure* figure = Tightest(report)) {
      html += fmt::format("<td>{} {}</td><td class=\"number\">{:.3g}</td><td class=\"number\">{:.3g}</td><td>{}</td>",
                          EscapeHtml(figure->layer), EscapeHtml(figure->name), figure->value, figure->LimitInForce(),
                          EscapeHtml(figure->unit));
    }
    html += "</tr>\n";
  }
  return html + "</table></section>\n";
}

std::string FigureTable(const CrosscheckReport& report) {
  std::string html =
      "<table><tr><th>layer</th><th>figure</th><th class=\"number\">measured</th><th class=\"number\">± error</th>"
      "<th class=\"number\">limit</th><th></th><th></th><th></th></tr>\n";
  std::string above;
  for (const CrosscheckFigure& figure : report.figures) {
    std::string remark = figure.note;
    const auto add = [&remark](const std::string& text) { remark += (remark.empty() ? "" : "; ") + text; };
    if (figure.TooNoisy()) add("raise --samples");
    if (figure.TightenedByBaseline()) add(fmt::format("limit from the baseline; built in {:.3g}", figure.limit));
    html += fmt::format(
        "<tr{}><td class=\"{}\">{}</td><td>{}</td><td class=\"number\">{:.3g}</td><td class=\"number\">{}</td>"
        "<td class=\"number\">{:.3g}</td><td>{}</td><td class=\"state\">{}</td><td class=\"soft\">{}</td></tr>\n",
        figure.kept() ? "" : " class=\"broken\"", figure.layer == above ? "again" : "first", EscapeHtml(figure.layer),
        EscapeHtml(figure.name), figure.value, figure.error > 0.0 ? fmt::format("{:.2g}", figure.error) : "",
        figure.LimitInForce(), EscapeHtml(figure.unit),
        figure.Unjudged()   ? "– not judged"
        : figure.kept()     ? "✓ kept"
        : figure.TooNoisy() ? "? too noisy"
                            : "✗ broken",
        EscapeHtml(remark));
    above = figure.layer;
  }
  return html + "</table>\n";
}

std::string NoiseTable(const std::vector<CrosscheckNoise>& noise) {
  const CrosscheckNoise* measured = nullptr;
  for (const CrosscheckNoise& layer : noise) {
    if (!layer.no_such_light) measured = &layer;
  }
  if (!measured) return "";
  std::string html = "<table><tr><th>layer</th>";
  for (const int count : measured->samples)
    html += "<th class=\"number\">" + internal::Counted(count, "sample") + "</th>";
  html += "<th class=\"number\">slope</th><th>largest difference of a pixel</th></tr>\n";
  for (const CrosscheckNoise& layer : noise) {
    html += "<tr><td class=\"first\">" + EscapeHtml(layer.layer) + "</td>";
    if (layer.no_such_light) {
      html += fmt::format("<td class=\"soft\" colspan=\"{}\">no such light</td></tr>\n", measured->samples.size() + 2);
      continue;
    }
    for (const double value : layer.nrmse) html += fmt::format("<td class=\"number\">{:.3g}</td>", value);
    html += "<td class=\"number\">" + (layer.slope           ? fmt::format("{:+.2f}", *layer.slope)
                                       : layer.free_of_noise ? "free of noise"
                                                             : "–");
    html += fmt::format("</td><td>{:.3g} at ({}, {}): {:.4g} against {:.4g}</td></tr>\n", layer.worst, layer.worst_x,
                        layer.worst_y, layer.worst_ours, layer.worst_reference);
  }
  return html + "</table>\n";
}

std::string NoisePart(const CrosscheckReport& report) {
  const std::string table = NoiseTable(report.noise);
  if (table.empty()) return "";
  return "<h3>Noise against samples</h3>\n<p class=\"soft\">Root mean square difference of the pixels over the "
         "reference's mean: both "
         "sides' noise, and what they really disagree about, which no sample count takes away. The dashed line falls "
         "as "
         "1/√samples.</p>\n<section>" +
         table + internal::NoiseChart(report.noise) + "</section>\n";
}

std::string List(const std::vector<std::string>& lines) {
  std::string html = "<ul>";
  for (const std::string& line : lines) html += "<li>" + EscapeHtml(line) + "</li>";
  return html + "</ul>\n";
}

std::string SetupLine(const CrosscheckReport& report) {
  const CrosscheckSetup& setup = report.setup;
  std::string line = fmt::format("{}×{} pixels, {} compared", setup.width, setup.height, report.compared);
  if (!setup.camera.empty()) line += ", camera " + EscapeHtml(setup.camera);
  if (setup.frame) line += fmt::format(", frame {}", *setup.frame);
  if (!setup.blender_scene.empty()) line += ", scene " + EscapeHtml(setup.blender_scene);
  if (!setup.view_layer.empty()) line += ", view layer " + EscapeHtml(setup.view_layer);
  if (setup.samples == 0) return line + "; data layers alone, light was not compared";
  return line + fmt::format("; light with {} and {}, {}", internal::Counted(setup.samples, "sample"),
                            internal::Counted(setup.max_bounces, "bounce"),
                            report.glossy ? "some of it specular" : "nothing specular in view");
}

std::string ColorScale(const CrosscheckPictures& pictures) {
  if (pictures.scale_colors.empty()) return "";
  std::string colors, labels;
  for (const std::string& color : pictures.scale_colors) colors += ", " + color;
  for (const std::string& label : pictures.scale_labels) labels += "<span>" + EscapeHtml(label) + "</span>";
  return "<div class=\"scale\" style=\"background: linear-gradient(to right" + colors +
         ")\"></div><div class=\"labels\">" + labels + "</div>";
}

Expected<std::string> PictureRows(const CrosscheckReport& report) {
  std::string html;
  for (const CrosscheckPictures& pictures : report.pictures) {
    SCUMBLE_ASSIGN(const std::string reference, ImageTag(pictures.reference, "reference"));
    SCUMBLE_ASSIGN(const std::string ours, ImageTag(pictures.ours, "ours"));
    SCUMBLE_ASSIGN(const std::string difference, ImageTag(pictures.difference, "difference; " + pictures.full_scale));
    html += "<h3>" + EscapeHtml(pictures.layer);
    if (!pictures.look.empty())
      html += " <span class=\"soft\" style=\"font-weight:400\">" + EscapeHtml(pictures.look) + "</span>";
    html += "</h3>\n<div class=\"row\">\n" + reference + ours + "<div>" + difference + ColorScale(pictures) +
            "</div></div>\n";
  }
  return html;
}

}  // namespace

Expected<std::string> CrosscheckToHtml(const std::vector<CrosscheckReport>& reports, const CrosscheckRun& run) {
  std::string html = internal::PageHead("Scumble cross-check", kStyle);
  html +=
      fmt::format("<h1>Scumble cross-check {}</h1>\n<p>Reference: {}. Repeat with <code>{}</code>.{}</p>\n",
                  Badge(OutcomeOf(reports)), EscapeHtml(run.reference), EscapeHtml(run.command),
                  run.baseline.empty() ? "" : " Limits tightened by <code>" + EscapeHtml(run.baseline) + "</code>.");
  html +=
      "<p class=\"soft\">Coverage is compared over the whole picture; everything else where a pixel and its "
      "neighbours, two to "
      "each side, show one object in both. Light layers: relative difference of the mean.</p>\n";
  html += Summary(reports);
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const CrosscheckReport& report = reports[i];
    html += fmt::format("<h2 id=\"{}\">{} {}</h2>\n", Anchor(i), EscapeHtml(report.scene), Badge(report.Outcome()));
    if (!report.failure.empty()) {
      html += "<div class=\"fails\"><b>It could not be compared</b>" + List({report.failure}) + "</div>\n";
      continue;
    }
    html += fmt::format("<p class=\"soft\">{}.</p>\n", SetupLine(report));
    if (!report.passed()) html += "<p><b>Verdict:</b> " + EscapeHtml(CrosscheckVerdict(report)) + ".</p>\n";
    if (!report.unsupported.empty()) html += "<h3>Not expressed</h3>\n" + List(report.unsupported);
    const std::vector<std::string> reasons = WhyCrosscheckFails(report);
    if (!reasons.empty()) {
      const bool differs = report.Outcome() == CrosscheckOutcome::kDiffers;
      html += fmt::format("<div class=\"fails\"><b>Why it {}</b>", differs ? "differs" : "is not proved") +
              List(reasons) + "</div>\n";
    }
    if (!report.baseline_mismatch.empty()) {
      html += "<p>Judged by the built-in limits alone: " + EscapeHtml(report.baseline_mismatch) + ".</p>\n";
    }
    html += "<section>" + FigureTable(report) + "</section>\n";
    if (!report.warnings.empty()) html += "<h3>Not compared as authored</h3>\n" + List(report.warnings);
    html += NoisePart(report);
    SCUMBLE_ASSIGN(const std::string pictures, PictureRows(report));
    html += pictures;
  }
  return html + "</body></html>\n";
}

}  // namespace scumble
