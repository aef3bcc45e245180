#include "exemplars/paint/neutral.h"

#include "core/image/color.h"

namespace scumble::paint {

Colors Neutral(Colors colors) {
  for (glm::vec3& color : colors.pixels) color = glm::vec3(Luminance(color.r, color.g, color.b));
  return colors;
}

}  // namespace scumble::paint
