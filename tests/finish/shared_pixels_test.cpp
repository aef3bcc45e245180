// Pixels that show several surfaces, or both sides of a hard contour of light, under effects of single pixels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <vector>

#include "core/image/color.h"
#include "tests/finish/finish_fixtures.h"
#include "tests/support/light_fixtures.h"

namespace scumble {
namespace {

double LightOf(const std::uint16_t* texel) { return Srgb16ToLinear(texel[1]); }

TEST(SharedPixels, HardShadowsAreSmoothInToonShadowsAndRender) {
  const double slope = 0.23, at = 20.4;
  GuideSet guides = SlantedShadow(64, at, slope);
  for (const Layer layer : {Layer::kAlbedo, Layer::kLpeFull}) guides.Add(layer);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    for (int c = 0; c < 3; ++c) {
      guides.Plane(Layer::kAlbedo, c)[i] = 0.5f;
      guides.Plane(Layer::kLpeFull, c)[i] = 0.05f + 0.9f * guides.Plane(Layer::kLuminance)[i];
    }
  }
  ShadowsPass black;
  black.mode = ShadowsPass::Mode::kBlack;
  for (const FinishPass::Effect& effect :
       {FinishPass::Effect(ToonPass()), FinishPass::Effect(black), FinishPass::Effect(RenderPass())}) {
    const Picture made = Finished(StepOf(effect), &guides, PlainPicture(64, 64, 40000, 40000, 40000));
    const double dark = LightOf(made.At(20, 8)), bright = LightOf(made.At(20, 56));
    ASSERT_GT(bright, dark + 0.1);
    const Errors errors =
        ErrorsAlong(64, at, slope, [&](int x, int y) { return (bright - LightOf(made.At(x, y))) / (bright - dark); });
    EXPECT_LT(errors.mean, 0.1) << effect.index();
    EXPECT_LT(errors.most, 0.3) << effect.index();
  }
}

// A step that is kept from a surface does not mix its paint.
TEST(SharedPixels, ContoursKeepTheBytesThatNoStepChanges) {
  const GuideSet guides = SlantedShadow(64, 20.4, 0.23);
  FinishStep step = StepOf(ShadowsPass());
  step.only.assign(guides.pixel_count(), 0);
  const Picture paint = ColorfulPicture(64, 64);
  EXPECT_EQ(Finished(step, &guides, paint).rgba, paint.rgba);
}

// Beside a contour, too, a step changes the pixel's own paint, by its strength.
TEST(SharedPixels, ContoursChangeNoMoreThanTheStepsDo) {
  const GuideSet guides = SlantedShadow(64, 20.4, 0.23);
  FinishStep step = StepOf(ShadowsPass());
  step.pass.strength = 0.01;
  const Picture paint = ColorfulPicture(64, 64), made = Finished(step, &guides, paint);
  int most = 0;
  for (std::size_t i = 0; i < paint.rgba.size(); ++i)
    most = std::max(most, std::abs(int(made.rgba[i]) - int(paint.rgba[i])));
  EXPECT_GT(most, 0);
  EXPECT_LT(most, 3 * 257);
}

// Two objects, the first above a line, with the fragments of exact areas.
GuideSet SlantedBorder(int size, double a, double b) {
  GuideSet guides = FlatGuides(size, size);
  for (const Layer layer : {Layer::kMaterial, Layer::kAlbedo}) guides.Add(layer);
  const auto fragments = std::make_shared<Fragments>();
  std::vector<float> areas;
  std::vector<std::size_t> like;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const std::size_t i = guides.Index(x, y);
      const bool is_first = y + 0.5 < a + b * (x + 0.5);
      guides.Plane(Layer::kObject)[i] = is_first ? 1.0f : 2.0f;
      for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = is_first ? 0.1f : 0.8f;
      const double area = is_first ? 1.0 - AreaAbove(a, b, x, y) : AreaAbove(a, b, x, y);
      if (area > 1e-6) fragments->pixel.push_back(std::uint32_t(i)), areas.push_back(float(area));
    }
  }
  fragments->values = GuideSet(static_cast<int>(areas.size()), 1);
  for (const LayerInfo& info : AllLayers()) {
    if (guides.Has(info.layer)) fragments->values.Add(info.layer);
  }
  for (std::size_t f = 0; f < areas.size(); ++f) {
    fragments->values.Plane(Layer::kCoverage)[f] = areas[f];
    fragments->values.Plane(Layer::kObject)[f] = 3.0f - guides.Plane(Layer::kObject)[fragments->pixel[f]];
  }
  guides.fragments = fragments;
  return guides;
}

TEST(SharedPixels, BordersOfObjectsHaveTheExactAreaInToon) {
  const double slope = 0.37, at = 12.2;
  const GuideSet guides = SlantedBorder(48, at, slope);
  ToonPass pass;
  pass.bands = 1;
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(48, 48, 9, 9, 9));
  const double dark = LightOf(made.At(20, 2)), bright = LightOf(made.At(20, 46));
  const Errors errors =
      ErrorsAlong(48, at, slope, [&](int x, int y) { return (bright - LightOf(made.At(x, y))) / (bright - dark); });
  EXPECT_LT(errors.most, 0.001);
}

// Of a border with paint that the step leaves as it is, only the step's surface changes.
TEST(SharedPixels, SurfacesChangeTheirOwnPaintAlone) {
  const double slope = 0.37, at = 12.2;
  const GuideSet guides = SlantedBorder(48, at, slope);
  const std::size_t count = guides.fragments->count();
  constexpr FragmentColors::Texel kGrey = {32896, 32896, 32896, 65535}, kPaint = {60000, 60000, 60000, 65535};
  Picture picture(48, 48);
  FinishStep step = StepOf(ToonPass());
  std::get<ToonPass>(step.pass.effect).bands = 1;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    step.only.push_back(guides.Plane(Layer::kObject)[i] == 1.0f);
    std::copy_n((step.only.back() ? kGrey : kPaint).begin(), 4, picture.rgba.begin() + std::ptrdiff_t(4 * i));
  }
  FragmentColors colors{std::vector(count, kGrey), std::vector(count, kGrey), std::vector(count, kGrey)};
  for (std::size_t f = 0; f < count; ++f) {
    const std::size_t pixel = guides.fragments->pixel[f];
    if (step.only[pixel])
      colors.own[f] = kPaint;
    else
      colors.centre[f] = kPaint;
    const float share = guides.fragments->values.Plane(Layer::kCoverage)[f];
    for (std::size_t c = 0; c < 3; ++c) {
      colors.mixed[f][c] = Srgb16FromLinear(share * Srgb16ToLinear(colors.own[f][c]) +
                                            (1.0f - share) * Srgb16ToLinear(colors.centre[f][c]));
    }
    std::copy_n(colors.mixed[f].begin(), 4, picture.rgba.begin() + std::ptrdiff_t(4 * pixel));
  }
  FinishFrame frame{&guides, {}, 1.0, 7};
  frame.colors = &colors;
  ASSERT_TRUE(ApplyFinish(std::span(&step, 1), FinishPass::Stage::kPaint, frame, 0, {}, picture));
  const double dark = LightOf(picture.At(20, 2)), bright = Srgb16ToLinear(kPaint[1]);
  const Errors errors =
      ErrorsAlong(48, at, slope, [&](int x, int y) { return (bright - LightOf(picture.At(x, y))) / (bright - dark); });
  EXPECT_LT(errors.most, 0.001);
}

}  // namespace
}  // namespace scumble
