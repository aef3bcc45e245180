#include "measure/crosscheck/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "measure/chart_colors.h"

namespace scumble::internal {
namespace {

constexpr double kWidth = 640, kHeight = 380;
constexpr double kLeft = 64, kRight = 130, kTop = 16, kBottom = 48;

struct Axis {
  double low, high;   // log10 of the values at its ends
  double begin, end;  // in the picture
  double At(double value) const { return begin + (std::log10(value) - low) / (high - low) * (end - begin); }
};

// Whether the layer has noise to draw.
bool IsDrawn(const CrosscheckNoise& layer) { return layer.slope.has_value(); }

Axis SampleAxis(const std::vector<int>& samples) {
  return {std::log10(double(samples.front())) - 0.08, std::log10(double(samples.back())) + 0.08, kLeft,
          kWidth - kRight};
}

Axis NoiseAxis(const std::vector<const CrosscheckNoise*>& layers) {
  double low = 1e30, high = 0;
  for (const CrosscheckNoise* layer : layers) {
    for (const double value : layer->nrmse) low = std::min(low, value), high = std::max(high, value);
  }
  return {std::log10(low) - 0.15, std::log10(high) + 0.15, kHeight - kBottom, kTop};
}

std::string Grid(const Axis& x, const Axis& y, const std::vector<int>& samples) {
  std::string svg;
  for (const int count : samples) {
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" class=\"grid\"/>"
        "<text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4}</text>\n",
        x.At(count), kTop, kHeight - kBottom, kHeight - kBottom + 18, count);
  }
  for (int decade = static_cast<int>(std::floor(y.low)); decade <= static_cast<int>(std::ceil(y.high)); ++decade) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double value = digit * std::pow(10.0, decade);
      if (std::log10(value) < y.low || std::log10(value) > y.high) continue;
      svg += fmt::format(
          "<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" class=\"grid\"/>"
          "<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:g}</text>\n",
          kLeft, kWidth - kRight, y.At(value), y.At(value), kLeft - 8, y.At(value) + 4, value);
    }
  }
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">samples a pixel, both sides</text>\n",
                     (kLeft + kWidth - kRight) / 2, kHeight - 8);
  return svg + fmt::format(
                   "<text x=\"14\" y=\"{0:.1f}\" text-anchor=\"middle\" transform=\"rotate(-90 14 {0:.1f})\">"
                   "RMS difference / mean</text>\n",
                   (kTop + kHeight - kBottom) / 2);
}

// A line of slope −1/2 across the chart, through the middle of the layers' first points.
std::string Guide(const Axis& x, const Axis& y, const std::vector<const CrosscheckNoise*>& layers) {
  double logs = 0;
  for (const CrosscheckNoise* layer : layers) logs += std::log10(layer->nrmse.front());
  const std::vector<int>& samples = layers.front()->samples;
  const double start = std::pow(10.0, logs / double(layers.size())), first = samples.front(), last = samples.back();
  const double end = start * std::sqrt(first / last);
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"guide\"/>\n", x.At(first),
                     y.At(start), x.At(last), y.At(end));
}

// Heights of the names beside the lines' ends, moved apart where they would overlap.
std::vector<double> LabelHeights(const Axis& y, const std::vector<const CrosscheckNoise*>& layers) {
  constexpr double kApart = 15;
  std::vector<std::size_t> order(layers.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return layers[a]->nrmse.back() > layers[b]->nrmse.back(); });
  std::vector<double> heights(layers.size());
  double least = kTop;
  for (const std::size_t i : order) {
    heights[i] = std::max(y.At(layers[i]->nrmse.back()), least);
    least = heights[i] + kApart;
  }
  double most = kHeight - kBottom;
  for (auto i = order.rbegin(); i != order.rend(); ++i) {
    heights[*i] = std::min(heights[*i], most);
    most = heights[*i] - kApart;
  }
  return heights;
}

}  // namespace

std::string NoiseChart(const std::vector<CrosscheckNoise>& noise) {
  std::vector<const CrosscheckNoise*> layers;
  for (const CrosscheckNoise& layer : noise) {
    if (IsDrawn(layer)) layers.push_back(&layer);
  }
  if (layers.empty()) return "";
  const std::vector<int>& samples = layers.front()->samples;
  const Axis x = SampleAxis(samples), y = NoiseAxis(layers);
  std::string svg =
      fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"noise against samples\">\n", kWidth, kHeight);
  svg += Grid(x, y, samples) + Guide(x, y, layers);
  const std::vector<double> heights = LabelHeights(y, layers);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const char* color = kChartColors[i % std::size(kChartColors)];
    std::string points, dots;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const double px = x.At(samples[k]), py = y.At(layers[i]->nrmse[k]);
      points += fmt::format("{:.1f},{:.1f} ", px, py);
      dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.2\" fill=\"{}\"/>", px, py, color);
    }
    svg += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>{}\n", points, color,
                       dots);
    const double label_x = kWidth - kRight + 12;
    svg += fmt::format(
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-width=\"0.7\"/>"
        "<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\" class=\"label\">{} {:+.2f}</text>\n",
        x.At(samples.back()) + 4, y.At(layers[i]->nrmse.back()), label_x - 2, heights[i], color, label_x,
        heights[i] + 4, color, layers[i]->layer, *layers[i]->slope);
  }
  return svg + "</svg>\n";
}

}  // namespace scumble::internal
