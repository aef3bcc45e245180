// Edges that follow the flow, and their colours.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "tests/finish/finish_fixtures.h"
#include "tests/support/every_instruction_set.h"

namespace scumble {
namespace {

EdgesPass FlowOfPaint(double flow) {
  EdgesPass pass;
  pass.tone = EdgesPass::Tone::kPaint, pass.ink = {0, 0, 0}, pass.flow = flow;
  return pass;
}

// A disc, 0.16 darker than the rest, under noise of up to ± 0.06 of lightness.
Picture NoisyDisc(int size) {
  Picture picture(size, size);
  std::uint32_t state = 12345;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      state = state * 1664525u + 1013904223u;
      const double noise = 0.12 * (double(state >> 8) / double(1 << 24) - 0.5);
      const double off = std::hypot(x + 0.5 - size / 2.0, y + 0.5 - size / 2.0) - size * 0.3;
      const double lightness = 0.6 + 0.08 * std::clamp(off, -1.0, 1.0) + noise;
      std::fill_n(picture.At(x, y), 3, Srgb16FromLinear(static_cast<float>(lightness * lightness * lightness)));
      picture.At(x, y)[3] = 65535;
    }
  }
  return picture;
}

// Connected pieces of pixels, corners included, that `made` has at less than two thirds of the code before.
int InkPieces(const Picture& given, const Picture& made) {
  const int width = given.width, height = given.height;
  std::vector<char> is_open(std::size_t(width * height));
  const auto at = [&](int x, int y) -> char& { return is_open[std::size_t(y * width + x)]; };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) at(x, y) = 3 * made.At(x, y)[0] < 2 * given.At(x, y)[0];
  }
  int pieces = 0;
  std::vector<std::pair<int, int>> stack;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!at(x, y)) continue;
      ++pieces;
      at(x, y) = 0, stack.emplace_back(x, y);
      while (!stack.empty()) {
        const auto [u, v] = stack.back();
        stack.pop_back();
        for (int q = std::max(0, v - 1); q <= std::min(height - 1, v + 1); ++q) {
          for (int p = std::max(0, u - 1); p <= std::min(width - 1, u + 1); ++p) {
            if (at(p, q)) at(p, q) = 0, stack.emplace_back(p, q);
          }
        }
      }
    }
  }
  return pieces;
}

TEST(EdgesFlow, ACircleUnderNoiseBreaksIntoFewerPieces) {
  const Picture given = NoisyDisc(160);
  const auto pieces = [&](double along) {
    EdgesPass pass = FlowOfPaint(along);
    pass.sharpness = 26.0;
    return InkPieces(given, Finished(StepOf(pass), nullptr, given));
  };
  const int plain = pieces(0.0), flow = pieces(4.0);
  EXPECT_GT(flow, 0);
  EXPECT_LT(3 * flow, plain);
}

TEST(EdgesFlow, EvenToneHasNoLine) {
  const Picture picture = PlainPicture(40, 20, 50000, 20000, 3000);
  EXPECT_EQ(Finished(StepOf(FlowOfPaint(3.0)), nullptr, picture).rgba, picture.rgba);
}

// Far from the picture's edge a straight step is all that is along it: flow changes nothing.
TEST(EdgesFlow, OfAStraightStepIsThePlainOne) {
  Picture given(80, 40);
  for (std::size_t i = 0; i < given.rgba.size(); i += 4) {
    std::fill_n(&given.rgba[i], 3, static_cast<std::uint16_t>(i / 4 % 80 < 40 ? 20000 : 36000));
    given.rgba[i + 3] = 65535;
  }
  const Picture plain = Finished(StepOf(FlowOfPaint(0.0)), nullptr, given);
  const Picture flow = Finished(StepOf(FlowOfPaint(3.0)), nullptr, given);
  EXPECT_NE(plain.rgba, given.rgba);
  for (std::size_t i = 0; i < given.rgba.size(); ++i) ASSERT_NEAR(flow.rgba[i], plain.rgba[i], 60) << i;
}

TEST(EdgesFlow, TurnsWithThePicture) {
  const Picture given = NoisyDisc(61);
  const auto turned = [](const Picture& picture) {
    Picture out(picture.height, picture.width);
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) std::copy_n(picture.At(x, y), 4, out.At(picture.height - 1 - y, x));
    }
    return out;
  };
  const Picture made = turned(Finished(StepOf(FlowOfPaint(3.0)), nullptr, given));
  const Picture other = Finished(StepOf(FlowOfPaint(3.0)), nullptr, turned(given));
  int differ = 0;
  for (std::size_t i = 0; i < made.rgba.size(); ++i) differ += std::abs(made.rgba[i] - other.rgba[i]) > 400;
  EXPECT_LT(differ, 40);  // pixels in which a curve lies on the border between two, and rounds otherwise
}

TEST(EdgesFlow, SameBytesOnAnyThreadsAndInstructionSet) {
  const Picture given = NoisyDisc(75);
  for (const double flow : {0.0, 3.0}) {
    const Picture made = Finished(StepOf(FlowOfPaint(flow)), nullptr, given, {}, 1);
    EXPECT_EQ(Finished(StepOf(FlowOfPaint(flow)), nullptr, given, {}, 3).rgba, made.rgba);
    testing::OnEveryInstructionSet(
        [&] { EXPECT_EQ(Finished(StepOf(FlowOfPaint(flow)), nullptr, given).rgba, made.rgba); });
  }
}

TEST(EdgesFlow, AnySize) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {9, 2}, {40, 33}}) {
    const Picture given = ColorfulPicture(width, height);
    EXPECT_EQ(Finished(StepOf(FlowOfPaint(16.0)), nullptr, given).rgba.size(), given.rgba.size());
  }
}

// A fully inked pixel: a third as light and half as colourful as it was, of its hue or of the opposite one.
TEST(EdgesColor, IsThatOfThePaint) {
  EdgesPass pass = FlowOfPaint(0.0);
  pass.fill = 1.0, pass.threshold = 1.0, pass.slope = 100.0;
  const Picture given = PlainPicture(8, 8, 40000, 12000, 5000);
  const auto lab = [](const Picture& picture) {
    const std::uint16_t* const texel = picture.At(4, 4);
    return OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])});
  };
  const glm::vec3 before = lab(given);
  pass.color = OutlinePass::Color::kPaint;
  const glm::vec3 paint = lab(Finished(StepOf(pass), nullptr, given));
  pass.color = OutlinePass::Color::kComplement;
  const glm::vec3 complement = lab(Finished(StepOf(pass), nullptr, given));
  EXPECT_NEAR(paint.x, before.x / 3.0f, 1e-3);
  EXPECT_NEAR(complement.x, before.x / 3.0f, 1e-3);
  // Dark colours have less chroma in sRGB: the hue counts.
  EXPECT_NEAR(std::atan2(paint.z, paint.y), std::atan2(before.z, before.y), 0.04);
  EXPECT_NEAR(std::atan2(-complement.z, -complement.y), std::atan2(before.z, before.y), 0.04);
}

}  // namespace
}  // namespace scumble
