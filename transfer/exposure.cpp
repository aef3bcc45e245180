#include <tbb/task_arena.h>

#include "transfer/transfer.h"

namespace scumble {

std::optional<double> MeasureExposure(std::span<const PreparedStyle> styles, const GuideSet& guides, int threads) {
  std::vector<float> brightest;
  std::optional<Layer> layer;
  // Luminance first: it does not depend on materials.
  const auto measure = [&](Layer one) {
    if (!layer || one == Layer::kLuminance) layer = one;
  };
  for (const PreparedStyle& style : styles) {
    if (style.space && style.space->has_radiance()) {
      if (style.space->is_lit()) brightest.push_back(style.space->white());
      measure(style.space->radiance());
    } else if (style.illumination.active()) {
      const auto luminances = style.illumination.luminances();
      brightest.insert(brightest.end(), luminances.begin(), luminances.end());
      measure(Layer::kLuminance);
    }
  }
  if (!layer) return std::nullopt;
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  return arena.execute([&] { return MeasureExposure(guides, brightest, *layer); });
}

}  // namespace scumble
