#include "transfer/shadow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "image/color.h"
#include "image/hash.h"
#include "transfer/style_map.h"

namespace scumble {

DarkPlace DarkestPlace(const PreparedExemplar& exemplar) {
  const auto luminance = [](const std::uint16_t* texel) {
    return Luminance(Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2]));
  };
  const int reach = std::max(1, std::min(exemplar.width(), exemplar.height()) / 16), step = std::max(1, reach / 4);
  std::optional<DarkPlace> darkest;
  double least = std::numeric_limits<double>::infinity();
  for (int e = 0; e < exemplar.count(); ++e) {
    for (int y = reach; y < exemplar.height() - reach; y += step) {
      for (int x = reach; x < exemplar.width() - reach; x += step) {
        double sum = 0.0, weight = 0.0;
        bool inside = true;
        for (int v = y - reach; v <= y + reach && inside; v += step) {
          for (int u = x - reach; u <= x + reach && inside; u += step) {
            inside = exemplar.Usable(u, v);
            const std::uint16_t* texel = exemplar.picture(e).At(u, v);
            sum += static_cast<double>(texel[3]) * luminance(texel);
            weight += texel[3];
          }
        }
        if (inside && weight > 0.0 && sum / weight < least) least = sum / weight, darkest = {{x, y}, e, reach};
      }
    }
  }
  if (darkest) return *darkest;
  // Nowhere room for the square: one dark pixel.
  const std::vector<Source> usable = exemplar.UsablePixels();
  DarkPlace pixel{usable.front(), 0, 0};
  for (int e = 0; e < exemplar.count(); ++e) {
    for (const Source& source : usable) {
      const std::uint16_t* texel = exemplar.picture(e).At(source.x, source.y);
      if (texel[3] > 0 && luminance(texel) < least) least = luminance(texel), pixel = {source, e, 0};
    }
  }
  return pixel;
}

}  // namespace scumble

namespace scumble::internal {

bool PaintShadows(const ShadowInput& input, Picture& out, RowProgress& progress) {
  const auto shadow = input.guides.Plane(Layer::kShadow), coverage = input.guides.Plane(Layer::kCoverage);
  // Pieces half as wide as the dark place, so that they have room to start elsewhere in it.
  const int reach = input.dark.reach;
  const int level = std::clamp(static_cast<int>(std::floor(std::log2(std::max(1.0, 0.5 * reach)))), 0, 15);
  const SeedGrid seeds(input.seeds, level, input.region);
  return ForEachRow(input.region, progress, [&](int y) {
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      const std::size_t i = input.guides.Index(x, y);
      if (input.style[i] != StyleMap::kCatch || !(coverage[i] > 0.0f) || !(shadow[i] > 0.0f)) continue;
      const PixelPosition q = seeds.Position(seeds.Nearest(x, y));
      const std::uint64_t hash = Hash(input.seeds.seed, input.seeds.time_step, q.x, q.y, 0x5d);
      const auto spread = [&](std::uint64_t bits) { return static_cast<int>(bits % std::uint64_t(reach + 1)) - reach / 2; };
      Source source{input.dark.center.x + spread(hash) + x - q.x, input.dark.center.y + spread(Mix64(hash)) + y - q.y};
      if (!input.exemplar.Usable(source.x, source.y)) source = input.dark.center;
      const std::uint16_t* texel = input.exemplar.picture(input.dark.exemplar).At(source.x, source.y);
      std::uint16_t* pixel = out.At(x, y);
      std::copy_n(texel, 3, pixel);
      pixel[3] = static_cast<std::uint16_t>(static_cast<float>(texel[3]) * std::min(shadow[i], 1.0f) + 0.5f);
    }
  });
}

}  // namespace scumble::internal
