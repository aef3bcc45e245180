// The percentile that exposure is measured by, against sorting.
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/image/color.h"
#include "tests/support/transfer_fixtures.h"
#include "transfer/exemplar/illumination.h"

namespace scumble {
namespace {

using namespace testing;

double Sorted(const GuideSet& guides, Layer layer) {
  std::vector<float> all;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
    float light = guides.Plane(layer)[i];
    if (ChannelCount(layer) == 3) light = Luminance(light, guides.Plane(layer, 1)[i], guides.Plane(layer, 2)[i]);
    all.push_back(light > 0.0f ? light : 0.0f);
  }
  if (all.empty()) return 0.0;
  std::sort(all.begin(), all.end());
  return all[static_cast<std::size_t>(std::ceil(0.9 * double(all.size()) - 1e-9)) - 1];
}

TEST(BrightPercentile, IsTheOneThatSortingFinds) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kOdd[] = {kInfinity, kNan, -kInfinity, -1.0f, -0.0f, 1e-45f, 3e38f};
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 1}, {1, 10}, {11, 13}, {400, 300}}) {
    for (int kind = 0; kind < 7; ++kind) {
      GuideSet guides(width, height);
      guides.Add(Layer::kCoverage), guides.Add(Layer::kLuminance), guides.Add(Layer::kLpeLDE);
      for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
        guides.Plane(Layer::kCoverage)[i] = kind == 5 ? 0.0f : kind == 6 && i > 0 ? 0.0f : float(Hash(i, kind) % 3);
        for (int c = 0; c < 4; ++c) {
          float& light = c < 3 ? guides.Plane(Layer::kLpeLDE, c)[i] : guides.Plane(Layer::kLuminance)[i];
          const float u = UnitFloat(Hash(i, kind, c));
          light = kind == 0   ? u
                  : kind == 1 ? std::exp2(60.0f * u - 30.0f)
                  : kind == 2 ? 0.7f
                  : kind == 3 ? 0.5f + 1e-6f * u
                              : u;
          if (kind == 4 && Hash(i, c) % 4 == 0) light = kOdd[Hash(i, c, 1) % std::size(kOdd)];
        }
      }
      for (const Layer layer : {Layer::kLuminance, Layer::kLpeLDE}) {
        const double expected = Sorted(guides, layer);
        for (const int threads : {1, 2, 3}) {
          tbb::task_arena arena(threads);
          const double found = arena.execute([&] { return BrightPercentile(guides, layer); });
          ASSERT_EQ(found, expected) << width << "×" << height << " kind " << kind << ", " << threads << " threads";
        }
      }
    }
  }
}

}  // namespace
}  // namespace scumble
