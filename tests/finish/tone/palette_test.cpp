// Palettes by example: means and covariances against their definition.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

// Colours well inside sRGB, around a mean, spread along an axis and less across it.
Picture SoftColors(glm::vec3 mean, glm::vec3 axis, float across) {
  Picture picture(64, 48);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float s = static_cast<float>((x * 37 + y * 11) % 64) / 63.0f - 0.5f;
      const float t = static_cast<float>((x * 5 + y * 29) % 48) / 47.0f - 0.5f;
      const glm::vec3 lab = mean + axis * s + across * glm::vec3(0.3f, 0.5f, -0.4f) * t;
      const glm::vec3 linear = LinearFromOklab(lab);
      for (int c = 0; c < 3; ++c) picture.At(x, y)[c] = Srgb16FromLinear(linear[c]);
      picture.At(x, y)[3] = 65535;
    }
  }
  return picture;
}

const Picture& Warm() {
  static const Picture picture = SoftColors({0.62f, 0.06f, 0.05f}, {0.2f, 0.04f, 0.02f}, 0.05f);
  return picture;
}
const Picture& Cold() {
  static const Picture picture = SoftColors({0.5f, -0.02f, -0.04f}, {0.15f, 0.0f, 0.03f}, 0.05f);
  return picture;
}

FinishStep LikeStep(const Picture& target, double gain = 16.0) {
  PalettePass pass;
  pass.gain = gain;
  pass.target = MeasureColors(target);
  return StepOf(pass);
}

// A sequence is measured once: what is seen in later frames does not move the colours of all others.
TEST(Palette, KeepsTheColorsThatItHasMeasured) {
  std::optional<ColorSpread> colors;
  FinishStep step = LikeStep(Cold());
  step.colors = &colors;
  const Picture first = Finished(step, nullptr, Warm());
  ASSERT_TRUE(colors);
  EXPECT_EQ(colors->mean[0], AsPrinted(colors->mean[0])) << "as a run prints it";
  Picture later = Warm();
  std::fill_n(later.rgba.begin(), later.rgba.size() / 4, std::uint16_t(0xffff));  // something white comes in
  const Picture with_it = Finished(step, nullptr, later);
  const auto rest = std::ptrdiff_t(first.rgba.size() / 2);
  EXPECT_TRUE(std::equal(first.rgba.begin() + rest, first.rgba.end(), with_it.rgba.begin() + rest));
  FinishStep given = LikeStep(Cold());
  std::get<PalettePass>(given.pass.effect).source = colors;
  EXPECT_EQ(Finished(given, nullptr, later).rgba, with_it.rgba);
  step.colors = nullptr;
  EXPECT_NE(Finished(step, nullptr, later).rgba, with_it.rgba) << "the test could not fail";
}

TEST(Palette, MeasuresMeanAndCovariance) {
  const Picture picture = Warm();
  std::array<double, 3> mean{};
  std::vector<glm::dvec3> colors;
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    const std::uint16_t* const texel = picture.rgba.data() + i;
    const glm::vec3 lab =
        OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])});
    colors.emplace_back(lab);
    for (int c = 0; c < 3; ++c) mean[std::size_t(c)] += lab[c];
  }
  for (double& one : mean) one /= static_cast<double>(colors.size());
  const ColorSpread spread = MeasureColors(picture);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(spread.mean[c], mean[c], 1e-5);
  const int pairs[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  for (std::size_t k = 0; k < 6; ++k) {
    double sum = 0.0;
    const auto [i, j] = pairs[k];
    for (const glm::dvec3& color : colors) sum += (color[i] - mean[std::size_t(i)]) * (color[j] - mean[std::size_t(j)]);
    EXPECT_NEAR(spread.covariance[k], sum / double(colors.size()), 1e-5) << k;
  }
}

TEST(Palette, TakesMeanAndCovarianceOfTheExample) {
  const Picture made = Finished(LikeStep(Cold()), nullptr, Warm());
  const ColorSpread wanted = MeasureColors(Cold()), got = MeasureColors(made);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(got.mean[c], wanted.mean[c], 1e-4);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(got.covariance[k], wanted.covariance[k], 1e-4) << k;
}

TEST(Palette, OfItselfChangesNothing) {
  const Picture made = Finished(LikeStep(Warm()), nullptr, Warm());
  int most = 0;
  for (std::size_t i = 0; i < made.rgba.size(); ++i)
    most = std::max(most, std::abs(int(made.rgba[i]) - int(Warm().rgba[i])));
  EXPECT_LE(most, 2);  // what Oklab there and back costs
}

TEST(Palette, OfOneColourOnlyMoves) {
  const Picture made = Finished(LikeStep(Cold()), nullptr, PlainPicture(20, 10, 30000, 40000, 20000));
  const ColorSpread wanted = MeasureColors(Cold()), got = MeasureColors(made);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(got.mean[c], wanted.mean[c], 1e-4);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(got.covariance[k], 0.0, 1e-6);
}

TEST(Palette, SpreadsNoFurtherThanItsGain) {
  const Picture flat = SoftColors({0.5f, 0.0f, 0.0f}, {0.01f, 0.0f, 0.0f}, 0.0f);
  const Picture wide = SoftColors({0.5f, 0.0f, 0.0f}, {0.4f, 0.0f, 0.0f}, 0.0f);
  const ColorSpread before = MeasureColors(flat), after = MeasureColors(Finished(LikeStep(wide, 2.0), nullptr, flat));
  EXPECT_NEAR(after.covariance[0] / before.covariance[0], 4.0, 0.1);
}

TEST(Palette, MayKeepLightness) {
  FinishStep step = LikeStep(Cold());
  std::get<PalettePass>(step.pass.effect).keep_lightness = true;
  const ColorSpread before = MeasureColors(Warm()), after = MeasureColors(Finished(step, nullptr, Warm()));
  EXPECT_NEAR(after.mean[0], before.mean[0], 1e-4);
  EXPECT_NEAR(after.covariance[0], before.covariance[0], 1e-4);
  EXPECT_NEAR(after.mean[2], MeasureColors(Cold()).mean[2], 1e-4);
}

TEST(Palette, GoesByTheColoursOfFromWhateverThePictureIs) {
  FinishStep step = LikeStep(Cold());
  std::get<PalettePass>(step.pass.effect).source = MeasureColors(Warm());
  Picture part = Warm();
  for (std::size_t i = part.rgba.size() / 2; i < part.rgba.size(); ++i) part.rgba[i] = 65535;  // half white
  const Picture made = Finished(step, nullptr, part), whole = Finished(step, nullptr, Warm());
  for (std::size_t i = 0; i < made.rgba.size() / 2; ++i) ASSERT_EQ(made.rgba[i], whole.rgba[i]);
}

TEST(Palette, CountsClearAndForeignPixelsNot) {
  Picture picture = Warm();
  std::vector<std::uint8_t> only(picture.rgba.size() / 4, 1);
  for (std::size_t i = 0; i < 500; ++i) picture.rgba[4 * i + 3] = 0, only[500 + i] = 0;
  const ColorSpread spread = MeasureColors(picture, only);
  Picture rest = picture;
  for (std::size_t i = 0; i < 1000; ++i) rest.rgba[4 * i + 3] = 0;
  EXPECT_EQ(spread.mean, MeasureColors(rest).mean);
  EXPECT_EQ(spread.covariance, MeasureColors(rest).covariance);
}

TEST(Palette, NeedsAnExample) {
  const FinishStep step = StepOf(PalettePass());
  const Status done = CheckFinish(std::span(&step, 1), nullptr);
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, ::testing::HasSubstr("set finish.it.like"));
}

// Steps before a palette are in its colours.
TEST(Palette, MeasuresWhatTheStepsBeforeMade) {
  const FinishStep steps[] = {StepOf(GradePass{0.3, 1.0, 0.1}), LikeStep(Cold())};
  const ColorSpread wanted = MeasureColors(Cold()), got = MeasureColors(Finished(steps, nullptr, Warm()));
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(got.mean[c], wanted.mean[c], 1e-4);
}

}  // namespace
}  // namespace scumble
