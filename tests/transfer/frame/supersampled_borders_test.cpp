// The borders of painted pictures against the 4 × 4 supersampled picture of the source field that the run itself
// matched. The picture of reference knows nothing of fragments: the scene is cast once more at four times the size for
// the surface of every subsample, and each surface has in a pixel the colour of the pixel whose centre shows it, the
// pixel itself or else the nearest of the eight around. The 16 colours are averaged in linear light, where pictures are
// composited.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/style/style_file.h"
#include "guidegen/load/load_scene.h"
#include "guidegen/scene/framing.h"
#include "tests/support/fragment_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

constexpr int kWidth = 320, kHeight = 240;

GuideSet StillLifeAt(int scale, int aa, const LayerSet& layers) {
  auto scene = LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/stilllife.glb");
  EXPECT_TRUE(scene.ok());
  const auto view = PrepareView(*scene, "", std::nullopt, double(kWidth) / kHeight, true);
  EXPECT_TRUE(view.ok());
  GuidegenOptions options = Sized(kWidth * scale, kHeight * scale, layers);
  options.aa = aa;
  return Render(*scene, view->camera, options).guides;
}

using Surface = std::pair<float, float>;  // object and material

Surface SurfaceAt(const GuideSet& guides, int x, int y) {
  const std::size_t i = guides.Index(x, y);
  return {guides.Plane(Layer::kObject)[i], guides.Plane(Layer::kMaterial)[i]};
}

// The pixel whose colour a surface has in pixel (x, y), where its subsamples lie around (at_x, at_y).
std::optional<std::pair<int, int>> ColourOf(const Surface& surface, const GuideSet& guides, int x, int y, double at_x,
                                            double at_y) {
  if (SurfaceAt(guides, x, y) == surface) return std::pair(x, y);
  std::optional<std::pair<int, int>> nearest;
  double least = 0.0;
  for (int v = std::max(0, y - 1); v <= std::min(guides.height() - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(guides.width() - 1, x + 1); ++u) {
      const double off = std::hypot(u + 0.5 - at_x, v + 0.5 - at_y);
      if (SurfaceAt(guides, u, v) != surface || (nearest && off >= least)) continue;
      nearest = {u, v}, least = off;
    }
  }
  return nearest;
}

struct Reference {
  Picture picture;         // outside of the band that of the run
  std::vector<bool> band;  // pixels of two surfaces or more, all of which have a colour
  int unknown = 0;         // pixels of a surface that no centre around shows
};

Reference ReferenceOf(const GuideSet& guides, const GuideSet& fine, const Picture& steps, const Picture& painted) {
  Reference reference{painted, std::vector<bool>(guides.pixel_count()), 0};
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      std::map<Surface, std::array<double, 3>> seen;  // the number of subsamples, and sums of their places
      bool covered = true;
      for (int v = y * kAa; v < (y + 1) * kAa; ++v) {
        for (int u = x * kAa; u < (x + 1) * kAa; ++u) {
          covered = covered && fine.Plane(Layer::kCoverage)[fine.Index(u, v)] > 0.0f;
          std::array<double, 3>& sums = seen[SurfaceAt(fine, u, v)];
          sums[0] += 1.0, sums[1] += (u + 0.5) / kAa, sums[2] += (v + 0.5) / kAa;
        }
      }
      if (!covered || seen.size() < 2) continue;
      double color[3] = {};
      bool is_known = true;
      for (const auto& [surface, sums] : seen) {
        const auto from = ColourOf(surface, guides, x, y, sums[1] / sums[0], sums[2] / sums[0]);
        is_known = is_known && from.has_value();
        if (!from) continue;
        const std::uint16_t* texel = steps.At(from->first, from->second);
        for (int c = 0; c < 3; ++c) color[c] += sums[0] / (kAa * kAa) * Srgb16ToLinear(texel[c]);
      }
      reference.unknown += !is_known;
      if (!is_known) continue;
      reference.band[guides.Index(x, y)] = true;
      for (int c = 0; c < 3; ++c) reference.picture.At(x, y)[c] = Srgb16FromLinear(float(color[c]));
    }
  }
  return reference;
}

double MeanOfBand(const Picture& picture, const Reference& reference) {
  const auto report = MeasureFlip(reference.picture, picture);
  EXPECT_TRUE(report.ok());
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < reference.band.size(); ++i) {
    if (reference.band[i]) sum += report->map[i], count += 1.0;
  }
  return sum / count;
}

struct BorderCase {
  const char* style;
  double limit;
};

class SupersampledBorders : public ::testing::TestWithParam<BorderCase> {};

TEST_P(SupersampledBorders, AreThoseOfThePicture) {
  auto style = LoadStyle(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/" + GetParam().style);
  ASSERT_TRUE(style.ok()) << style.error().message;
  style->paper = {}, style->transfer.edge = EdgeMode::kExact;
  LayerSet layers = RequiredLayers(*style);
  const GuideSet guides = StillLifeAt(1, kAa, layers), fine = StillLifeAt(kAa, 1, {});
  ASSERT_TRUE(guides.fragments);
  const Picture painted = MustTransfer(*style, guides).picture;
  const Picture steps = MustTransfer(*style, WithoutFragments(guides)).picture;
  const Reference reference = ReferenceOf(guides, fine, steps, painted);
  const auto pixels = std::count(reference.band.begin(), reference.band.end(), true);
  EXPECT_GT(pixels, 1000);
  EXPECT_LT(reference.unknown, pixels / 50);
  const double error = MeanOfBand(painted, reference);
  EXPECT_LE(error, GetParam().limit);
  EXPECT_GT(MeanOfBand(steps, reference), 4 * error);
}

INSTANTIATE_TEST_SUITE_P(Styles, SupersampledBorders,
                         ::testing::Values(BorderCase{"watercolour", 0.01}, BorderCase{"pointillism", 0.01}),
                         [](const auto& info) { return info.param.style; });

}  // namespace
}  // namespace scumble
