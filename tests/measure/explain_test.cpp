// The pictures that explain a result, on planes with a known answer.
#include "measure/explain.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "core/image/color.h"
#include "core/image/oklab.h"

namespace scumble {
namespace {

// 8 × 4 pixels: two chunks of 3 × 4, one column of lone pixels, and background on the right.
struct Mosaic {
  static constexpr int kWidth = 8, kHeight = 4;
  std::vector<std::int16_t> x, y;
  std::vector<std::int8_t> level;
  std::vector<std::uint8_t> exemplar;
  std::vector<std::uint16_t> style;
  std::vector<float> coverage, error;

  Mosaic() {
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        x.push_back(static_cast<std::int16_t>(u < 3 ? 10 + u : u < 6 ? 30 + u : u == 6 ? 50 + 7 * v : 0));
        y.push_back(static_cast<std::int16_t>(u < 6 ? 20 + v : 5));
        level.push_back(static_cast<std::int8_t>(u < 6 ? 4 : u == 6 ? 0 : -1));
        exemplar.push_back(u < 3 ? 0 : 1);
        style.push_back(u < 3 ? 0 : u < 7 ? 1 : ExplainPlanes::kNoStyle);
        coverage.push_back(u < 6 ? 1.0f : 0.5f);
        error.push_back(u < 3 ? 0.0f : 0.2f);
      }
    }
  }
  ExplainPlanes Planes() const {
    return {kWidth, kHeight, coverage, x, y, level, exemplar, style, error, {100, 100}, {2, 2}, {0.2f, 0.1f}, nullptr};
  }
};

ExplainColor At(const Picture& picture, int x, int y) {
  const std::uint16_t* pixel = picture.At(x, y);
  return {pixel[0], pixel[1], pixel[2]};
}

float Lightness(ExplainColor c) {
  return OklabFromLinear({Srgb16ToLinear(c.r), Srgb16ToLinear(c.g), Srgb16ToLinear(c.b)}).x;
}

TEST(Explain, NamesAreReadBack) {
  const std::vector<std::string> names = ExplanationNames();
  EXPECT_EQ(names.size(), 7u);
  for (std::size_t i = 0; i < names.size(); ++i) {
    ASSERT_TRUE(FindExplanation(names[i])) << names[i];
    EXPECT_EQ(static_cast<std::size_t>(*FindExplanation(names[i])), i);
  }
  EXPECT_FALSE(FindExplanation("source"));
  EXPECT_FALSE(FindExplanation(""));
}

TEST(Explain, SourcesCanBeReadOffThePicture) {
  const Mosaic mosaic;
  const Picture picture = Explain(Explanation::kSources, mosaic.Planes());
  for (int y = 0; y < Mosaic::kHeight; ++y) {
    for (int x = 0; x < 7; ++x) {
      const std::size_t i = std::size_t(y) * Mosaic::kWidth + x;
      const ExplainColor c = At(picture, x, y);
      EXPECT_EQ(static_cast<int>(c.r / 65535.0 * 100), mosaic.x[i]);
      EXPECT_EQ(static_cast<int>(c.g / 65535.0 * 100), mosaic.y[i]);
      EXPECT_EQ(c.b, mosaic.exemplar[i] ? 65535 : 0);
    }
  }
}

TEST(Explain, CoverageBecomesAlphaAndWhatIsNotPaintedIsTransparent) {
  const Mosaic mosaic;
  for (const std::string& name : ExplanationNames()) {
    if (name == "borders") continue;
    const Picture picture = Explain(*FindExplanation(name), mosaic.Planes());
    EXPECT_EQ(picture.At(2, 1)[3], 65535) << name;
    EXPECT_EQ(picture.At(6, 1)[3], 32768) << name;
    EXPECT_EQ(picture.At(7, 1)[3], 0) << name;
  }
}

TEST(Explain, ChunksHaveOneColourEachAndDarkEnds) {
  const Mosaic mosaic;
  const Picture picture = Explain(Explanation::kChunks, mosaic.Planes());
  EXPECT_EQ(At(picture, 0, 0), At(picture, 1, 3));
  EXPECT_EQ(At(picture, 3, 0), At(picture, 4, 3));
  EXPECT_NE(At(picture, 0, 0), At(picture, 3, 0));
  for (int y = 0; y < Mosaic::kHeight; ++y) {
    EXPECT_LT(Lightness(At(picture, 2, y)), 0.45f) << "the last column of the first chunk";
    EXPECT_LT(Lightness(At(picture, 5, y)), 0.45f) << "the last column of the second";
    EXPECT_GT(Lightness(At(picture, 6, y)), 0.55f) << "a pixel that stands alone";
  }
  EXPECT_GT(Lightness(At(picture, 1, 1)), 0.55f);
}

TEST(Explain, BordersAreDrawnOverTheResultAndNothingElseChanges) {
  const Mosaic mosaic;
  Picture result(Mosaic::kWidth, Mosaic::kHeight);
  for (std::size_t i = 0; i < result.rgba.size(); ++i) result.rgba[i] = static_cast<std::uint16_t>(1000 + i);
  ExplainPlanes planes = mosaic.Planes();
  planes.result = &result;
  const Picture picture = Explain(Explanation::kBorders, planes);
  for (int y = 0; y < Mosaic::kHeight; ++y) {
    for (int x = 0; x < Mosaic::kWidth; ++x) {
      EXPECT_EQ(At(picture, x, y) == At(result, x, y), x != 2 && x != 5) << x << ", " << y;
      EXPECT_EQ(picture.At(x, y)[3], result.At(x, y)[3]);
    }
  }
}

TEST(Explain, ExemplarsAndStylesAreToldApart) {
  const Mosaic mosaic;
  for (const Explanation what : {Explanation::kExemplar, Explanation::kStyles}) {
    const Picture picture = Explain(what, mosaic.Planes());
    EXPECT_EQ(At(picture, 0, 0), At(picture, 2, 3));
    EXPECT_EQ(At(picture, 3, 0), At(picture, 6, 3));
    EXPECT_NE(At(picture, 2, 0), At(picture, 3, 0));
  }
}

TEST(Explain, TheLevelScaleRisesInLightness) {
  for (int level = 1; level <= 7; ++level) {
    EXPECT_GT(Lightness(LevelColor(level)), Lightness(LevelColor(level - 1)) + 0.04f) << level;
  }
  EXPECT_EQ(LevelColor(15), LevelColor(7));
  const Mosaic mosaic;
  const Picture picture = Explain(Explanation::kLevels, mosaic.Planes());
  EXPECT_EQ(At(picture, 0, 0), LevelColor(4));
  EXPECT_EQ(At(picture, 6, 0), LevelColor(0));
}

TEST(Explain, TheErrorScaleHasTheThresholdInTheMiddle) {
  const ExplainColor black, white{65535, 65535, 65535}, orange = ErrorColor(0.1f, 0.1f);
  EXPECT_EQ(ErrorColor(0.0f, 0.1f), black);
  EXPECT_GT(orange.r, orange.g + 10000);
  EXPECT_GT(orange.g, orange.b + 10000);
  EXPECT_EQ(ErrorColor(0.3f, 0.1f), white);
  float last = -1.0f;
  for (int i = 0; i <= 40; ++i) {
    const float lightness = Lightness(ErrorColor(0.005f * static_cast<float>(i), 0.1f));
    EXPECT_GT(lightness, last) << i;
    last = lightness;
  }
  EXPECT_EQ(ErrorColor(0.01f, 0.0f), white) << "a threshold of 0 accepts nothing";
  EXPECT_EQ(ErrorColor(0.0f, 0.0f), black);
  EXPECT_EQ(ErrorColor(2.0f, INFINITY), ErrorColor(0.1f, 0.1f)) << "the scale ends at the largest distance";
  EXPECT_EQ(ErrorColor(NAN, 0.1f), black);

  const Mosaic mosaic;
  const Picture picture = Explain(Explanation::kError, mosaic.Planes());
  EXPECT_EQ(At(picture, 0, 0), black);
  EXPECT_EQ(At(picture, 4, 0), white) << "the second style's threshold is half the error";
}

}  // namespace
}  // namespace scumble
