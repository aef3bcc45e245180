// Time against error of every variant, as SVG.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "measure/chart_colors.h"
#include "measure/html_page.h"
#include "measure/tradeoff/pareto.h"
#include "measure/tradeoff/parts.h"
#include "measure/tradeoff/scale.h"

namespace scumble {
namespace internal {
namespace {

constexpr double kWidth = 920, kHeight = 540, kLegend = 170;
constexpr double kLeft = 64, kRight = 24, kBottom = 48;
constexpr double kLetter = 6.4, kLetterHeight = 13;  // of the labels, about

// For a chart without the page's colours.
constexpr const char* kOwnStyle =
    "<style>text { fill: #444; } .title { fill: #222; font-size: 15px; } .grid { stroke: #ddd; } "
    ".front { stroke: #222; fill: none; stroke-width: 1.6; stroke-dasharray: 6 3; } .ring { stroke: #222; fill: none; "
    "stroke-width: 1.6; } .bar { stroke: #777; stroke-width: 0.8; } .name { fill: #222; }</style>\n";

struct Point {
  std::size_t variant = 0, axis = 0;
  Quartiles time;  // or memory
  Estimate error;
  double x = 0.0, y = 0.0;
  bool front = false;
};

struct Box {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  bool Meets(const Box& o) const {
    return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height;
  }
};

struct Chart {
  std::vector<Point> points;       // in the order of the report
  std::vector<std::size_t> front;  // places in points, by rising time
  ChartScale across, up;
  double right = 0.0, top = 0.0;
};

Quartiles TimeOf(const TradeMeasure& variant, ChartTime time) {
  if (time == ChartTime::kTotal) return variant.total_ms;
  if (time == ChartTime::kTransfer) return variant.transfer_ms;
  const double megabytes = static_cast<double>(variant.memory_bytes) * 1e-6;
  return {megabytes, megabytes, megabytes};
}

Estimate ErrorOf(const TradeMeasure& variant, ChartError error) {
  constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
  if (error == ChartError::kTexture) return {variant.texture.value_or(kNotMeasured), 0.0};
  return error == ChartError::kBoth ? variant.both : error == ChartError::kEnergy ? variant.energy : variant.missing;
}

const char* TimeName(ChartTime time) {
  if (time == ChartTime::kTotal) return "time of guides and transfer, ms";
  return time == ChartTime::kTransfer ? "time of the transfer, ms" : "memory, MB";
}

const char* ErrorName(ChartError error) {
  if (error == ChartError::kTexture) return "texture";
  if (error == ChartError::kBoth) return "both: energy + missing";
  return error == ChartError::kEnergy ? "energy" : "missing";
}

std::vector<Point> PointsOf(const TradeReport& report, const ChartLook& look) {
  const std::vector<std::string> axes = AxesOf(report);
  std::vector<Point> points;
  for (std::size_t i = 0; i < report.variants.size(); ++i) {
    const TradeMeasure& variant = report.variants[i];
    const Quartiles time = TimeOf(variant, look.time);
    const Estimate error = ErrorOf(variant, look.error);
    if (!Taken(time.median) || !std::isfinite(time.median) || !std::isfinite(error.mean)) continue;
    const auto axis = std::find(axes.begin(), axes.end(), variant.axis) - axes.begin();
    points.push_back({i, static_cast<std::size_t>(axis), time, error});
  }
  return points;
}

Chart ChartOf(const TradeReport& report, const ChartLook& look) {
  Chart chart{PointsOf(report, look), {}, {}, {}, kWidth - kRight, look.page ? 16.0 : 72.0};
  if (!look.page) chart.right -= kLegend;
  std::vector<double> times, errors;
  std::vector<TradePoint> trade;
  const std::vector<bool> may = MayBeOnFront(report);
  for (const Point& point : chart.points) {
    for (const double time : {point.time.lower, point.time.median, point.time.upper}) {
      if (time > 0.0 && std::isfinite(time)) times.push_back(time);
    }
    for (const double side : {-1.0, 0.0, 1.0}) {
      const double error = point.error.mean + side * point.error.standard_error;
      if (std::isfinite(error)) errors.push_back(error);
    }
    const bool counts = look.time != ChartTime::kMemory && may[point.variant];
    trade.push_back({counts ? point.time.median : std::numeric_limits<double>::quiet_NaN(), point.error.mean});
  }
  if (look.error == ChartError::kTexture && report.texture_floor) errors.push_back(*report.texture_floor);
  chart.across = ScaleFor(times, true, kLeft, chart.right);
  chart.up = ScaleFor(errors, false, kHeight - kBottom, chart.top);
  chart.front = ParetoFront(trade, look.error == ChartError::kTexture ? ChanceOf(report).value_or(0.0) : 0.0);
  for (const std::size_t i : chart.front) chart.points[i].front = true;
  for (Point& point : chart.points) {
    point.x = chart.across.At(point.time.median);
    point.y = chart.up.At(point.error.mean);
  }
  return chart;
}

std::string Grid(const Chart& chart, const ChartLook& look) {
  const double bottom = kHeight - kBottom;
  std::string svg;
  for (const double tick : TicksOf(chart.across)) {
    const double x = chart.across.At(tick);
    svg +=
        fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" class=\"grid\"/>", x, chart.top, bottom);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:g}</text>\n", x, bottom + 17, tick);
  }
  for (const double tick : TicksOf(chart.up)) {
    const double y = chart.up.At(tick);
    svg +=
        fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" class=\"grid\"/>", kLeft, chart.right, y, y);
    // A tick that is 0 but for rounding must not read as 1e-17.
    const double shown = std::abs(tick) < 1e-9 * (chart.up.high - chart.up.low) ? 0.0 : tick;
    svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:g}</text>\n", kLeft - 8, y + 4, shown);
  }
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{} (logarithmic)</text>\n",
                     (kLeft + chart.right) / 2, kHeight - 10, TimeName(look.time));
  return svg + fmt::format(
                   "<text x=\"15\" y=\"{0:.1f}\" text-anchor=\"middle\" transform=\"rotate(-90 15 {0:.1f})\">"
                   "{1}; less is nearer to the exemplar</text>\n",
                   (chart.top + bottom) / 2, ErrorName(look.error));
}

// What halves of the exemplar differ by: no picture need be nearer.
std::string Floor(const Chart& chart, const TradeReport& report, const ChartLook& look) {
  if (look.error != ChartError::kTexture || !report.texture_floor) return "";
  const double y = chart.up.At(*report.texture_floor);
  return fmt::format(
      "<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" class=\"bar floor\"/>"
      "<text x=\"{0}\" y=\"{3:.1f}\" dx=\"6\">halves of the exemplar</text>\n",
      kLeft, chart.right, y, y - 4);
}

// Steps: between two points of the front only the cheaper one is available.
std::string FrontLine(const Chart& chart) {
  if (chart.front.empty()) return "";
  std::string path;
  for (const std::size_t i : chart.front) {
    const Point& point = chart.points[i];
    path += path.empty() ? fmt::format("M{:.1f} {:.1f}", point.x, point.y)
                         : fmt::format("H{:.1f}V{:.1f}", point.x, point.y);
  }
  return fmt::format("<path d=\"{}H{:.1f}\" class=\"front\"/>\n", path, chart.right);
}

std::string Bars(const Chart& chart, const Point& point) {
  const auto bar = [](double x1, double y1, double x2, double y2) {
    return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"bar\"/>", x1, y1, x2, y2);
  };
  std::string svg;
  if (point.time.lower > 0.0 && point.time.upper > point.time.lower && std::isfinite(point.time.upper)) {
    svg += bar(chart.across.At(point.time.lower), point.y, chart.across.At(point.time.upper), point.y);
  }
  if (point.error.standard_error > 0.0 && std::isfinite(point.error.standard_error)) {
    svg += bar(point.x, chart.up.At(point.error.mean - point.error.standard_error), point.x,
               chart.up.At(point.error.mean + point.error.standard_error));
  }
  return svg;
}

// The text for a pointer on a point.
std::string Words(const TradeMeasure& variant, bool front) {
  std::string words = variant.name + (variant.chosen ? ", the style as it is" : "") +
                      (variant.exact ? ", the exact one" : "") + (front ? ", on the front" : "");
  words +=
      "\ntime " + ShortTime(variant.total_ms) + " ms, of which the transfer " + ShortTime(variant.transfer_ms) + " ms";
  if (variant.prepare_ms > 0.0) words += "\npreparing the style " + ShortFigure(variant.prepare_ms) + " ms, once";
  if (variant.memory_bytes > 0) words += "\nmemory " + ShortMegabytes(variant.memory_bytes) + " MB";
  words += "\ntexture " + ShortFigure(variant.texture) + ", both " + ShortEstimate(variant.both) + ", energy " +
           ShortEstimate(variant.energy) + ", missing " + ShortEstimate(variant.missing);
  if (variant.guide_degrees) words += "\nguides off by " + ShortFigure(variant.guide_degrees) + "°";
  if (!variant.options.empty()) words += "\n" + variant.options;
  return words + (variant.note.empty() ? "" : "\n" + variant.note);
}

std::string PointMark(const Chart& chart, const Point& point, const TradeReport& report, bool page) {
  const TradeMeasure& variant = report.variants[point.variant];
  const std::string words = EscapeHtml(Words(variant, point.front));
  std::string svg = page ? fmt::format("<a href=\"#variant-{}\" class=\"point axis-{}\" aria-label=\"{}\">",
                                       point.variant + 1, point.axis + 1, words)
                         : "<g>";
  svg += "<title>" + words + "</title>" + Bars(chart, point) + ChartMark(point.axis, point.x, point.y);
  if (point.front)
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"8.5\" class=\"ring\"/>", point.x, point.y);
  return svg + (page ? "</a>\n" : "</g>\n");
}

bool IsNamed(const Point& point, const TradeReport& report) {
  return point.front || report.variants[point.variant].chosen || report.variants[point.variant].exact;
}

// Names beside points, where there is room for them.
std::string Names(const Chart& chart, const TradeReport& report) {
  std::vector<Box> taken;
  for (const Point& point : chart.points) taken.push_back({point.x - 5, point.y - 5, 10, 10});
  std::string svg;
  for (const Point& point : chart.points) {
    if (!IsNamed(point, report)) continue;
    const std::string& name = report.variants[point.variant].name;
    const double width = kLetter * static_cast<double>(name.size());
    for (const double far : {12.0, 24.0, 40.0, 60.0}) {
      const Box places[] = {{point.x + far, point.y - far / 2 - kLetterHeight / 2, width, kLetterHeight},
                            {point.x + far, point.y + far / 2, width, kLetterHeight},
                            {point.x - far - width, point.y + far / 2, width, kLetterHeight},
                            {point.x - far - width, point.y - far / 2 - kLetterHeight / 2, width, kLetterHeight},
                            {point.x - width / 2, point.y - far - kLetterHeight, width, kLetterHeight},
                            {point.x - width / 2, point.y + far, width, kLetterHeight}};
      const auto free = std::find_if(std::begin(places), std::end(places), [&](const Box& box) {
        if (box.x < kLeft || box.x + width > chart.right) return false;
        if (box.y < chart.top || box.y + kLetterHeight > kHeight - kBottom) return false;
        return std::none_of(taken.begin(), taken.end(), [&box](const Box& other) { return box.Meets(other); });
      });
      if (free == std::end(places)) continue;
      taken.push_back(*free);
      const double near_x = std::clamp(point.x, free->x, free->x + width);
      const double near_y = std::clamp(point.y, free->y + 2, free->y + kLetterHeight - 2);
      svg += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"bar axis-{}\"/>",
                         point.x, point.y, near_x, near_y, point.axis + 1);
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"name axis-{}\">{}</text>\n", free->x,
                         free->y + kLetterHeight - 3, point.axis + 1, EscapeHtml(name));
      break;
    }
  }
  return svg;
}

std::string Legend(const TradeReport& report, const Chart& chart) {
  const std::vector<std::string> axes = AxesOf(report);
  std::string svg;
  double y = chart.top + 8;
  const double x = chart.right + 26;
  for (std::size_t axis = 0; axis < axes.size(); ++axis, y += 19) {
    svg += ChartMark(axis, x, y);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + 14, y + 4, EscapeHtml(axes[axis]));
  }
  svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"8.5\" class=\"ring\"/>", x, y + 4);
  return svg + fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">on the front</text>\n", x + 14, y + 8);
}

}  // namespace

std::string ChartMark(std::size_t axis, double x, double y) {
  const char* color = kChartColors[axis % std::size(kChartColors)];
  // 7 shapes and 6 colours: 42 marks before one repeats.
  constexpr const char* kShapes[] = {"M-4.5 0A4.5 4.5 0 1 0 4.5 0A4.5 4.5 0 1 0 -4.5 0Z",
                                     "M-4 -4H4V4H-4Z",
                                     "M0 -5L5 4H-5Z",
                                     "M0 -5.5L5.5 0L0 5.5L-5.5 0Z",
                                     "M0 5L5 -4H-5Z",
                                     "M-1.7 -5H1.7V-1.7H5V1.7H1.7V5H-1.7V1.7H-5V-1.7H-1.7Z",
                                     "M-5 -3L-3 -5L0 -2L3 -5L5 -3L2 0L5 3L3 5L0 2L-3 5L-5 3L-2 0Z"};
  return fmt::format("<path d=\"{}\" transform=\"translate({:.1f} {:.1f})\" fill=\"{}\"/>",
                     kShapes[axis % std::size(kShapes)], x, y, color);
}

std::string DrawTradeChart(const TradeReport& report, const ChartLook& look) {
  const Chart chart = ChartOf(report, look);
  std::string svg = fmt::format("<svg {}viewBox=\"0 0 {} {}\"",
                                look.page ? "" : "xmlns=\"http://www.w3.org/2000/svg\" ", kWidth, kHeight);
  if (look.page) {
    svg +=
        fmt::format(" class=\"chart\" role=\"group\" aria-label=\"{} against {}; the table has the same figures\">\n",
                    TimeName(look.time), ErrorName(look.error));
  } else {
    svg += " font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
    svg += kOwnStyle;
    svg += fmt::format("<text x=\"{}\" y=\"28\" class=\"title\">{}</text><text x=\"{}\" y=\"48\">{}</text>\n", kLeft,
                       EscapeHtml(TradeTitle(report)), kLeft, EscapeHtml(TradeSetup(report)));
  }
  svg += Grid(chart, look) + Floor(chart, report, look) + FrontLine(chart);
  // Points of the front lie above the others.
  for (const bool front : {false, true}) {
    for (const Point& point : chart.points) {
      if (point.front == front) svg += PointMark(chart, point, report, look.page);
    }
  }
  svg += Names(chart, report);
  if (!look.page) svg += Legend(report, chart);
  return svg + "</svg>\n";
}

}  // namespace internal

std::string TradeChart(const TradeReport& report) { return internal::DrawTradeChart(report, {}); }

}  // namespace scumble
