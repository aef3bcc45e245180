#include "measure/crosscheck_html.h"

#include <fmt/format.h>

#include <cstddef>

#include "io/picture_file.h"

namespace scumble {
namespace {

std::string Escape(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') escaped += "&amp;";
    else if (c == '<') escaped += "&lt;";
    else if (c == '>') escaped += "&gt;";
    else if (c == '"') escaped += "&quot;";
    else escaped += c;
  }
  return escaped;
}

// RFC 4648.
std::string Base64(const std::vector<std::byte>& bytes) {
  constexpr const char* kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t b = 0; b < 3; ++b) {
      word = word << 8 | (i + b < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + b]) : 0u);
    }
    for (std::size_t b = 0; b < 4; ++b) {
      text += i + b <= bytes.size() ? kAlphabet[word >> (18 - 6 * b) & 63u] : '=';
    }
  }
  return text;
}

Expected<std::string> ImageTag(const Picture& picture, const std::string& caption) {
  SCUMBLE_ASSIGN(const std::vector<std::byte> png, EncodePng(picture));
  return fmt::format("<figure><img src=\"data:image/png;base64,{}\" alt=\"{}\"><figcaption>{}</figcaption></figure>\n",
                     Base64(png), Escape(caption), Escape(caption));
}

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Scumble cross-check</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 75rem; padding: 0 1rem; color: #222; background: #faf8f4; }
h1 { font-weight: 600; } h2 { margin-top: 2.5rem; border-top: 1px solid #ddd6c8; padding-top: 1rem; }
table { border-collapse: collapse; margin: 1rem 0; } th, td { text-align: left; padding: .25rem 1.2rem .25rem 0; }
td.number { text-align: right; font-variant-numeric: tabular-nums; } tr.broken td { color: #b3261e; font-weight: 600; }
.verdict { display: inline-block; padding: .2rem .8rem; border-radius: 1rem; color: #fff; font-weight: 600; }
.agrees { background: #2e7d4f; } .differs { background: #b3261e; }
.row { display: flex; gap: .8rem; flex-wrap: wrap; } figure { margin: 0; flex: 1 1 20rem; }
img { width: 100%; border-radius: 4px; background: #e9e4da; } figcaption { color: #666; font-size: .85rem; }
code { background: #efeae0; padding: .1rem .3rem; border-radius: 3px; }
</style></head><body>
)";

std::string Verdict(bool passed) {
  return passed ? "<span class=\"verdict agrees\">agrees</span>" : "<span class=\"verdict differs\">differs</span>";
}

std::string FigureTable(const CrosscheckReport& report) {
  std::string html = "<table><tr><th>layer</th><th>figure</th><th>measured</th><th>limit</th><th></th></tr>\n";
  for (const CrosscheckFigure& figure : report.figures) {
    html += fmt::format(
        "<tr{}><td>{}</td><td>{}</td><td class=\"number\">{:.3g}</td><td class=\"number\">{:.3g}</td><td>{}</td></tr>\n",
        figure.kept() ? "" : " class=\"broken\"", Escape(figure.layer), Escape(figure.name), figure.value, figure.limit,
        Escape(figure.unit));
  }
  for (const std::string& layer : report.skipped) {
    html += fmt::format("<tr class=\"broken\"><td>{}</td><td colspan=\"4\">the reference lacks it</td></tr>\n", Escape(layer));
  }
  return html + "</table>\n";
}

}  // namespace

Expected<std::string> CrosscheckToHtml(const std::vector<CrosscheckReport>& reports, const CrosscheckRun& run) {
  bool passed = !reports.empty();
  for (const CrosscheckReport& report : reports) passed = passed && report.passed();
  std::string html = kHead;
  html += fmt::format("<h1>Scumble cross-check {}</h1>\n<p>Reference: {}. Repeat with <code>{}</code>.</p>\n", Verdict(passed),
                      Escape(run.reference), Escape(run.command));
  html += "<p>Coverage is compared over the whole picture; everything else where a pixel and its neighbours, two to each "
          "side, show one object in both.</p>\n";
  for (const CrosscheckReport& report : reports) {
    html += fmt::format("<h2>{} {}</h2>\n<p>{}×{} pixels, {} compared.</p>\n", Escape(report.scene), Verdict(report.passed()),
                        report.width, report.height, report.compared);
    html += FigureTable(report);
    for (const CrosscheckPictures& pictures : report.pictures) {
      SCUMBLE_ASSIGN(const std::string reference, ImageTag(pictures.reference, pictures.layer + ", reference"));
      SCUMBLE_ASSIGN(const std::string ours, ImageTag(pictures.ours, pictures.layer + ", ours"));
      SCUMBLE_ASSIGN(const std::string difference,
                     ImageTag(pictures.difference, pictures.layer + ", difference; yellow is " + pictures.full_scale));
      html += "<div class=\"row\">\n" + reference + ours + difference + "</div>\n";
    }
  }
  return html + "</body></html>\n";
}

}  // namespace scumble
