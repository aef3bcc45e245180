// The cross-check's chart: noise against samples.
#pragma once

#include <string>
#include <vector>

#include "measure/crosscheck.h"

namespace scumble::internal {

// An inline SVG, both axes logarithmic, one line a layer with its name beside it, and a dashed guide that falls as
// 1/√samples. Lines take the page's own text colour into account. Empty where no layer has noise at two sample counts.
std::string NoiseChart(const std::vector<CrosscheckNoise>& noise);

}  // namespace scumble::internal
