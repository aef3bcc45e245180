#include <algorithm>

#include "core/image/color.h"
#include "core/image/exact_math.h"
#include "core/image/oklab.h"
#include "finish/tone/point_effect.h"

namespace scumble::internal {

// Reinhard, Stark, Shirley, Ferwerda, "Photographic Tone Reproduction for Digital Images", 2002, equation 4: luminance
// L becomes L (1 + L / white²) / (1 + L).
PointEffect MakeRender(const RenderPass& pass, const FinishFrame& frame) {
  constexpr double kBright = 0.8;  // of the brightest tenth, before the curve
  const GuideSet& guides = *frame.guides;
  const auto scale = static_cast<float>(kBright / frame.measures.full * Exp2(pass.exposure));
  const auto per_white = static_cast<float>(1.0 / (pass.white * pass.white));
  return [=, &guides](std::size_t first, std::size_t count, OklabBlock& block) {
    for (std::size_t i = 0; i < count; ++i) {
      const glm::vec3 color = glm::max(guides.Vec3(Layer::kLpeFull, first + i) * scale, 0.0f);
      const float light = Luminance(color.r, color.g, color.b);
      const float factor = (1.0f + light * per_white) / (1.0f + light);
      const glm::vec3 lab = OklabFromLinear(glm::min(color * factor, 1.0f));
      block.lightness[i] = lab.x, block.a[i] = lab.y, block.b[i] = lab.z;
    }
  };
}

}  // namespace scumble::internal
