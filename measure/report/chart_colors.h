// Colours of what charts show side by side.
#pragma once

namespace scumble::internal {

// Okabe and Ito's, of middling lightness: they stand on white and on black, and apart for every eye.
inline constexpr const char* kChartColors[] = {"#e69f00", "#0a9ad6", "#009e73", "#d55e00", "#cc79a7", "#7a7ad6"};

}  // namespace scumble::internal
