// Outlines: suggestive contours, gaps, and lines by distance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

std::vector<double> ShareOfInk(const OutlinePass& pass, const GuideSet& guides, int threads = 0, double scale = 1.0) {
  const Picture drawn = Finished(StepOf(pass), &guides, Picture(guides.width(), guides.height()), {}, threads, scale);
  std::vector<double> ink;
  for (std::size_t i = 3; i < drawn.rgba.size(); i += 4) ink.push_back(drawn.rgba[i] / 65535.0);
  return ink;
}

double Total(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

OutlinePass SuggestiveAlone() {
  OutlinePass pass;
  pass.of_class = {};
  pass.of_class[std::size_t(LineClass::kSuggestive)] = 1.0;
  pass.width = 3.0;
  return pass;
}

// A surface that turns away from the viewer towards `middle` and back: the angle between normal and view is
// 0.2 + exp(-(d / 12)²), d across the valley.
float ValleyAngle(float d) { return 0.2f + std::exp(-d * d / 144.0f); }

GuideSet ValleyGuides(float middle, glm::vec2 across) {
  return GuidesOf(120, 120, [=](glm::vec2 at) {
    const float d = glm::dot(at - glm::vec2(60.0f), across) - (middle - 60.0f), angle = ValleyAngle(d);
    return SeenPoint{true, {std::sin(angle) * across.x, -std::sin(angle) * across.y, std::cos(angle)}, 5.0f, 1.0f};
  });
}

TEST(Suggestive, RunsWhereTheCosineIsLeast) {
  for (const glm::vec2 across : {glm::vec2(1, 0), glm::vec2(0, 1), glm::vec2(0.6f, 0.8f), glm::vec2(-0.8f, 0.6f)}) {
    const std::vector<double> ink = ShareOfInk(SuggestiveAlone(), ValleyGuides(63.3f, across));
    double weight = 0.0, weighted = 0.0;
    for (int y = 30; y < 90; ++y) {
      for (int x = 30; x < 90; ++x) {
        const double d = glm::dot(glm::vec2(float(x) + 0.5f, float(y) + 0.5f) - glm::vec2(60.0f), across);
        weight += ink[std::size_t(y) * 120 + std::size_t(x)];
        weighted += ink[std::size_t(y) * 120 + std::size_t(x)] * d;
        if (std::fabs(d - 3.3) > 3.0) {
          EXPECT_EQ(ink[std::size_t(y) * 120 + std::size_t(x)], 0.0) << x << ' ' << y;
        }
      }
    }
    EXPECT_NEAR(weighted / weight, 3.3, 0.5) << across.x;
    EXPECT_GT(weight, 0.95 * 3.0 * 60.0) << across.x;
  }
}

TEST(Suggestive, OfDeepValleysAlone) {
  OutlinePass pass = SuggestiveAlone();
  const double depth = std::cos(ValleyAngle(8.0f)) - std::cos(ValleyAngle(0.0f));
  const GuideSet guides = ValleyGuides(60.5f, {1, 0});
  pass.suggestive_depth = depth - 0.01;
  EXPECT_GT(Total(ShareOfInk(pass, guides)), 300.0);
  pass.suggestive_depth = depth + 0.01;
  EXPECT_EQ(Total(ShareOfInk(pass, guides)), 0.0);
}

TEST(Suggestive, NoneOnABallAndNoneAcrossObjects) {
  EXPECT_EQ(Total(ShareOfInk(SuggestiveAlone(), BallGuides(160, 60.0f))), 0.0);
  GuideSet guides = ValleyGuides(60.5f, {1, 0});
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (i % 120 >= 62) guides.Plane(Layer::kObject)[i] = 2.0f;
  }
  EXPECT_EQ(Total(ShareOfInk(SuggestiveAlone(), guides)), 0.0);
}

// The cosine is that to the viewer, not to the axis of the view, whose least is more than a pixel aside here.
TEST(Suggestive, KnowsPerspective) {
  const auto angle_of_ray = [](float x) { return std::atan(2.0f * x / 120.0f - 1.0f); };
  GuideSet guides = GuidesOf(120, 9, [&](glm::vec2 at) {
    const float angle = ValleyAngle(at.x - 60.5f) - angle_of_ray(at.x);
    return SeenPoint{true, {std::sin(angle), 0.0f, std::cos(angle)}, 5.0f, 1.0f};
  });
  const auto place = [&] {
    const std::vector<double> ink = ShareOfInk(SuggestiveAlone(), guides);
    double weight = 0.0, weighted = 0.0;
    for (std::size_t x = 0; x < 120; ++x) weight += ink[4 * 120 + x], weighted += ink[4 * 120 + x] * (double(x) + 0.5);
    return weighted / weight;
  };
  EXPECT_GT(std::fabs(place() - 60.5), 1.0) << "without a camera";
  GuideCamera camera;
  camera.clip_from_view = glm::dmat4(0.0);
  camera.clip_from_view[0][0] = 1.0, camera.clip_from_view[1][1] = 120.0 / 9.0;
  camera.clip_from_view[2][2] = -1.0, camera.clip_from_view[2][3] = -1.0, camera.clip_from_view[3][2] = -0.2;
  guides.camera = camera;
  EXPECT_NEAR(place(), 60.5, 0.51);
  const double turned = place();
  guides.attributes["scumble:normal_frame"] = "eye";
  EXPECT_GT(std::fabs(place() - turned), 0.9) << "normals that are turned to the eye already";
}

TEST(Gaps, LeaveOutTheirShare) {
  OutlinePass pass;
  pass.width = 4.0, pass.gap_length = 6.0;
  const GuideSet guides = BallGuides(520, 240.0f);
  const double whole = Total(ShareOfInk(pass, guides));
  for (const double gaps : {0.2, 0.5}) {
    pass.gaps = gaps;
    EXPECT_NEAR(Total(ShareOfInk(pass, guides)) / whole, 1.0 - gaps, 0.1) << gaps;
  }
  pass.gaps = 1.0;
  EXPECT_EQ(Total(ShareOfInk(pass, guides)), 0.0);
}

// By the definition, pixel by pixel.
TEST(LineField, IsThatOfBruteForce) {
  GuideSet guides = GuidesOf(70, 50, [](glm::vec2 at) { return SeenOnBall(at, {33, 26}, 17.0f, 5.0f, 1.0f); });
  OutlinePass pass;
  pass.form = OutlinePass::Form::kField;
  const auto coverage = guides.Plane(Layer::kCoverage);
  const auto covers = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < 70 && y < 50 && coverage[guides.Index(x, y)] > 0.0f;
  };
  for (const double width : {0.5, 2.5, 9.0}) {
    pass.width = width, pass.min_width = 0.0;
    const std::vector<double> ink = ShareOfInk(pass, guides);
    for (int y = 0; y < 50; ++y) {
      for (int x = 0; x < 70; ++x) {
        double nearest = 1e9;
        for (int v = 0; v < 50; ++v) {
          for (int u = 0; u < 70; ++u) {
            const bool c = covers(u, v);
            const auto differs = [&](int a, int b) {
              return a >= 0 && b >= 0 && a < 70 && b < 50 && covers(a, b) != c;
            };
            if (!differs(u - 1, v) && !differs(u + 1, v) && !differs(u, v - 1) && !differs(u, v + 1)) continue;
            const double d = std::hypot(x - u, y - v);
            nearest = std::min(nearest, d);
          }
        }
        const double off = nearest + 0.5;
        const double expected = std::clamp(std::max(width, 1.0) / 2.0 + 0.5 - off, 0.0, 1.0) * std::min(width, 1.0);
        ASSERT_NEAR(ink[std::size_t(y) * 70 + std::size_t(x)], expected, 2e-5) << width << " at " << x << ' ' << y;
      }
    }
  }
}

TEST(LineField, KnowsNoSides) {
  OutlinePass pass;
  pass.form = OutlinePass::Form::kField, pass.side = OutlinePass::Side::kInside;
  const GuideSet guides = BallGuides(40, 12.0f);
  const FinishStep step = StepOf(pass);
  const Status done = CheckFinish(std::span(&step, 1), &guides);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("set finish.it.side to \"centre\""), std::string::npos);
}

TEST(LineField, RingHasTheWidthOfStrokes) {
  OutlinePass pass;
  pass.form = OutlinePass::Form::kField;
  const GuideSet guides = BallGuides(220, 80.0f);
  for (const double width : {3.0, 8.0, 20.0}) {
    pass.width = width;
    EXPECT_NEAR(Total(ShareOfInk(pass, guides)) / (2.0 * std::numbers::pi * 80.0 * width), 1.0, 0.03 + 0.2 / width)
        << width;
  }
  pass.width = 8.0;
  EXPECT_EQ(ShareOfInk(pass, guides, 1), ShareOfInk(pass, guides, 4));
  EXPECT_EQ(ShareOfInk(pass, guides, 1, 2.0).size(), guides.pixel_count());
}

TEST(OutlineForms, WithoutNumbersTheyDrawNothing) {
  GuideSet guides = ValleyGuides(60.5f, {1, 0});
  for (const Layer layer : {Layer::kNormal, Layer::kDepth}) {
    for (int c = 0; c < ChannelCount(layer); ++c) {
      for (float& value : guides.Plane(layer, c)) value = std::nanf("");
    }
  }
  EXPECT_EQ(Total(ShareOfInk(SuggestiveAlone(), guides)), 0.0);
  OutlinePass pass = SuggestiveAlone();
  pass.form = OutlinePass::Form::kField;
  EXPECT_EQ(Total(ShareOfInk(pass, guides)), 0.0);
  EXPECT_EQ(ShareOfInk(pass, GuidesOf(1, 1,
                                      [](glm::vec2) {
                                        return SeenPoint{true, {0, 0, 1}, 5.0f, 1.0f};
                                      }))
                .size(),
            1u);
}

}  // namespace
}  // namespace scumble
