// The filters of `smooth`: against their formulas by plain sums, and what all of them keep.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "tests/finish/finish_fixtures.h"
#include "tests/support/every_instruction_set.h"

namespace scumble {
namespace {

using Filter = SmoothPass::Filter;

glm::dvec3 LabAt(const Picture& picture, int x, int y) {
  const std::uint16_t* const texel = picture.At(x, y);
  return OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])});
}

// Two colours with a border at x = 11 + y / 4, and noise on both.
Picture NoisyHalves(int width, int height) {
  Picture picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::uint16_t* const texel = picture.At(x, y);
      const int base = x < 11 + y / 4 ? 20000 : 42000;
      for (int c = 0; c < 3; ++c)
        texel[c] = static_cast<std::uint16_t>(base + c * 2500 + (x * 977 + y * 3571 + c * 1013) % 6000);
      texel[3] = 65535;
    }
  }
  return picture;
}

// The same picture turned by 90 degrees.
Picture TurnedOnce(const Picture& picture) {
  Picture out(picture.height, picture.width);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) std::copy_n(picture.At(x, y), 4, out.At(picture.height - 1 - y, x));
  }
  return out;
}

class SmoothFilters : public ::testing::TestWithParam<Filter> {
 protected:
  SmoothPass Pass(bool borders = false) const {
    SmoothPass pass;
    pass.filter = GetParam(), pass.borders = borders;
    return pass;
  }
};

TEST_P(SmoothFilters, ConstantsKeepTheirBytes) {
  const Picture picture = PlainPicture(40, 20, 50000, 20000, 3000);
  EXPECT_EQ(Finished(StepOf(Pass()), nullptr, picture).rgba, picture.rgba);
}

TEST_P(SmoothFilters, NoiseGoesAndHighStepsStand) {
  const Picture given = NoisyHalves(40, 40), made = Finished(StepOf(Pass()), nullptr, given);
  const auto spread = [](const Picture& picture, int x0, int x1) {
    double sum = 0.0, squares = 0.0, count = 0.0;
    for (int y = 0; y < 40; ++y) {
      for (int x = x0; x < x1; ++x) {
        const double lightness = LabAt(picture, x, y).x;
        sum += lightness, squares += lightness * lightness, count += 1.0;
      }
    }
    return std::sqrt(squares / count - sum / count * (sum / count));
  };
  EXPECT_LT(spread(made, 0, 9), 0.6 * spread(given, 0, 9));
  EXPECT_LT(spread(made, 23, 40), 0.6 * spread(given, 23, 40));
  for (int y = 4; y < 36; ++y) {
    const int border = 11 + y / 4;
    EXPECT_GT(LabAt(made, border + 1, y).x - LabAt(made, border - 2, y).x, 0.18) << y;
  }
}

// A speck goes, at the picture's corner, too; a line of one pixel stands.
TEST(SmoothSpecks, GoAndLinesStand) {
  Picture picture = PlainPicture(40, 30, 40000, 40000, 40000);
  const auto blacken = [&](int x, int y) { std::fill_n(picture.At(x, y), 3, std::uint16_t(0)); };
  blacken(20, 15), blacken(0, 0);
  for (int y = 0; y < 30; ++y) blacken(30, y);
  for (const Filter filter : {Filter::kBilateral, Filter::kWavelets}) {
    SmoothPass pass;
    pass.filter = filter, pass.borders = false;
    const Picture made = Finished(StepOf(pass), nullptr, picture);
    EXPECT_NEAR(made.At(20, 15)[0], 40000, 300);
    EXPECT_NEAR(made.At(0, 0)[0], 40000, 300);
    EXPECT_LT(made.At(30, 15)[0], 3000);
  }
}

// Of two pixels side by side neither is alone, or not until the first pass has evened out one of them.
TEST(SmoothSpecks, OfTwoPixelsLeaveNone) {
  for (const auto& [first, second] : {std::pair(39500, 49500), {49500, 49500}, {49500, 48000}, {12000, 12500}}) {
    Picture picture = PlainPicture(40, 30, 30000, 30000, 30000);
    std::fill_n(picture.At(20, 15), 3, static_cast<std::uint16_t>(first));
    std::fill_n(picture.At(21, 16), 3, static_cast<std::uint16_t>(second));
    for (const Filter filter : {Filter::kBilateral, Filter::kWavelets}) {
      SmoothPass pass;
      pass.filter = filter, pass.borders = false;
      const Picture made = Finished(StepOf(pass), nullptr, picture);
      for (std::size_t i = 0; i < made.rgba.size(); i += 4)
        ASSERT_NEAR(made.rgba[i], 30000, 1500) << i / 4 << ' ' << int(filter) << ' ' << first << ' ' << second;
    }
  }
}

TEST_P(SmoothFilters, TurnsWithThePicture) {
  const Picture given = NoisyHalves(41, 37);
  const Picture made = TurnedOnce(Finished(StepOf(Pass()), nullptr, given));
  const Picture turned = Finished(StepOf(Pass()), nullptr, TurnedOnce(given));
  // Rows go before columns in two of them.
  const bool by_rows = GetParam() == Filter::kBilateral;
  for (std::size_t i = 0; i < made.rgba.size(); ++i)
    ASSERT_NEAR(made.rgba[i], turned.rgba[i], by_rows ? 1500 : 20) << i;
}

TEST_P(SmoothFilters, SameBytesOnAnyThreadsAndInstructionSet) {
  const Picture given = NoisyHalves(53, 29);
  const Picture made = Finished(StepOf(Pass()), nullptr, given, {}, 1);
  EXPECT_EQ(Finished(StepOf(Pass()), nullptr, given, {}, 3).rgba, made.rgba);
  testing::OnEveryInstructionSet([&] { EXPECT_EQ(Finished(StepOf(Pass()), nullptr, given).rgba, made.rgba); });
}

TEST_P(SmoothFilters, ObjectsAndClearPixelsAreNotMixed) {
  GuideSet guides = FlatGuides(60, 20);
  Picture picture = PlainPicture(60, 20, 30000, 30000, 30000);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kObject)[i] = i % 60 < 30 ? 1.0f : 2.0f;
    if (i % 60 >= 30) std::fill_n(&picture.rgba[4 * i], 3, std::uint16_t{31000});
  }
  EXPECT_EQ(Finished(StepOf(Pass(true)), &guides, picture).rgba, picture.rgba);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (i % 60 >= 30) picture.rgba[4 * i + 3] = 0;
  }
  EXPECT_EQ(Finished(StepOf(Pass()), nullptr, picture).rgba, picture.rgba);
}

// A slanted border whose pixels show both objects in the shares that they cover, and fine noise.
TEST_P(SmoothFilters, BordersOfObjectsAreNotJagged) {
  GuideSet guides = FlatGuides(60, 40);
  Picture picture(60, 40);
  const auto share_at = [](double x, double y) { return std::clamp(x - 25.0 - 0.3 * y, 0.0, 1.0); };
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 60; ++x) {
      const double share = share_at(x, y);
      guides.Plane(Layer::kObject)[guides.Index(x, y)] = share < 0.5 ? 1.0f : 2.0f;
      const auto grey = static_cast<std::uint16_t>(20000 + 20000 * share + (x * 977 + y * 3571) % 600);
      std::fill_n(picture.At(x, y), 3, grey), picture.At(x, y)[3] = 65535;
    }
  }
  SmoothPass pass = Pass(true);
  const Picture made = Finished(StepOf(pass), &guides, picture);
  for (int y = 5; y < 35; ++y) {
    for (int x = 20; x < 45; ++x) EXPECT_NEAR(made.At(x, y)[0], 20300 + 20000 * share_at(x, y), 1500) << x << ' ' << y;
  }
}

TEST_P(SmoothFilters, AnySizeAndRadius) {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {1, 7}, {5, 3}, {33, 17}}) {
    for (const double radius : {0.5, 32.0}) {
      SmoothPass pass = Pass();
      pass.radius = radius;
      const Picture given = NoisyHalves(width, height), made = Finished(StepOf(pass), nullptr, given);
      ASSERT_EQ(made.rgba.size(), given.rgba.size());
      if (width * height == 1) {
        EXPECT_EQ(made.rgba, given.rgba);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, SmoothFilters,
                         ::testing::Values(Filter::kBilateral, Filter::kKuwahara, Filter::kGuided, Filter::kWavelets));

TEST(Kuwahara, NeverLeavesTheRangeOfItsInput) {
  SmoothPass pass;
  pass.borders = false, pass.filter = Filter::kKuwahara;
  const Picture given = NoisyHalves(40, 40), made = Finished(StepOf(pass), nullptr, given);
  glm::dvec3 least(1e9), most(-1e9);
  for (int i = 0; i < 1600; ++i) {
    least = glm::min(least, LabAt(given, i % 40, i / 40));
    most = glm::max(most, LabAt(given, i % 40, i / 40));
  }
  for (int i = 0; i < 1600; ++i) {
    const glm::dvec3 lab = LabAt(made, i % 40, i / 40);
    for (int c = 0; c < 3; ++c) {
      ASSERT_GE(lab[c], least[c] - 2e-5);
      ASSERT_LE(lab[c], most[c] + 2e-5);
    }
  }
}

// Where a row crosses the middle of a blurred step, before and after.
TEST(Kuwahara, KeepsAStepsPosition) {
  SmoothPass pass;
  pass.borders = false, pass.filter = Filter::kKuwahara, pass.radius = 6.0, pass.passes = 1;
  for (const double slope : {0.0, 0.3, 1.0}) {
    Picture given(64, 48);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        const double off = x - 31.7 - slope * (y - 24);
        const double lightness = 0.5 + 0.2 * std::clamp(off / 2.0, -1.0, 1.0);
        std::fill_n(given.At(x, y), 3, Srgb16FromLinear(static_cast<float>(lightness * lightness * lightness)));
        given.At(x, y)[3] = 65535;
      }
    }
    const Picture made = Finished(StepOf(pass), nullptr, given);
    const auto crossing = [](const Picture& picture, int y) {
      for (int x = 16; x < 48; ++x) {
        const double before = LabAt(picture, x, y).x, after = LabAt(picture, x + 1, y).x;
        if (before <= 0.5 && after > 0.5) return x + (0.5 - before) / (after - before);
      }
      return -1.0;
    };
    double sum = 0.0;
    for (int y = 18; y < 28; ++y) {
      EXPECT_NEAR(crossing(made, y), crossing(given, y), 0.25) << slope << " " << y;
      sum += crossing(made, y) - crossing(given, y);
    }
    EXPECT_NEAR(sum / 10.0, 0.0, 0.1) << slope;  // of a whole period
  }
}

// What a pixel at a border of objects takes of the neighbours' smoothed colour: the share that the given colour has of
// it, half at most.
glm::dvec3 WithBorder(const GuideSet& guides, const Picture& given, const std::vector<glm::dvec3>& smoothed, int x,
                      int y) {
  const std::size_t p = guides.Index(x, y);
  glm::dvec3 others(0.0);
  double count = 0.0;
  for (const auto& [u, v] : {std::pair(x - 1, y), {x + 1, y}, {x, y - 1}, {x, y + 1}}) {
    if (u < 0 || v < 0 || u >= guides.width() || v >= guides.height()) continue;
    if (guides.Plane(Layer::kObject)[guides.Index(u, v)] == guides.Plane(Layer::kObject)[p]) continue;
    others += smoothed[guides.Index(u, v)], count += 1.0;
  }
  if (count == 0.0) return smoothed[p];
  const glm::dvec3 way = others / count - smoothed[p];
  const double share = glm::dot(LabAt(given, x, y) - smoothed[p], way) / glm::dot(way, way);
  return smoothed[p] + std::clamp(share, 0.0, 0.5) * way;
}

// The formula, window by window.
TEST(Guided, IsTheFormula) {
  constexpr int kWidth = 23, kHeight = 17, kRadius = 3;
  SmoothPass pass;
  pass.filter = Filter::kGuided, pass.radius = kRadius, pass.passes = 1, pass.range = 0.1;
  GuideSet guides = FlatGuides(kWidth, kHeight);
  const Picture given = NoisyHalves(kWidth, kHeight);
  for (const bool has_objects : {false, true}) {
    // Two objects whose border bends.
    const auto object = [&](int x, int y) { return has_objects && x > 8 + (y > 9 ? 4 : 0) ? 2.0f : 1.0f; };
    for (int i = 0; i < kWidth * kHeight; ++i)
      guides.Plane(Layer::kObject)[std::size_t(i)] = object(i % kWidth, i / kWidth);
    // The places of a window: up and down as far as the object goes, and from each of these to the left and right.
    const auto window = [&](int x, int y) {
      std::vector<glm::ivec2> places;
      const auto in = [&](int u, int v) {
        return u >= 0 && u < kWidth && v >= 0 && v < kHeight && object(u, v) == object(x, y);
      };
      const auto row = [&](int v) {
        for (int u = x; u <= x + kRadius && in(u, v); ++u) places.push_back({u, v});
        for (int u = x - 1; u >= x - kRadius && in(u, v); --u) places.push_back({u, v});
      };
      for (int v = y; v <= y + kRadius && in(x, v); ++v) row(v);
      for (int v = y - 1; v >= y - kRadius && in(x, v); --v) row(v);
      return places;
    };
    std::vector<glm::dvec4> line(std::size_t(kWidth * kHeight));
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const auto places = window(x, y);
        glm::dvec3 mean(0.0);
        for (const auto& at : places) mean += LabAt(given, at.x, at.y) / double(places.size());
        double variance = 0.0;
        for (const auto& at : places) {
          const glm::dvec3 off = LabAt(given, at.x, at.y) - mean;
          variance += glm::dot(off, off) / double(places.size());
        }
        const double gain = variance / (variance + 0.1 * 0.1 / 4.0);
        line[std::size_t(y * kWidth + x)] = glm::dvec4(mean * (1.0 - gain), gain);
      }
    }
    std::vector<glm::dvec3> smoothed;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const auto places = window(x, y);
        glm::dvec4 mean(0.0);
        for (const auto& at : places) mean += line[std::size_t(at.y * kWidth + at.x)] / double(places.size());
        smoothed.push_back(mean.w * LabAt(given, x, y) + glm::dvec3(mean));
      }
    }
    const Picture made = Finished(StepOf(pass), &guides, given);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x)
        ASSERT_LT(glm::length(LabAt(made, x, y) - WithBorder(guides, given, smoothed, x, y)), 4e-5) << x << " " << y;
    }
  }
}

// Level by level, tap by tap. In a smaller picture the first level is what a later one is in the large picture.
class WaveletsOfScale : public ::testing::TestWithParam<double> {};
TEST_P(WaveletsOfScale, AreTheFormula) {
  constexpr int kWidth = 29, kHeight = 21;
  const double scale = GetParam();
  SmoothPass pass;
  pass.filter = Filter::kWavelets, pass.radius = 2.0 / scale, pass.passes = 1, pass.range = 0.15 / scale;
  GuideSet guides = FlatGuides(kWidth, kHeight);
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const auto p = std::size_t(i);
    const double angle = 0.3 * std::sin(0.4 * (i % kWidth)) + (i / kWidth > 14 ? 0.4 : 0.0);
    guides.Plane(Layer::kNormal, 0)[p] = static_cast<float>(std::sin(angle));
    guides.Plane(Layer::kNormal, 2)[p] = static_cast<float>(std::cos(angle));
    guides.Plane(Layer::kDepth)[p] = 4.0f + 0.02f * static_cast<float>(i % kWidth) + (i % kWidth > 20 ? 0.2f : 0.0f);
    guides.Plane(Layer::kObject)[p] = i / kWidth < 5 ? 1.0f : 2.0f;
  }
  const auto value = [&](Layer layer, int c, int x, int y) {
    return double(guides.Plane(layer, c)[guides.Index(x, y)]);
  };
  const auto biweight = [](double distance, double half) {
    const double room = std::max(0.0, 1.0 - 0.2928932188134524 * distance * distance / (half * half));
    return room * room;
  };
  const Picture given = NoisyHalves(kWidth, kHeight), made = Finished(StepOf(pass), &guides, given, {}, 0, scale);
  std::vector<glm::dvec3> now(std::size_t(kWidth * kHeight)), next(now.size());
  for (int i = 0; i < kWidth * kHeight; ++i) now[std::size_t(i)] = LabAt(given, i % kWidth, i / kWidth);
  const double spline[] = {0.375, 0.25, 0.0625};
  for (int level = 0; level < 2; ++level) {  // of variances 1 + 4, the first that is not below 2²
    const int apart = 1 << level;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        glm::dvec3 sum(0.0);
        double weights = 0.0;
        for (int v = -2; v <= 2; ++v) {
          for (int u = -2; u <= 2; ++u) {
            const int qx = x + u * apart, qy = y + v * apart;
            if (qx < 0 || qx >= kWidth || qy < 0 || qy >= kHeight) continue;
            if (value(Layer::kObject, 0, x, y) != value(Layer::kObject, 0, qx, qy)) continue;
            glm::dvec3 normals;
            for (int c = 0; c < 3; ++c) normals[c] = value(Layer::kNormal, c, x, y) - value(Layer::kNormal, c, qx, qy);
            const double z = value(Layer::kDepth, 0, x, y), qz = value(Layer::kDepth, 0, qx, qy);
            const glm::dvec3 other = now[std::size_t(qy * kWidth + qx)];
            const double weight = spline[std::abs(u)] * spline[std::abs(v)] *
                                  biweight(glm::length(other - now[std::size_t(y * kWidth + x)]), 0.15 / apart) *
                                  biweight(glm::length(normals), 0.5) *
                                  biweight(std::abs(z - qz) / std::sqrt(z * qz), 0.01 * apart / scale);
            sum += weight * other, weights += weight;
          }
        }
        next[std::size_t(y * kWidth + x)] = sum / weights;
      }
    }
    std::swap(now, next);
  }
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const glm::dvec3 expected = WithBorder(guides, given, now, i % kWidth, i / kWidth);
    ASSERT_LT(glm::length(LabAt(made, i % kWidth, i / kWidth) - expected), 4e-5) << i;
  }
}
INSTANTIATE_TEST_SUITE_P(Wavelets, WaveletsOfScale, ::testing::Values(1.0, 0.5));

}  // namespace
}  // namespace scumble
