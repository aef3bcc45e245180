// Guides of a larger picture from those of a small one: areas, edges, and layers that must not mix.
#include "transfer/upsample_guides.h"

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "core/image/fragments.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

GuideSet Upsampled(const GuideSet& guides, int factor, int threads = 0) {
  auto larger = UpsampleGuides(guides, factor, threads);
  EXPECT_TRUE(larger.ok());
  return std::move(*larger);
}

// Coverage of a shape: the share of 16 × 16 points of each pixel, `scale` pixels to the unit, that lie in it.
std::vector<float> CoverageOf(const std::function<bool(double, double)>& inside, int width, int height, double scale) {
  std::vector<float> coverage(std::size_t(width) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      int hits = 0;
      for (int k = 0; k < 256; ++k)
        hits += inside((x + (k % 16 + 0.5) / 16) / scale, (y + (k / 16 + 0.5) / 16) / scale);
      coverage[std::size_t(y) * width + x] = static_cast<float>(hits) / 256.0f;
    }
  }
  return coverage;
}

GuideSet WithCoverage(const std::vector<float>& coverage, int width, int height) {
  GuideSet guides = MakeGuides(width, height, [&](int x, int y) {
    return coverage[std::size_t(y) * width + x] > 0.0f ? glm::vec3(0, 0, 1) : glm::vec3(0.0f);
  });
  std::copy(coverage.begin(), coverage.end(), guides.Plane(Layer::kCoverage).begin());
  return guides;
}

double MeanDifference(std::span<const float> a, std::span<const float> b) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(b[i] > 0.0f && b[i] < 1.0f) && !(a[i] > 0.0f && a[i] < 1.0f) && a[i] == b[i]) continue;
    sum += std::fabs(a[i] - b[i]), count += 1.0;
  }
  return sum / count;
}

TEST(UpsampleGuides, CoverageKeepsItsArea) {
  const int width = 37, height = 29;
  std::vector<float> coverage(std::size_t(width) * height);
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    const std::uint64_t hash = Hash(i);
    coverage[i] = hash % 3 == 0 ? 0.0f : hash % 3 == 1 ? 1.0f : static_cast<float>(Mix64(hash) % 17) / 16.0f;
  }
  const GuideSet guides = WithCoverage(coverage, width, height);
  for (const int factor : {2, 3, 4, 8}) {
    const GuideSet larger = Upsampled(guides, factor);
    ASSERT_EQ(larger.width(), width * factor);
    ASSERT_EQ(larger.height(), height * factor);
    EXPECT_TRUE(larger.Validate("larger").ok());
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double sum = 0.0;
        for (int k = 0; k < factor * factor; ++k) {
          const float a =
              larger.Plane(Layer::kCoverage)[larger.Index(x * factor + k % factor, y * factor + k / factor)];
          ASSERT_TRUE(a >= 0.0f && a <= 1.0f);
          sum += a;
        }
        ASSERT_NEAR(sum / (factor * factor), coverage[guides.Index(x, y)], 1e-5) << x << ", " << y;
      }
    }
  }
}

TEST(UpsampleGuides, AntialiasedSilhouettesComeOutSmooth) {
  const auto half_plane = [](double x, double y) { return 0.83 * x + 0.31 * y < 21.0; };
  const auto disc = [](double x, double y) { return (x - 20) * (x - 20) + (y - 16) * (y - 16) < 150; };
  for (const std::function<bool(double, double)>& shape : {std::function<bool(double, double)>(half_plane), {disc}}) {
    const GuideSet guides = WithCoverage(CoverageOf(shape, 40, 32, 1.0), 40, 32);
    for (const int factor : {2, 4}) {
      const GuideSet larger = Upsampled(guides, factor);
      const std::vector<float> truth = CoverageOf(shape, 40 * factor, 32 * factor, factor);
      std::vector<float> blocks(truth.size());  // each pixel's own, repeated
      for (std::size_t i = 0; i < blocks.size(); ++i) {
        const int x = static_cast<int>(i) % (40 * factor) / factor, y = static_cast<int>(i) / (40 * factor) / factor;
        blocks[i] = guides.Plane(Layer::kCoverage)[guides.Index(x, y)];
      }
      const double error = MeanDifference(larger.Plane(Layer::kCoverage), truth);
      EXPECT_LT(error, 0.55 * MeanDifference(blocks, truth)) << factor;
      EXPECT_LT(error, 0.11) << factor;
    }
  }
}

// Objects 1, 2 and 3 by a function of the place, the first where the others are not; all layers that may scale.
GuideSet WithBorders(const std::function<int(double, double)>& object, int width, int height, double scale) {
  std::vector<std::vector<float>> coverage;
  for (int id = 1; id <= 3; ++id) {
    coverage.push_back(CoverageOf([&](double x, double y) { return object(x, y) == id; }, width, height, scale));
  }
  GuideSet guides = MakeGuides(width, height, [](int, int) { return glm::vec3(0, 0, 1); });
  guides.Add(Layer::kMotion);
  auto fragments = std::make_shared<Fragments>();
  std::vector<std::pair<int, float>> values;  // object and coverage
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = guides.Index(x, y);
      const int centre = object((x + 0.5) / scale, (y + 0.5) / scale);
      guides.Plane(Layer::kObject)[i] = static_cast<float>(centre);
      for (int id = 1; id <= 3; ++id) {
        const float share = coverage[std::size_t(id - 1)][i];
        if (id == centre || !(share > 0.0f)) continue;
        fragments->pixel.push_back(static_cast<std::uint32_t>(i)), values.emplace_back(id, share);
      }
    }
  }
  fragments->values = MakeGuides(static_cast<int>(values.size()), 1, [](int, int) { return glm::vec3(0, 0, 1); });
  fragments->values.Add(Layer::kMotion);
  for (std::size_t f = 0; f < values.size(); ++f) {
    fragments->values.Plane(Layer::kObject)[f] = static_cast<float>(values[f].first);
    fragments->values.Plane(Layer::kCoverage)[f] = values[f].second;
    fragments->values.Plane(Layer::kMotion, 1)[f] = static_cast<float>(f);
  }
  guides.fragments = std::move(fragments);
  return guides;
}

// A plane of one object's coverage, its share of every pixel.
std::vector<float> CoverageOfObject(const GuideSet& guides, float id) {
  const Fragments& fragments = *guides.fragments;
  std::vector<float> share(guides.pixel_count());
  for (std::size_t i = 0; i < share.size(); ++i) {
    share[i] = guides.Plane(Layer::kObject)[i] == id ? guides.Plane(Layer::kCoverage)[i] : 0.0f;
  }
  for (std::size_t f = 0; f < fragments.count(); ++f) {
    const float coverage = fragments.values.Plane(Layer::kCoverage)[f];
    const std::uint32_t pixel = fragments.pixel[f];
    if (guides.Plane(Layer::kObject)[pixel] == id) share[pixel] -= coverage;
    if (fragments.values.Plane(Layer::kObject)[f] == id) share[pixel] += coverage;
  }
  return share;
}

TEST(UpsampleGuides, BordersBetweenObjectsComeOutSmooth) {
  const auto ring = [](double x, double y) {
    const double r = std::hypot(x - 20.0, y - 15.0);
    return r < 8.0 ? 1 : r < 11.0 ? 2 : 3;
  };
  const GuideSet guides = WithBorders(ring, 40, 30, 1.0);
  for (const int factor : {2, 3, 4, 8}) {
    const GuideSet larger = Upsampled(guides, factor);
    ASSERT_TRUE(larger.fragments);
    EXPECT_TRUE(larger.Validate("larger").ok());
    for (int id = 1; id <= 3; ++id) {
      const std::vector<float> share = CoverageOfObject(larger, static_cast<float>(id));
      const auto truth =
          CoverageOf([&](double x, double y) { return ring(x, y) == id; }, 40 * factor, 30 * factor, factor);
      std::vector<float> steps(share.size());  // as without fragments
      for (std::size_t i = 0; i < steps.size(); ++i) {
        steps[i] = larger.Plane(Layer::kObject)[i] == static_cast<float>(id) ? 1.0f : 0.0f;
      }
      const double smooth = MeanDifference(share, truth);
      EXPECT_LT(smooth, factor < 8 ? 0.12 : 0.15) << factor << ", " << id;
      EXPECT_LT(smooth, 0.4 * MeanDifference(steps, truth)) << factor << ", " << id;
    }
  }
}

TEST(UpsampleGuides, FragmentsKeepTheirAreaAndValues) {
  // Fans of the three objects, so that many pixels show all of them.
  const GuideSet guides = WithBorders(
      [](double x, double y) { return 1 + static_cast<int>(std::floor(30.0 + 0.9 * x + 0.4 * y * std::sin(x))) % 3; },
      24, 18, 1.0);
  const Fragments& small = *guides.fragments;
  for (const int factor : {1, 2, 5}) {
    const GuideSet larger = Upsampled(guides, factor);
    ASSERT_TRUE(larger.Validate("larger").ok());
    const Fragments& large = *larger.fragments;
    EXPECT_EQ(large.values.layers(), small.values.layers());
    std::vector<double> mean(small.count());
    for (std::size_t f = 0; f < large.count(); ++f) {
      const int x = static_cast<int>(large.pixel[f]) % larger.width() / factor;
      const int y = static_cast<int>(large.pixel[f]) / larger.width() / factor;
      const std::size_t from = small.From(guides.Index(x, y));
      std::size_t same = from;
      while (same < small.count() && small.values.Plane(Layer::kObject)[same] != large.values.Plane(Layer::kObject)[f])
        ++same;
      ASSERT_LT(same, small.count());
      ASSERT_EQ(small.pixel[same], guides.Index(x, y));
      EXPECT_EQ(large.values.Plane(Layer::kMotion, 1)[f],
                small.values.Plane(Layer::kMotion, 1)[same] * static_cast<float>(factor));
      mean[same] += large.values.Plane(Layer::kCoverage)[f] / (factor * factor);
    }
    double lost = 0.0, sum = 0.0;
    for (std::size_t f = 0; f < mean.size(); ++f) {
      const double coverage = small.values.Plane(Layer::kCoverage)[f];
      EXPECT_LE(mean[f], coverage + 1e-5) << f;
      const bool is_alone = (f == 0 || small.pixel[f - 1] != small.pixel[f]) &&
                            (f + 1 == mean.size() || small.pixel[f + 1] != small.pixel[f]);
      if (is_alone) {
        EXPECT_NEAR(mean[f], coverage, 1e-5) << f;
      }
      lost += coverage - mean[f], sum += coverage;
    }
    EXPECT_LT(lost, 0.02 * sum) << "where several surfaces meet";
  }
}

TEST(UpsampleGuides, AThinWireStaysWhereItIs) {
  std::vector<float> coverage(21 * 15, 0.0f);
  for (int y = 0; y < 15; ++y) coverage[std::size_t(y) * 21 + 9] = 0.3f;
  GuideSet guides = WithCoverage(coverage, 21, 15);
  const GuideSet larger = Upsampled(guides, 4);
  for (int y = 0; y < larger.height(); ++y) {
    double sum = 0.0;
    for (int x = 0; x < larger.width(); ++x) {
      const std::size_t i = larger.Index(x, y);
      const float a = larger.Plane(Layer::kCoverage)[i];
      EXPECT_TRUE(!(a > 0.0f) || (x / 4 == 9 && larger.Plane(Layer::kObject)[i] == 1.0f));
      sum += a;
    }
    EXPECT_NEAR(sum, 4 * 0.3, 1e-4) << y;
  }
}

TEST(UpsampleGuides, WhatIsLinearOnASurfaceStaysLinear) {
  GuideSet guides = MakeGuides(24, 20, [](int, int) { return glm::vec3(0, 0, 1); });
  for (const Layer layer : {Layer::kAlbedo, Layer::kMotion, Layer::kMaterial}) guides.Add(layer);
  const auto linear = [](double x, double y) { return 20.0 + 0.25 * x - 0.125 * y; };
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 24; ++x) {
      const std::size_t i = guides.Index(x, y);
      const float value = static_cast<float>(linear(x + 0.5, y + 0.5));
      guides.Plane(Layer::kDepth)[i] = guides.Plane(Layer::kAlbedo, 1)[i] = guides.Plane(Layer::kMotion)[i] = value;
      guides.Plane(Layer::kMaterial)[i] = static_cast<float>(1 + (x * 7 + y) % 5);
    }
  }
  for (const int factor : {2, 3, 8}) {
    const GuideSet larger = Upsampled(guides, factor);
    // At the picture's edge a slope looks like a step.
    for (int y = 2 * factor; y < larger.height() - 2 * factor; ++y) {
      for (int x = 2 * factor; x < larger.width() - 2 * factor; ++x) {
        const std::size_t i = larger.Index(x, y);
        const double value = linear((x + 0.5) / factor, (y + 0.5) / factor);
        ASSERT_NEAR(larger.Plane(Layer::kDepth)[i], value, 1e-4);
        ASSERT_NEAR(larger.Plane(Layer::kAlbedo, 1)[i], value, 1e-4);
        ASSERT_NEAR(larger.Plane(Layer::kMotion)[i], factor * value, 1e-3) << "in the larger picture's pixels";
        ASSERT_EQ(larger.Plane(Layer::kMaterial)[i],
                  guides.Plane(Layer::kMaterial)[guides.Index(x / factor, y / factor)]);
        ASSERT_NEAR(glm::length(larger.Vec3(Layer::kNormal, i)), 1.0, 1e-6);
      }
    }
  }
}

TEST(UpsampleGuides, NormalsOfARoundFormFollowIt) {
  const GuideSet larger = Upsampled(SphereGuides(60), 2), truth = SphereGuides(120);
  double worst = 0.0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 120; ++x) {
      const std::size_t i = truth.Index(x, y);
      const double dx = x - 59.5, dy = y - 59.5;
      if (dx * dx + dy * dy > 50 * 50) continue;
      worst = std::max(worst, double(glm::length(larger.Vec3(Layer::kNormal, i) - truth.Vec3(Layer::kNormal, i))));
    }
  }
  EXPECT_LT(worst, 0.004);  // repeated pixels are off by up to 0.02 and more
}

// Left half and right half differ; nothing between them may appear.
void ExpectNoMixture(const std::function<void(GuideSet&, std::size_t, bool right)>& set, Layer layer) {
  GuideSet guides = MakeGuides(16, 12, [](int, int) { return glm::vec3(0, 0, 1); });
  guides.Add(Layer::kLuminance);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 16; ++x) {
      set(guides, guides.Index(x, y), x >= 8);
      guides.Plane(Layer::kLuminance)[guides.Index(x, y)] = x >= 8 ? 0.75f : 0.25f;
    }
  }
  const GuideSet larger = Upsampled(guides, 4);
  for (std::size_t i = 0; i < larger.pixel_count(); ++i) {
    const bool right = i % 64 >= 32;
    ASSERT_EQ(larger.Plane(Layer::kLuminance)[i], right ? 0.75f : 0.25f) << i % 64;
    ASSERT_NEAR(larger.Plane(layer)[i], guides.Plane(layer)[right ? 8 : 0], 1e-6) << i % 64;
  }
}

TEST(UpsampleGuides, NothingMixesAcrossObjectsDepthStepsAndCreases) {
  ExpectNoMixture([](GuideSet& g, std::size_t i, bool right) { g.Plane(Layer::kObject)[i] = right ? 2.0f : 7.0f; },
                  Layer::kObject);
  ExpectNoMixture([](GuideSet& g, std::size_t i, bool right) { g.Plane(Layer::kDepth)[i] = right ? 10.0f : 11.0f; },
                  Layer::kDepth);
  ExpectNoMixture(
      [](GuideSet& g, std::size_t i, bool right) {
        g.Plane(Layer::kNormal, 0)[i] = right ? 0.8f : -0.8f, g.Plane(Layer::kNormal, 2)[i] = 0.6f;
      },
      Layer::kNormal);
}

TEST(UpsampleGuides, EveryGuideSetWillDo) {
  GuideSet one(1, 1);
  one.Add(Layer::kCoverage), one.Add(Layer::kNormal);
  one.Plane(Layer::kCoverage)[0] = 0.5f, one.Plane(Layer::kNormal, 2)[0] = 1.0f;
  one.object_names[5] = "ball", one.attributes["generator"] = "test";
  const GuideSet larger = Upsampled(one, 8);
  EXPECT_EQ(larger.width(), 8);
  EXPECT_EQ(larger.object_names, one.object_names);
  EXPECT_EQ(larger.attributes, one.attributes);
  EXPECT_FALSE(larger.Has(Layer::kDepth));
  for (std::size_t i = 0; i < larger.pixel_count(); ++i) EXPECT_NEAR(larger.Plane(Layer::kCoverage)[i], 0.5f, 1e-6);
  const GuideSet same = Upsampled(one, 1);
  EXPECT_EQ(same.width(), 1);
  GuideSet background(5, 4);
  background.Add(Layer::kCoverage), background.Add(Layer::kDepth);
  const GuideSet nothing = Upsampled(background, 3);
  for (const float depth : nothing.Plane(Layer::kDepth)) EXPECT_TRUE(std::isinf(depth));
  const GuideSet wide(5000, 1);
  const auto refused = UpsampleGuides(wide, 8);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
}

TEST(UpsampleGuides, ThreadsDoNotChangeAByte) {
  const GuideSet guides = HillGuides(61, 47);
  const GuideSet one = Upsampled(guides, 3, 1), three = Upsampled(guides, 3, 3);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) {
    for (int c = 0; c < ChannelCount(layer); ++c) {
      EXPECT_TRUE(std::ranges::equal(one.Plane(layer, c), three.Plane(layer, c)));
    }
  }
}

// Sides of at most 32768 pixels, 2^28 pixels in all, as everywhere.
TEST(CheckLargerSize, KnowsTheLargestPicture) {
  EXPECT_TRUE(CheckLargerSize(8192, 8192, 2).ok());
  EXPECT_TRUE(CheckLargerSize(16384, 1, 2).ok());
  for (const auto& [width, height, factor] : {std::array{8192, 8193, 2}, {16385, 1, 2}, {1, 8192, 8}}) {
    const Status status = CheckLargerSize(width, height, factor);
    ASSERT_FALSE(status.ok()) << width << "x" << height << " by " << factor;
    EXPECT_NE(status.error().message.find("take a smaller factor"), std::string::npos);
  }
}

}  // namespace
}  // namespace scumble
