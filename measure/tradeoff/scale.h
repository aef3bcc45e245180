// Axes of the trade-off's chart. Private to measure/tradeoff.
#pragma once

#include <cmath>
#include <string>
#include <vector>

namespace scumble::internal {

// Maps values to places in a picture, linearly or logarithmically.
struct ChartScale {
  bool logarithmic = false;
  double low = 0.0, high = 1.0;   // values at its ends; their decimal logarithms where it is logarithmic
  double begin = 0.0, end = 1.0;  // where these are
  double At(double value) const {
    return begin + ((logarithmic ? std::log10(value) : value) - low) / (high - low) * (end - begin);
  }
};

// A scale that shows all `values`, with room at both ends. No values: 0 … 1, or 1 … 10. Logarithmic: all must be above
// 0.
ChartScale ScaleFor(const std::vector<double>& values, bool logarithmic, double begin, double end);

// Round values along it, at least two where it spans any.
std::vector<double> TicksOf(const ChartScale& scale);

}  // namespace scumble::internal
