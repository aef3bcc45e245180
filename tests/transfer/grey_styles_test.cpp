// The styles in greys: exactly neutral, so that all colour is the scene's, and light enough to leave it fresh.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "core/style/style_file.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

constexpr const char* kStyles[] = {"tinted-oil", "tinted-pencil", "tinted-wash"};

Style Tinted(const std::string& name) {
  auto style = LoadStyle(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/" + name);
  EXPECT_TRUE(style.ok()) << style.error().message;
  return std::move(*style);
}

void ExpectNeutral(const Picture& picture) {
  std::size_t colored = 0;
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    colored += picture.rgba[i] != picture.rgba[i + 1] || picture.rgba[i] != picture.rgba[i + 2];
  }
  EXPECT_EQ(colored, 0u);
}

TEST(GreyStyles, AreNeutralAndTinted) {
  for (const char* name : kStyles) {
    SCOPED_TRACE(name);
    const Style style = Tinted(name);
    EXPECT_EQ(style.transfer.colorize, 1.0);
    for (const Exemplar& exemplar : style.exemplars) ExpectNeutral(exemplar.picture);
    ASSERT_TRUE(style.paper.picture.has_value());
    ExpectNeutral(*style.paper.picture);
  }
}

// A sphere of one base colour: its mean keeps that hue and stays as light, within limits.
TEST(GreyStyles, LeaveBaseColoursFresh) {
  for (const char* name : kStyles) {
    SCOPED_TRACE(name);
    Style style = Tinted(name);
    style.transfer.reference_height = 0, style.transfer.scale = 0.25, style.transfer.levels = 5;
    style.paper = {};
    for (const glm::vec3 base : {glm::vec3(0.55f, 0.12f, 0.06f), {0.12f, 0.35f, 0.10f}, {0.10f, 0.20f, 0.50f}}) {
      GuideSet guides = SphereGuides(160);
      guides.Add(Layer::kAlbedo);
      for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
        for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = base[c];
      }
      const Picture picture = MustTransfer(style, guides).picture;
      glm::dvec3 mean(0.0);
      double count = 0.0;
      for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
        if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
        const std::uint16_t* texel = picture.rgba.data() + 4 * i;
        mean +=
            glm::dvec3(OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])}));
        count += 1.0;
      }
      mean /= count;
      const glm::dvec3 wanted(OklabFromLinear(base));
      EXPECT_NEAR(mean.x, wanted.x, 0.10) << "lightness";
      EXPECT_LT(std::fabs(std::atan2(mean.z, mean.y) - std::atan2(wanted.z, wanted.y)), 0.15) << "hue, in radians";
      EXPECT_GT(std::hypot(mean.y, mean.z), 0.6 * std::hypot(wanted.y, wanted.z)) << "chroma";
    }
  }
}

}  // namespace
}  // namespace scumble
