// The borders of painted pictures against the 4 × 4 supersampled picture of the source field that the run itself
// matched. The picture of reference knows nothing of fragments: the scene is cast once more at four times the size for
// surface and normal of every subsample. A subsample's sources are those of the pixels whose centres show its surface
// within the crease, in the style's window around its pixel, continued to that pixel. Where the style has no window,
// that is the nearest that shows its surface. The 16 colours are averaged in linear light, where pictures are
// composited.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/style/style_file.h"
#include "guidegen/framing.h"
#include "guidegen/load_scene.h"
#include "tests/support/fragment_fixtures.h"
#include "tests/support/numbers.h"
#include "transfer/vote/vote_sum.h"

namespace scumble {
namespace {

using namespace testing;

constexpr int kBordersWidth = 480, kBordersHeight = 360;

GuideSet StillLifeAt(int scale, int aa, const LayerSet& layers) {
  auto scene = LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/stilllife.glb");
  EXPECT_TRUE(scene.ok());
  const auto view = PrepareView(*scene, "", std::nullopt, double(kBordersWidth) / kBordersHeight, true);
  EXPECT_TRUE(view.ok());
  GuidegenOptions options = Sized(kBordersWidth * scale, kBordersHeight * scale, layers);
  options.aa = aa;
  return Render(*scene, view->camera, options).guides;
}

using Surface = std::pair<float, float>;  // object and material

Surface SurfaceAt(const GuideSet& guides, int x, int y) {
  const std::size_t i = guides.Index(x, y);
  return {guides.Plane(Layer::kObject)[i], guides.Plane(Layer::kMaterial)[i]};
}

// What a run has matched, without fragments.
struct Matched {
  const GuideSet& guides;
  const PreparedStyle& style;
  const SourceField& field;
};

// The pixel nearest to a subsample in pixel (x, y), of the nine around, whose centre shows the surface within the
// crease.
std::optional<std::pair<int, int>> NearestOf(const Surface& surface, const GuideSet& guides, int x, int y, double at_x,
                                             double at_y, const glm::vec3& normal, float crease) {
  std::optional<std::pair<int, int>> nearest;
  double least = 0.0;
  for (int v = std::max(0, y - 1); v <= std::min(guides.height() - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(guides.width() - 1, x + 1); ++u) {
      const double off = std::hypot(u + 0.5 - at_x, v + 0.5 - at_y);
      if (SurfaceAt(guides, u, v) != surface || (nearest && off >= least)) continue;
      if (!(glm::dot(guides.Vec3(Layer::kNormal, guides.Index(u, v)), normal) > crease)) continue;
      nearest = {u, v}, least = off;
    }
  }
  return nearest;
}

// The paint of a surface in pixel (x, y), where pixel (u, v) shows it.
std::array<std::uint16_t, 4> PaintOf(const Matched& matched, int x, int y, int u, int v, const glm::vec3& normal) {
  const GuideSet& guides = matched.guides;
  const PreparedExemplar& exemplar = *matched.style.exemplar;
  const auto source_at = [&](int qx, int qy) {
    const std::size_t q = guides.Index(qx, qy);
    return Source{matched.field.x[q] + x - qx, matched.field.y[q] + y - qy};
  };
  const auto texel_at = [&](int qx, int qy, const Source& source) {
    return exemplar.picture(matched.field.exemplar[guides.Index(qx, qy)]).At(source.x, source.y);
  };
  const Surface surface = SurfaceAt(guides, u, v);
  const float crease = float(std::cos(matched.style.settings.crease * kPi / 180.0));
  const int radius = matched.style.blend_radius;
  internal::VoteSum sum;
  for (int qy = std::max(0, y - radius); qy <= std::min(guides.height() - 1, y + radius); ++qy) {
    for (int qx = std::max(0, x - radius); qx <= std::min(guides.width() - 1, x + radius); ++qx) {
      if (SurfaceAt(guides, qx, qy) != surface) continue;
      if (!(glm::dot(guides.Vec3(Layer::kNormal, guides.Index(qx, qy)), normal) > crease)) continue;
      const Source source = source_at(qx, qy);
      if (exemplar.Usable(source.x, source.y)) sum.Add(texel_at(qx, qy, source));
    }
  }
  if (radius == 0 || sum.votes == 0) {
    const Source on = source_at(u, v), own{matched.field.x[guides.Index(u, v)], matched.field.y[guides.Index(u, v)]};
    sum.Add(texel_at(u, v, exemplar.Usable(on.x, on.y) ? on : own));
  }
  std::array<std::uint16_t, 4> texel;
  sum.Count(texel.data());
  return texel;
}

struct SubsampleReference {
  Picture picture;         // outside of the band that of the run
  std::vector<bool> band;  // pixels of two surfaces or more, all of which have a colour
  int unknown = 0;         // pixels of a part of a surface that no centre around shows
};

SubsampleReference ReferenceOf(const Matched& matched, const GuideSet& fine, const Picture& steps,
                               const Picture& painted) {
  const GuideSet& guides = matched.guides;
  const bool has_window = matched.style.blend_radius > 0;
  const float crease = has_window ? float(std::cos(matched.style.settings.crease * kPi / 180.0)) : -2.0f;
  SubsampleReference reference{painted, std::vector<bool>(guides.pixel_count()), 0};
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      const Surface centre = SurfaceAt(guides, x, y);
      double color[3] = {};
      bool covered = true, is_known = true, is_border = false;
      for (int v = y * kAa; v < (y + 1) * kAa; ++v) {
        for (int u = x * kAa; u < (x + 1) * kAa; ++u) {
          const Surface surface = SurfaceAt(fine, u, v);
          const glm::vec3 normal = fine.Vec3(Layer::kNormal, fine.Index(u, v));
          covered = covered && fine.Plane(Layer::kCoverage)[fine.Index(u, v)] > 0.0f;
          is_border = is_border || surface != centre;
          std::array<std::uint16_t, 4> texel;
          if (surface == centre) {
            std::copy_n(steps.At(x, y), 4, texel.data());
          } else if (const auto from =
                         NearestOf(surface, guides, x, y, (u + 0.5) / kAa, (v + 0.5) / kAa, normal, crease)) {
            texel = PaintOf(matched, x, y, from->first, from->second, normal);
          } else {
            is_known = false;
          }
          for (int c = 0; is_known && c < 3; ++c) color[c] += Srgb16ToLinear(texel[c]) / (kAa * kAa);
        }
      }
      if (!covered || !is_border) continue;
      reference.unknown += !is_known;
      if (!is_known) continue;
      reference.band[guides.Index(x, y)] = true;
      for (int c = 0; c < 3; ++c) reference.picture.At(x, y)[c] = Srgb16FromLinear(float(color[c]));
    }
  }
  return reference;
}

double MeanOfBand(const Picture& picture, const SubsampleReference& reference) {
  const auto report = MeasureFlip(reference.picture, picture);
  EXPECT_TRUE(report.ok());
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < reference.band.size(); ++i) {
    if (reference.band[i]) sum += report->map[i], count += 1.0;
  }
  return sum / count;
}

class SupersampledBorders : public ::testing::TestWithParam<const char*> {};

TEST_P(SupersampledBorders, AreThoseOfThePicture) {
  auto style = LoadStyle(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/" + GetParam());
  ASSERT_TRUE(style.ok()) << style.error().message;
  style->paper = {}, style->transfer.edge = EdgeMode::kExact;
  style->transfer.hybrid = 0.0;  // the reference knows no base layers; fragments_test.cpp has them
  LayerSet layers = RequiredLayers(*style);
  const GuideSet guides = StillLifeAt(1, kAa, layers), fine = StillLifeAt(kAa, 1, {});
  ASSERT_TRUE(guides.fragments);
  const PreparedStyle prepared = MustPrepareStyle(*style, kBordersHeight);
  TransferOptions options;
  options.keep_field = true;
  TransferScratch scratch;
  Picture painted, steps;
  ASSERT_TRUE(Transfer(prepared, guides, {}, scratch, painted).ok());
  ASSERT_TRUE(Transfer(prepared, WithoutFragments(guides), options, scratch, steps).ok());
  const SubsampleReference reference = ReferenceOf({guides, prepared, scratch.field}, fine, steps, painted);
  const auto pixels = std::count(reference.band.begin(), reference.band.end(), true);
  EXPECT_GT(pixels, 1000);
  EXPECT_LT(reference.unknown, pixels / 50);
  const double error = MeanOfBand(painted, reference);
  EXPECT_LE(error, 0.01);
  EXPECT_GT(MeanOfBand(steps, reference), 4 * error);
}

INSTANTIATE_TEST_SUITE_P(Styles, SupersampledBorders,
                         ::testing::Values("watercolour", "oil", "charcoal", "pastel", "woodcut", "pointillism", "ink"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace scumble
