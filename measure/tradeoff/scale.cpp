#include "measure/tradeoff/scale.h"

#include <algorithm>

namespace scumble::internal {

ChartScale ScaleFor(const std::vector<double>& values, bool logarithmic, double begin, double end) {
  ChartScale scale{logarithmic, 0.0, 1.0, begin, end};
  if (values.empty()) return scale;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  scale.low = logarithmic ? std::log10(*least) : *least;
  scale.high = logarithmic ? std::log10(*most) : *most;
  const double room =
      std::max(0.06 * (scale.high - scale.low), logarithmic ? 0.02 : std::max(1e-3 * std::abs(*most), 1e-9));
  scale.low -= room;
  scale.high += room;
  return scale;
}

std::vector<double> TicksOf(const ChartScale& scale) {
  const double low = scale.logarithmic ? std::pow(10.0, scale.low) : scale.low;
  const double high = scale.logarithmic ? std::pow(10.0, scale.high) : scale.high;
  std::vector<double> ticks;
  if (scale.logarithmic && scale.high - scale.low > 1.0) {
    for (double decade = std::floor(scale.low); decade <= scale.high; ++decade) {
      for (const double digit : {1.0, 2.0, 5.0}) ticks.push_back(digit * std::pow(10.0, decade));
    }
  } else {
    const double rough = (high - low) / 6.0, power = std::pow(10.0, std::floor(std::log10(rough)));
    const double step = power * (rough < 1.5 * power   ? 1.0
                                 : rough < 3.5 * power ? 2.0
                                 : rough < 7.5 * power ? 5.0
                                                       : 10.0);
    // Whole multiples: adding the step repeatedly would show its rounding.
    for (double k = std::ceil(low / step); k * step <= high; ++k) ticks.push_back(k * step);
  }
  std::erase_if(ticks, [&](double tick) { return tick < low || tick > high; });
  return ticks;
}

}  // namespace scumble::internal
