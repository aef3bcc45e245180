// Painted scenes as exemplars, and how ambiguous they are.
#include <limits>
#include <numbers>

#include "tests/support/scene_exemplar_fixtures.h"
#include "transfer/ambiguity.h"
#include "transfer/exemplar/usable_mask.h"

namespace scumble {
namespace {

using namespace testing;

// ---- painted scenes ------------------------------------------------------------------------------------------------

// Sphere guides given as those of any scene give what the formula gives, but for the rim's staircase.
TEST(SceneExemplar, ASpherePaintedAsASceneIsASphere) {
  constexpr int kSize = 128;
  Style sphere = PlainStyle(NoisePicture(kSize)), scene = SceneStyle(NoisePicture(kSize), SphereGuides(kSize));
  scene.transfer.nearest = sphere.transfer.nearest = NearestSearch::kTree;
  sphere.transfer.rim = scene.transfer.rim = 0.0;
  const GuideSet target = HillGuides(150, 100);
  const Transferred a = MustTransfer(sphere, target), b = MustTransfer(scene, target);
  EXPECT_TRUE(SameField(a.field, b.field));
  EXPECT_EQ(a.picture.rgba, b.picture.rgba);
  EXPECT_FALSE(MustPrepare(scene)->is_sphere());
}

TEST(SceneExemplar, WideAndTallPicturesAtAnyScaleShowUsablePaintOnly) {
  for (const auto& [width, height] : {std::pair{90, 40}, {40, 90}, {64, 64}}) {
    const GuideSet guides = HillGuides(width, height);
    Picture picture(width, height);  // magenta outside, white inside
    for (int i = 0; i < width * height; ++i) {
      const bool covered = guides.Plane(Layer::kCoverage)[i] > 0.0f;
      std::uint16_t* texel = picture.At(i % width, i / width);
      texel[0] = texel[2] = texel[3] = 65535, texel[1] = covered ? 65535 : 0;
    }
    const auto mask = internal::UsableMask(guides, 2.0);
    for (int i = 0; i < width * height; ++i) {
      if (!mask[i]) picture.At(i % width, i / width)[1] = 0;  // the rim is bad paint too
    }
    for (const double scale : {0.3, 0.77, 1.0, 2.5}) {
      for (const Method method : {Method::kLitSphere, Method::kStyleBlit, Method::kBruteForce}) {
        Style style = SceneStyle(picture, guides);
        style.transfer.scale = scale, style.transfer.method = method, style.transfer.blend_radius = 3;
        const auto exemplar = MustPrepare(style);
        EXPECT_EQ(exemplar->width(), ScaledSize(width, scale, 0, 100));
        EXPECT_EQ(exemplar->height(), ScaledSize(height, scale, 0, 100));
        const Transferred result = MustTransfer(style, HillGuides(80, 60));
        for (std::size_t i = 0; i < result.field.level.size(); ++i) {
          if (result.field.level[i] == SourceField::kNoSource) continue;
          ASSERT_TRUE(exemplar->Usable(result.field.x[i], result.field.y[i]));
          ASSERT_EQ(result.picture.rgba[4 * i + 1], 65535) << "paint from outside the mask";
        }
      }
    }
  }
}

TEST(SceneExemplar, GuidesAreSampledAndNeverAveraged) {
  const GuideSet guides = Blobs(60, 60, 4);
  Style style = SceneStyle(NoisePicture(60), guides);
  style.transfer.rim = 0.0;
  for (const double scale : {0.5, 3.0}) {
    style.transfer.scale = scale;
    const auto exemplar = MustPrepare(style);
    for (const Source& source : exemplar->UsablePixels()) {
      const int u = static_cast<int>((source.x + 0.5) / scale), v = static_cast<int>((source.y + 0.5) / scale);
      ASSERT_EQ(exemplar->Normal(source.x, source.y), guides.Vec3(Layer::kNormal, guides.Index(u, v)));
    }
  }
}

std::string Refusal(const Style& style, ErrorKind kind) {
  const auto prepared = Prepare(style, 100);
  EXPECT_FALSE(prepared.ok());
  if (prepared.ok()) return "";
  EXPECT_EQ(int(prepared.error().kind), int(kind)) << prepared.error().message;
  return prepared.error().message;
}

bool Has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(SceneExemplar, WhatIsRefused) {
  const Style good = SceneStyle(WideNoise(40, 30), HillGuides(40, 30));
  Style style = good;
  style.transfer.nearest = NearestSearch::kAnalytic;
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kUsage), "transfer.nearest"));
  style = good;
  style.transfer.rim = 100.0;
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kUsage), "lower transfer.rim"));
  style = good;
  style.exemplars[0].guides = HillGuides(41, 30);
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "41×30"));
  style = good;
  style.exemplars[0].guides = MakeGuides(40, 30, [](int, int) { return glm::vec3(0.0f); });
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "A is 0 everywhere"));
  style = good;
  style.exemplars[0].guides->Plane(Layer::kNormal)[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "normal"));
  style = good;
  style.exemplars[0].is_sphere = true, style.exemplars[0].guides.reset();
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "40×30"));
  // Exemplars of one style show one scene.
  style = good;
  style.exemplars.push_back(good.exemplars[0]);
  EXPECT_TRUE(Prepare(style, 100).ok());
  style.exemplars[1].guides->Plane(Layer::kNormal, 0)[41] += 0.01f;
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "differ at (1, 1)"));
  style.exemplars[1] = good.exemplars[0];
  style.exemplars[1].picture = WideNoise(30, 40), style.exemplars[1].guides = HillGuides(30, 40);
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "30×40"));
  style.exemplars[1] = PlainStyle(NoisePicture(40)).exemplars[0];
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "one is a sphere"));
  PrepareOptions options;
  options.table_resolution = 0;
  EXPECT_FALSE(Prepare(good, 100, options).ok());
}

TEST(SceneExemplar, LuminanceIsTheGuidesThenThePaints) {
  Style style = SceneStyle(WideNoise(40, 30), HillGuides(40, 30));
  for (std::size_t i = 0; i < style.exemplars[0].picture.rgba.size(); ++i) style.exemplars[0].picture.rgba[i] = 65535;
  style.exemplars.push_back(style.exemplars[0]);
  style.exemplars[1].guides->Add(Layer::kLuminance);
  const auto mask = internal::UsableMask(*style.exemplars[1].guides, 2.0);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const float value = 0.5f * UnitFloat(Hash(i));
    style.exemplars[1].guides->Plane(Layer::kLuminance)[i] = mask[i] ? value : 100.0f;
    if (mask[i]) sum += value, count += 1;
  }
  const auto prepared = Prepare(style, 100);
  ASSERT_TRUE(prepared.ok());
  EXPECT_NEAR(prepared->illumination.luminances()[0], 1.0, 1e-6) << "white paint";
  EXPECT_NEAR(prepared->illumination.luminances()[1], sum / count, 1e-6) << "its own guides, without the rim";
  style.exemplars[1].luminance = 0.25;
  EXPECT_FLOAT_EQ(Prepare(style, 100)->illumination.luminances()[1], 0.25f);
}

TEST(SceneExemplar, TheLargestSides) {
  for (const auto& [width, height] : {std::pair{16384, 3}, {3, 16384}}) {
    const int longer = std::max(width, height);
    Style style = SceneStyle(WideNoise(width, height), MakeGuides(width, height, [longer](int x, int y) {
                               const float u =
                                   1.98f * (static_cast<float>(std::max(x, y)) / static_cast<float>(longer) - 0.5f);
                               return glm::vec3(u, 0.0f, std::sqrt(1.0f - u * u));
                             }));
    style.transfer.rim = 0.0;
    const auto exemplar = MustPrepare(style);
    const Source last = exemplar->NearestNeighbour({0.985f, 0.0f, 0.17f});
    EXPECT_GT(std::max(last.x, last.y), 16000);
    style.transfer.scale = 2.0;
    EXPECT_TRUE(Has(Refusal(style, ErrorKind::kUsage), "at most 16384"));
  }
  const Style style = SceneStyle(Picture(16385, 1), MakeGuides(16385, 1, [](int, int) { return glm::vec3(0, 0, 1); }));
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "at most 16384"));
}

TEST(SceneExemplar, TheSmallestSizes) {
  for (const int size : {1, 2, 16}) {
    Style style =
        SceneStyle(WideNoise(size, size), MakeGuides(size, size, [](int, int) { return glm::vec3(0, 0, 1); }));
    const auto exemplar = MustPrepare(style);
    EXPECT_EQ(exemplar->UsablePixels().size(), std::size_t(size) * size) << "no edge is in sight, so there is no rim";
    EXPECT_EQ(exemplar->NearestNeighbour({0.6f, 0.0f, 0.8f}), (Source{0, 0}));
    style.transfer.scale = 0.001;
    EXPECT_EQ(MustPrepare(style)->width(), 1);
  }
}

// ---- ambiguity -----------------------------------------------------------------------------------------------------

// A cube seen along its diagonal, orthographic: three faces.
GuideSet CubeGuides(int size) {
  const double third = 1.0 / std::sqrt(3.0), up = std::sqrt(2.0 / 3.0), side = std::sqrt(0.5);
  const glm::vec3 faces[3] = {glm::vec3(0, up, third), glm::vec3(-side, -0.5 * up, third),
                              glm::vec3(side, -0.5 * up, third)};
  return MakeGuides(size, size, [=](int x, int y) {
    const double u = (2.0 * x + 1) / size - 1.0, v = 1.0 - (2.0 * y + 1) / size;
    const double angle = std::fmod(std::atan2(v, u) * 180.0 / std::numbers::pi + 360.0 + 30.0, 60.0) - 30.0;
    if (std::hypot(u, v) * std::cos(angle * std::numbers::pi / 180.0) > 0.8 * std::cos(std::numbers::pi / 6))
      return glm::vec3(0.0f);
    const double turned = std::fmod(std::atan2(v, u) * 180.0 / std::numbers::pi + 360.0 - 30.0, 360.0);
    return faces[turned < 120.0 ? 0 : turned < 240.0 ? 1 : 2];
  });
}

TEST(Ambiguity, OfASphere) {
  // Sources end at the angle whose sine is 1 - rim; a cap of that angle θ has 1 - cos θ of the hemisphere.
  for (const int size : {64, 512}) {
    const AmbiguityReport report = MeasureAmbiguity(*MustPrepare(PlainStyle(NoisePicture(size))));
    const double rim = std::asin(1.0 - 2.0 * 2.0 / size), covered = rim + 5.0 * std::numbers::pi / 180.0;
    EXPECT_NEAR(report.covered_percent, 100.0 * (1.0 - std::cos(covered)), size == 64 ? 5.0 : 2.0) << size;
    EXPECT_NEAR(report.largest_error_degrees, 90.0 - rim * 180.0 / std::numbers::pi, size == 64 ? 5.0 : 2.0) << size;
    EXPECT_EQ(report.flat_percent, 0.0) << size;
    EXPECT_NEAR(double(report.usable_pixels), std::numbers::pi * (size / 2 - 2) * (size / 2 - 2), 0.01 * size * size);
    EXPECT_NEAR(report.mean_repeats * report.cells_shown, double(report.usable_pixels), 0.5);
    if (size < 512) continue;
    EXPECT_NEAR(double(report.cells_shown) / report.cells, 1.0 - std::cos(rim), 0.02);
    // The fullest cell faces the viewer: 8/64² sr of a sphere whose radius is 256 pixels, up to a row and a column.
    EXPECT_NEAR(double(report.most_repeats), 8.0 / 64 / 64 * 256 * 256, 25.0);
  }
  const AmbiguityReport tiny = MeasureAmbiguity(*MustPrepare(PlainStyle(NoisePicture(16))));
  EXPECT_LT(tiny.covered_percent, 50.0) << "three quarters of the radius are usable: 49°";
  EXPECT_EQ(tiny.flat_percent, 0.0);
}

TEST(Ambiguity, OfACubeIsThreeDirections) {
  const GuideSet guides = CubeGuides(200);
  const AmbiguityReport report = MeasureAmbiguity(*MustPrepare(SceneStyle(NoisePicture(200), guides)));
  EXPECT_EQ(report.cells_shown, 3);
  EXPECT_GT(report.cells, 3000);
  EXPECT_EQ(report.flat_percent, 100.0);
  // A cap of 5° around each of three directions, of the hemisphere: 3 (1 - cos 5°).
  EXPECT_NEAR(report.covered_percent, 300.0 * (1.0 - std::cos(5.0 * std::numbers::pi / 180.0)), 0.15);
  // The farthest from all three is the point of the rim halfway between two faces: the angle to each has the cosine of
  // 60° times that of the faces' height over the rim.
  const double furthest = 180.0 / std::numbers::pi * std::acos(std::sqrt(2.0 / 3.0) * 0.5);
  EXPECT_NEAR(report.largest_error_degrees, furthest, 1.5);
  EXPECT_NEAR(double(report.most_repeats), double(report.usable_pixels) / 3.0, 0.02 * double(report.usable_pixels));
}

TEST(Ambiguity, OfAnEmptyBoundaryCase) {
  const GuideSet wall = MakeGuides(30, 20, [](int, int) { return glm::vec3(0, 0, 1); });
  const AmbiguityReport report = MeasureAmbiguity(*MustPrepare(SceneStyle(WideNoise(30, 20), wall)));
  EXPECT_EQ(report.cells_shown, 1);
  EXPECT_EQ(report.most_repeats, 600u);
  EXPECT_NEAR(report.largest_error_degrees, 90.0, 1.0);
  EXPECT_NEAR(report.mean_error_degrees, 180.0 / std::numbers::pi, 0.2) << "the mean angle from a pole: 1 radian";
}

}  // namespace
}  // namespace scumble
