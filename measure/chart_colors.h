// Colours of the series in charts.
#pragma once

namespace scumble::internal {

// Okabe and Ito's, of medium lightness: readable on white and on black, and distinct for every viewer.
inline constexpr const char* kChartColors[] = {"#e69f00", "#0a9ad6", "#009e73", "#d55e00", "#cc79a7", "#7a7ad6"};

}  // namespace scumble::internal
