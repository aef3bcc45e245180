// The error along outlines of pictures whose every pixel's share is known.
#include "measure/outline_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include "core/image/fragments.h"

namespace scumble::testing {
namespace {

constexpr int kOutlineSize = 96, kSubpixels = 8;

// The share of a pixel that lies right of a slanting line.
double LightShareAt(int x, int y, double shift = 0.0) {
  int right = 0;
  for (int v = 0; v < kSubpixels; ++v) {
    for (int u = 0; u < kSubpixels; ++u)
      right += x + (u + 0.5) / kSubpixels > 30.1 + shift + 0.37 * (y + (v + 0.5) / kSubpixels);
  }
  return right / double(kSubpixels * kSubpixels);
}

// Objects 1 and 2 on either side of the line.
GuideSet TwoSides() {
  GuideSet guides(kOutlineSize, kOutlineSize);
  guides.Add(Layer::kCoverage), guides.Add(Layer::kObject);
  std::vector<float> shares;
  auto fragments = std::make_shared<Fragments>();
  std::vector<float> ids;
  for (int y = 0; y < kOutlineSize; ++y) {
    for (int x = 0; x < kOutlineSize; ++x) {
      const double right = LightShareAt(x, y);
      const std::size_t i = guides.Index(x, y);
      guides.Plane(Layer::kCoverage)[i] = 1.0f;
      guides.Plane(Layer::kObject)[i] = right > 0.5 ? 2.0f : 1.0f;
      if (right <= 0.0 || right >= 1.0) continue;
      fragments->pixel.push_back(std::uint32_t(i));
      ids.push_back(right > 0.5 ? 1.0f : 2.0f);
      shares.push_back(float(right > 0.5 ? 1.0 - right : right));
    }
  }
  fragments->values = GuideSet(int(ids.size()), 1);
  fragments->values.Add(Layer::kCoverage), fragments->values.Add(Layer::kObject);
  std::copy(shares.begin(), shares.end(), fragments->values.Plane(Layer::kCoverage).begin());
  std::copy(ids.begin(), ids.end(), fragments->values.Plane(Layer::kObject).begin());
  guides.fragments = fragments;
  return guides;
}

// Dark on the left, light on the right; share(x, y) of each pixel is light.
template <class Share>
Picture LightBy(const Share& share) {
  Picture picture(kOutlineSize, kOutlineSize);
  for (int y = 0; y < kOutlineSize; ++y) {
    for (int x = 0; x < kOutlineSize; ++x) {
      const double light = share(x, y);
      std::uint16_t* const texel = picture.At(x, y);
      texel[0] = std::uint16_t(10000 + 40000 * light), texel[1] = std::uint16_t(12000 + 30000 * light);
      texel[2] = std::uint16_t(20000 + 20000 * light), texel[3] = 65535;
    }
  }
  return picture;
}

template <class Share>
double OutlineErrorOf(const Share& share) {
  const auto report = MeasureOutlines(LightBy(share), TwoSides());
  EXPECT_TRUE(report.ok());
  return report.ok() ? report->error : -1.0;
}

// Whether all pixels within three show one object alone, and which: 0 or 1, or -1.
int InsideAt(int x, int y) {
  const double right = LightShareAt(x, y);
  for (int v = -3; v <= 3; ++v) {
    for (int u = -3; u <= 3; ++u) {
      const bool is_seen = x + u >= 0 && y + v >= 0 && x + u < kOutlineSize && y + v < kOutlineSize;
      if (!is_seen || LightShareAt(x + u, y + v) != right || (right != 0.0 && right != 1.0)) return -1;
    }
  }
  return int(right);
}

// The root of the mean square of share − LightShareAt over the pixels that have four of either inside within five.
template <class Share>
double BruteForce(const Share& share) {
  std::vector<int> inside(kOutlineSize * kOutlineSize);
  for (int i = 0; i < kOutlineSize * kOutlineSize; ++i)
    inside[std::size_t(i)] = InsideAt(i % kOutlineSize, i / kOutlineSize);
  double sum = 0.0, count = 0.0;
  for (int y = 0; y < kOutlineSize; ++y) {
    for (int x = 0; x < kOutlineSize; ++x) {
      int of[2] = {0, 0};
      for (int v = std::max(0, y - 5); v <= std::min(kOutlineSize - 1, y + 5); ++v) {
        for (int u = std::max(0, x - 5); u <= std::min(kOutlineSize - 1, x + 5); ++u) {
          const int there = inside[std::size_t(v * kOutlineSize + u)];
          if (there >= 0) ++of[there];
        }
      }
      if (inside[std::size_t(y * kOutlineSize + x)] >= 0 || of[0] < 4 || of[1] < 4) continue;
      const double off = share(x, y) - LightShareAt(x, y);
      sum += off * off, count += 1.0;
    }
  }
  return std::sqrt(sum / count);
}

TEST(OutlineError, TheSharesOfTheGuidesAreNoError) {
  EXPECT_LT(OutlineErrorOf([](int x, int y) { return LightShareAt(x, y); }), 0.001);
}

TEST(OutlineError, StepsAreWhatTheyAreOff) {
  const auto stepped = [](int x, int y) { return LightShareAt(x, y) > 0.5 ? 1.0 : 0.0; };
  EXPECT_NEAR(OutlineErrorOf(stepped), BruteForce(stepped), 0.01);
  const auto larger = [](int x, int y) { return LightShareAt(x / 2 * 2, y / 2 * 2) > 0.5 ? 1.0 : 0.0; };
  EXPECT_NEAR(OutlineErrorOf(larger), BruteForce(larger), 0.01);
  EXPECT_GT(OutlineErrorOf(larger), 1.5 * OutlineErrorOf(stepped));
}

TEST(OutlineError, ABlurIsAnError) {
  const auto blurred = [](int x, int y) {
    return (LightShareAt(x - 1, y) + LightShareAt(x, y) + LightShareAt(x + 1, y)) / 3.0;
  };
  EXPECT_NEAR(OutlineErrorOf(blurred), BruteForce(blurred), 0.01);
}

TEST(OutlineError, ADisplacedOutlineIsAnError) {
  const auto displaced = [](int x, int y) { return LightShareAt(x, y, 0.5); };
  EXPECT_NEAR(OutlineErrorOf(displaced), BruteForce(displaced), 0.01);
}

// Paint that varies on both sides is none: steps beside it are what they were.
TEST(OutlineError, PaintIsNoError) {
  const auto grain = [](int x, int y) { return 0.1 * ((x * 7 + y * 13) % 5 - 2) / 2.0; };
  EXPECT_LT(OutlineErrorOf([&](int x, int y) { return LightShareAt(x, y) + grain(x, y); }), 0.03);
}

TEST(OutlineError, AHaloOfTheBackgroundIsAnError) {
  GuideSet guides(kOutlineSize, kOutlineSize);
  guides.Add(Layer::kCoverage);
  Picture clean(kOutlineSize, kOutlineSize), halo(kOutlineSize, kOutlineSize);
  for (int y = 0; y < kOutlineSize; ++y) {
    for (int x = 40; x < kOutlineSize; ++x) {
      guides.Plane(Layer::kCoverage)[guides.Index(x, y)] = x == 40 ? 0.25f : 1.0f;
      for (Picture* const picture : {&clean, &halo}) {
        picture->At(x, y)[3] = std::uint16_t(x == 40 ? 16384 : 65535);
      }
    }
    halo.At(39, y)[3] = 30000;
  }
  const auto exact = MeasureOutlines(clean, guides), off = MeasureOutlines(halo, guides);
  ASSERT_TRUE(exact.ok() && off.ok());
  EXPECT_LT(exact->error, 0.001);
  // One column of three is 0.46 off.
  EXPECT_NEAR(off->error, 30000.0 / 65535.0 / std::sqrt(3.0), 0.005);
}

TEST(OutlineError, SaysWhatItCannotMeasure) {
  EXPECT_FALSE(MeasureOutlines(Picture(3, 3), TwoSides()).ok());
  GuideSet guides(kOutlineSize, kOutlineSize);
  guides.Add(Layer::kCoverage);
  const auto nothing = MeasureOutlines(Picture(kOutlineSize, kOutlineSize), guides);
  ASSERT_TRUE(nothing.ok());
  EXPECT_EQ(nothing->pixels, 0u);
  EXPECT_EQ(nothing->error, 0.0);
}

TEST(OutlineError, ThreadsDoNotMatter) {
  const Picture picture = LightBy([](int x, int y) { return LightShareAt(x, y, 0.3); });
  EXPECT_EQ(MeasureOutlines(picture, TwoSides(), 1)->error, MeasureOutlines(picture, TwoSides(), 3)->error);
}

}  // namespace
}  // namespace scumble::testing
