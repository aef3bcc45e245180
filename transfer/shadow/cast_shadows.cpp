#include "transfer/shadow/cast_shadows.h"

#include <algorithm>
#include <cmath>

#include "core/image/hash.h"
#include "transfer/style_map.h"

namespace scumble::internal {
namespace {

constexpr float kBinomial[5] = {1.0f, 4.0f, 6.0f, 4.0f, 1.0f};

struct Strength {
  float strongest = 0.0f, mean = 0.0f;
};

bool Catches(const ShadowInput& input, std::size_t i) {
  return input.style[i] == StyleMap::kShadowCatcher && input.guides.Plane(Layer::kCoverage)[i] > 0.0f;
}

Strength StrengthAt(const ShadowInput& input, int x, int y) {
  const GuideSet& guides = input.guides;
  const auto shadow = guides.Plane(Layer::kShadow);
  Strength strength;
  float weights = 0.0f;
  for (int v = std::max(0, y - 2); v <= std::min(guides.height() - 1, y + 2); ++v) {
    for (int u = std::max(0, x - 2); u <= std::min(guides.width() - 1, x + 2); ++u) {
      const std::size_t i = guides.Index(u, v);
      if (!Catches(input, i)) continue;
      const float value = shadow[i] > 0.0f ? std::min(shadow[i], 1.0f) : 0.0f;
      const float weight = kBinomial[u - x + 2] * kBinomial[v - y + 2];
      strength.strongest = std::max(strength.strongest, value);
      strength.mean += weight * value, weights += weight;
    }
  }
  if (weights > 0.0f) strength.mean /= weights;
  return strength;
}

}  // namespace

void ShadowPainter::Paint(int x, int y, std::uint16_t* texel) const {
  const Strength strength = StrengthAt(input_, x, y);
  if (!(strength.strongest > 0.0f)) return;
  const int level = input_.paint.level();
  const PixelPosition q = seeds_.Position(seeds_.Nearest(x, y));
  // The cell and not the position: a preview of half the size has equal cells.
  const std::uint64_t hash = Hash(input_.seeds.seed, input_.seeds.time_step, level + input_.seeds.level_offset,
                                  q.x >> level, q.y >> level, 0x5d);
  const int step =
      std::min(ShadowPaint::kSteps, static_cast<int>(strength.strongest * ShadowPaint::kSteps + UnitFloat(hash)));
  if (step == 0) return;
  input_.paint.Sample(input_.paint.PlaceFor(step, Mix64(hash)), x - q.x, y - q.y, step, texel);
  const float share = std::min(1.0f, strength.mean / strength.strongest);
  texel[3] = static_cast<std::uint16_t>(static_cast<float>(texel[3]) * share + 0.5f);
}

bool PaintShadows(const ShadowInput& input, Picture& out, RowProgress& progress) {
  const ShadowPainter painter(input);
  return ForEachRow(input.region, progress, [&](int y) {
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      if (Catches(input, input.guides.Index(x, y))) painter.Paint(x, y, out.At(x, y));
    }
  });
}

}  // namespace scumble::internal
