#include "exemplars/paint/engine/patches.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scumble::paint {

Flow Turned(const Flow& flow, float angle) {
  const float c = std::cos(angle);
  const float s = std::sin(angle);
  return [flow, c, s](glm::vec2 at) {
    const glm::vec2 way = flow(at);
    return glm::vec2(c * way.x - s * way.y, s * way.x + c * way.y);
  };
}

void LayPatches(Chance& chance, const Flow& flow, const PatchOptions& options,
                const std::function<void(Stroke path, glm::vec2 patch)>& draw) {
  for (const glm::vec2 patch : SowEvenly(chance, options.spacing)) {
    const Flow turned = Turned(flow, chance.Bell(options.slant));
    const glm::vec2 along = turned(patch) / std::max(glm::length(turned(patch)), 1e-4f);
    const glm::vec2 aside(-along.y, along.x);
    const int touches = chance.Whole(options.touches_min, options.touches_max);
    const float length = chance.Uniform(options.length_min, options.length_max);
    // Touches follow one another to one side, like a hand's.
    const float side = chance.Happens(0.5f) ? 1.0f : -1.0f;
    for (int i = 0; i < touches; ++i) {
      const float across = side * (static_cast<float>(i) - 0.5f * static_cast<float>(touches - 1)) * options.apart +
                           chance.Bell(options.unevenness * options.apart);
      const float shift = chance.Bell(options.unevenness * 0.5f * length);
      const Flow bent = Turned(turned, chance.Bell(0.5f * options.unevenness));
      Stroke path = TraceStroke(bent, patch + aside * across + along * shift,
                                length * (1.0f + chance.Bell(0.8f * options.unevenness)));
      if (chance.Happens(0.5f)) std::reverse(path.begin(), path.end());
      draw(std::move(path), patch);
    }
  }
}

}  // namespace scumble::paint
