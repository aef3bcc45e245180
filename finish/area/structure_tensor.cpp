#include "finish/area/structure_tensor.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "finish/area/gaussian_rows.h"

namespace scumble::internal {

EdgeFlow FlowOf(const StructureTensor& tensor, int width, int height, double sigma) {
  const FloatPlane xx = Blurred(tensor.xx, width, height, sigma), xy = Blurred(tensor.xy, width, height, sigma),
                   yy = Blurred(tensor.yy, width, height, sigma);
  EdgeFlow flow;
  for (auto* plane : {&flow.x, &flow.y, &flow.anisotropy}) {
    plane->resize(xx.size() + kFlowSpare);
    std::fill(plane->end() - kFlowSpare, plane->end(), 0.0f);
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, xx.size(), 1 << 14), [&](const auto& part) {
    for (std::size_t i = part.begin(); i != part.end(); ++i) {
      const float difference = xx[i] - yy[i], sum = xx[i] + yy[i];
      const float root = std::sqrt(difference * difference + 4.0f * xy[i] * xy[i]);
      // The eigenvector across the edge, from the row of the matrix in which no digits cancel.
      const float along_x = difference >= 0.0f ? difference + root : 2.0f * xy[i],
                  along_y = difference >= 0.0f ? 2.0f * xy[i] : root - difference;
      const float length = std::sqrt(along_x * along_x + along_y * along_y);
      const bool has_one = length > 0.0f;
      flow.x[i] = has_one ? -along_y / length : 0.0f;
      flow.y[i] = has_one ? along_x / length : 1.0f;
      flow.anisotropy[i] = has_one && sum > 0.0f ? std::min(1.0f, root / sum) : 0.0f;
    }
  });
  return flow;
}

}  // namespace scumble::internal
