// Strokes of a threshold texture.
#pragma once

#include <glm/glm.hpp>

#include "core/image/finish_pass.h"
#include "finish/hatch/axis.h"

namespace scumble::internal {

// A texture's rows hold so many strokes' spacings.
inline constexpr float kSpacingsOfTexture = 24.0f;

// The texture at a size, softened to keep edges of strokes from being jagged. Keeps a reference to the texture.
class TextureStrokes {
 public:
  // `spacing`: from stroke to stroke, pixels; `reference`: that of the reference height. A smaller picture looks at the
  // larger one's level, at the places in a pixel at which that does in its own, so that it has the same strokes.
  TextureStrokes(const HatchTexture& texture, double spacing, double reference);

  // How much of the pixel around `at`, in pixels along and across the strokes, is ink, where `share` of all is. The
  // mean over the texture is `share`. `along`: the strokes' axis in the picture.
  float Cover(glm::vec2 at, Axis along, float share) const;

 private:
  float Threshold(glm::vec2 texel) const;

  const HatchTexture::Level* level_;
  float texels_per_pixel_;
  int samples_;  // of a pixel, each way
};

}  // namespace scumble::internal
