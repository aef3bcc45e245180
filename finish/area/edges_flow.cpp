#include "finish/area/edges_flow.h"

#include <tbb/blocked_range.h>
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "finish/area/gaussian_rows.h"
#include "finish/area/structure_tensor.h"

namespace scumble::internal {
namespace {

// A plane between its pixels, by bilinear interpolation; beyond its edges it goes on with its last values.
struct FlowPlane {
  const FloatPlane& values;
  int width, height;

  float At(float x, float y) const {
    x = std::clamp(x, 0.0f, static_cast<float>(width - 1)), y = std::clamp(y, 0.0f, static_cast<float>(height - 1));
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const float u = x - static_cast<float>(x0), v = y - static_cast<float>(y0);
    const std::size_t right = x0 + 1 < width ? 1 : 0, below = y0 + 1 < height ? std::size_t(width) : 0;
    const float* const at = values.data() + std::size_t(y0) * std::size_t(width) + std::size_t(x0);
    const float upper = at[0] + u * (at[right] - at[0]), lower = at[below] + u * (at[below + right] - at[below]);
    return upper + v * (lower - upper);
  }
};

EdgeFlow FlowOfTone(const FloatPlane& tone, int width, int height, double sigma) {
  StructureTensor tensor;
  for (auto* plane : {&tensor.xx, &tensor.xy, &tensor.yy}) plane->resize(tone.size());
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      const auto row = [&](int v) {
        return tone.data() + std::size_t(std::clamp(v, 0, height - 1)) * std::size_t(width);
      };
      const float *const above = row(y - 1), *const here = row(y), *const below = row(y + 1);
      for (int x = 0; x < width; ++x) {
        const float dx = here[std::min(x + 1, width - 1)] - here[std::max(x - 1, 0)], dy = below[x] - above[x];
        const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
        tensor.xx[i] = dx * dx, tensor.xy[i] = dx * dy, tensor.yy[i] = dy * dy;
      }
    }
  });
  return FlowOf(tensor, width, height, sigma);
}

// A Gaussian over the curve through a pixel, as far as the weights go.
float AlongFlow(const FlowPlane& plane, const EdgeFlow& flow, const std::vector<float>& weights, int x, int y) {
  const std::size_t here = std::size_t(y) * std::size_t(plane.width) + std::size_t(x);
  float sum = weights[0] * plane.values[here];
  for (const float sign : {1.0f, -1.0f}) {
    float at_x = static_cast<float>(x), at_y = static_cast<float>(y);
    float step_x = sign * flow.x[here], step_y = sign * flow.y[here];
    for (std::size_t k = 1; k < weights.size(); ++k) {
      at_x = std::clamp(at_x + step_x, 0.0f, static_cast<float>(plane.width - 1));
      at_y = std::clamp(at_y + step_y, 0.0f, static_cast<float>(plane.height - 1));
      sum += weights[k] * plane.At(at_x, at_y);
      const std::size_t nearest = std::size_t(at_y + 0.5f) * std::size_t(plane.width) + std::size_t(at_x + 0.5f);
      const bool turns = flow.x[nearest] * step_x + flow.y[nearest] * step_y < 0.0f;
      step_x = turns ? -flow.x[nearest] : flow.x[nearest], step_y = turns ? -flow.y[nearest] : flow.y[nearest];
    }
  }
  return sum;
}

// Calls visit(x0, x1, y0, y1) for squares of the picture, from several threads.
template <class Visit>
void ForEachSquare(int width, int height, const Visit& visit) {
  constexpr int kSide = 32;
  tbb::parallel_for(tbb::blocked_range2d<int>(0, (height + kSide - 1) / kSide, 1, 0, (width + kSide - 1) / kSide, 4),
                    [&](const auto& part) {
                      for (int row = part.rows().begin(); row != part.rows().end(); ++row) {
                        for (int column = part.cols().begin(); column != part.cols().end(); ++column)
                          visit(column * kSide, std::min(width, column * kSide + kSide), row * kSide,
                                std::min(height, row * kSide + kSide));
                      }
                    });
}

}  // namespace

FloatPlane FlowResponse(const FloatPlane& tone, int width, int height, const FlowLengths& lengths,
                        const FlowFactors& factors) {
  const EdgeFlow flow = FlowOfTone(tone, width, height, lengths.tensor_sigma);
  const std::vector<float> narrow = GaussianWeights(lengths.sigma), wide = GaussianWeights(1.6 * lengths.sigma),
                           along = GaussianWeights(lengths.along);
  std::vector<float> weights(wide.size());
  for (std::size_t k = 0; k < wide.size(); ++k)
    weights[k] = factors.wide * wide[k] + (k < narrow.size() ? factors.narrow * narrow[k] : 0.0f);
  const FlowPlane of_tone{tone, width, height};
  FloatPlane across(tone.size()), out(tone.size());
  const auto at = [&](int x, int y) { return std::size_t(y) * std::size_t(width) + std::size_t(x); };
  ForEachSquare(width, height, [&](int x0, int x1, int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        const std::size_t i = at(x, y);
        float sum = factors.level + weights[0] * tone[i];
        for (std::size_t k = 1; k < weights.size(); ++k) {
          const float off_x = static_cast<float>(k) * flow.y[i], off_y = -static_cast<float>(k) * flow.x[i];
          const auto left = static_cast<float>(x), top = static_cast<float>(y);
          sum += weights[k] * (of_tone.At(left + off_x, top + off_y) + of_tone.At(left - off_x, top - off_y));
        }
        across[i] = sum;
      }
    }
  });
  const FlowPlane of_across{across, width, height};
  const int reach = static_cast<int>(along.size());
  ForEachSquare(width, height, [&](int x0, int x1, int y0, int y1) {
    float least = std::numeric_limits<float>::infinity();
    for (int y = std::max(0, y0 - reach); y < std::min(height, y1 + reach); ++y) {
      for (int x = std::max(0, x0 - reach); x < std::min(width, x1 + reach); ++x)
        least = std::min(least, across[at(x, y)]);
    }
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x)
        out[at(x, y)] = least >= factors.enough ? across[at(x, y)] : AlongFlow(of_across, flow, along, x, y);
    }
  });
  return out;
}

}  // namespace scumble::internal
