// Gaussians of planes for filters: by several threads, in floats, with the same bytes on any instruction set.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "finish/area/float_plane.h"

namespace scumble::internal {

// At 0, 1, … up to three sigma; with the other side they sum to 1.
std::vector<float> GaussianWeights(double sigma);

// out[i] = weights[0] rows[r][i] + Σ weights[k] (rows[r - k][i] + rows[r + k][i]), r = weights.size() - 1, for `count`
// values. `rows` holds 2 r + 1 of them.
void SumSymmetric(std::span<const float> weights, const float* const* rows, std::size_t count, float* out);

// Rows, then columns. Beyond its edges the plane goes on with its last values. `sigma` is above 0. O(pixels · sigma).
FloatPlane Blurred(const FloatPlane& plane, int width, int height, double sigma);

// The mean of places of equal keys alone, by Gaussian weights. A place's window is its column as far as three sigma
// reach, and, of each place there with its key, the row likewise. Nothing lies beyond the plane's edges. NaN is equal
// to no key: such a place keeps its value. O(pixels · sigma), however many keys there are.
FloatPlane BlurredWithin(const FloatPlane& plane, std::span<const float> keys, int width, int height, double sigma);

// Calls row(y, values) for each row, from several threads, with its `width` values of level + narrow · G(sigma) +
// wide · G(1.6 sigma), which hold until it returns.
void ForEachGaussianPair(const FloatPlane& plane, int width, int height, double sigma, float narrow, float wide,
                         float level, const std::function<void(int y, const float* values)>& row);

}  // namespace scumble::internal
