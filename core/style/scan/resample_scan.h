// Pixels of a scan laid onto the template's grid.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "scumble/picture.h"

namespace scumble {

// Linear light, three values a pixel, rows from the top.
struct LinearPicture {
  int width = 0;
  int height = 0;
  std::vector<float> rgb;
};

// `place` maps a point of the new picture (pixel i covers [i, i + 1)) to the scan; neighbouring pixels lie at most
// `shrink` scan pixels apart. Where the scan is finer, it is read at ceil(shrink)² points a pixel (Catmull and Rom's
// cubic). These are weighted by Lanczos's window of two lobes, along rows and then along columns, so that the paper's
// grain makes no moiré. Where it is coarser, the cubic alone. Beyond the scan its border is repeated. All in linear
// light. Needs shrink > 0. Alpha is ignored.
LinearPicture ResampleScan(const Picture& scan, int width, int height, double shrink,
                           const std::function<glm::dvec2(glm::dvec2)>& place);

}  // namespace scumble
