// A plane of numbers under a Gaussian.
#pragma once

#include <vector>

namespace scumble {

// `plane` holds width × height values in row order. `sigma` is the standard deviation in pixels; 0 or below returns the
// plane as it is. Values outside the plane have no weight. O(pixels · sigma).
std::vector<float> GaussianBlur(const std::vector<float>& plane, int width, int height, double sigma);

}  // namespace scumble
