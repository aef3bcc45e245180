// Wrapped light, Gooch's shading and colour ramps of toon against their formulas.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "core/style/color_ramp.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN(), kBeyond = std::numeric_limits<float>::infinity();

// A ball of one grey with the cosine to a lamp.
GuideSet BallUnder(int size, float radius, glm::vec3 to_lamp) {
  GuideSet guides = BallGuides(size, radius);
  guides.Add(Layer::kCosine), guides.Add(Layer::kAlbedo), guides.Add(Layer::kShadow);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kCosine)[i] = glm::dot(guides.Vec3(Layer::kNormal, i), to_lamp);
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = 0.5f;
  }
  return guides;
}

// A row of pixels whose tone, wrapped with power 1, goes from 0 to 1.
GuideSet ToneRow(int width) {
  GuideSet guides = FlatGuides(width, 1);
  guides.Add(Layer::kCosine), guides.Add(Layer::kAlbedo);
  for (float& shadow : guides.Plane(Layer::kShadow)) shadow = 0.0f;
  for (int x = 0; x < width; ++x) {
    guides.Plane(Layer::kCosine)[std::size_t(x)] = 2.0f * static_cast<float>(x) / static_cast<float>(width - 1) - 1.0f;
    guides.Plane(Layer::kAlbedo, 0)[std::size_t(x)] = 0.2f;
    guides.Plane(Layer::kAlbedo, 1)[std::size_t(x)] = 0.1f;
    guides.Plane(Layer::kAlbedo, 2)[std::size_t(x)] = 0.05f;
  }
  return guides;
}

glm::vec3 ToonLab(const std::uint16_t* texel) {
  return OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])});
}
glm::vec3 ToonLab(const Rgb16& color) { return ToonLab(color.data()); }

void ExpectLab(glm::vec3 lab, glm::vec3 expected, float tolerance, int at) {
  EXPECT_LT(glm::length(lab - expected), tolerance) << at << ": " << lab.x << " " << lab.y << " " << lab.z << ", not "
                                                    << expected.x << " " << expected.y << " " << expected.z;
}

ToonPass WrappedToon(int bands) {
  ToonPass pass;
  pass.light = ToonPass::Light::kWrapped, pass.bands = bands;
  return pass;
}

ToonPass RampToon(const std::string& text, ToonPass::Rows rows, int bands = 1) {
  ToonPass pass = WrappedToon(bands);
  pass.shading = ToonPass::Shading::kRamp, pass.ramp = text, pass.ramp_rows = rows;
  pass.ramp_colors = std::make_shared<const ColorRamp>(ParseColorRamp(text).value());
  return pass;
}

Picture Tooned(const ToonPass& pass, const GuideSet& guides, const FinishMeasures& measures = {}, int threads = 0) {
  const Picture grey = PlainPicture(guides.width(), guides.height(), 9000, 9000, 9000);
  return Finished(StepOf(pass), &guides, grey, measures, threads);
}

// Along the row through the middle of a ball lit from the right, the cosine is x / radius.
TEST(ToonWrapped, BordersOfBandsGoAroundTheForm) {
  const GuideSet guides = BallUnder(240, 100.0f, {1, 0, 0});
  for (const int power : {1, 2}) {
    ToonPass pass = WrappedToon(4);
    pass.wrap_power = power, pass.tint = 0.0, pass.shade = 0.4;
    const Picture made = Tooned(pass, guides);
    for (int b = 1; b < 4; ++b) {
      const double middle = std::cbrt(0.5) * (0.4 + 0.6 * (b - 0.5) / 3.0);
      int x = 25;
      while (ToonLab(made.At(x, 119)).x < middle) ASSERT_LT(++x, 216);
      const double from = ToonLab(made.At(x - 1, 119)).x, to = ToonLab(made.At(x, 119)).x;
      const double border = x - 0.5 + (middle - from) / (to - from) - 120.0;
      EXPECT_NEAR(border, 100.0 * (2.0 * std::pow(b / 4.0, 1.0 / power) - 1.0), 0.5) << power << " " << b;
    }
  }
}

TEST(ToonWrapped, CastShadowTakesOfWhatFacesTheLightAlone) {
  GuideSet guides = ToneRow(101);
  for (float& shadow : guides.Plane(Layer::kShadow)) shadow = 0.5f;
  ToonPass pass = WrappedToon(64);
  pass.cast = 0.6, pass.tint = 0.0, pass.shade = 0.0, pass.softness = 0.0;
  for (int c = 0; c < 3; ++c) {
    for (float& value : guides.Plane(Layer::kAlbedo, c)) value = 0.5f;
  }
  const Picture made = Tooned(pass, guides);
  for (int x = 0; x < 101; ++x) {
    const double cosine = x / 50.0 - 1.0, left = cosine > 0.0 ? cosine * (1.0 - 0.6 * 0.5) : cosine;
    EXPECT_NEAR(ToonLab(made.At(x, 0)).x / std::cbrt(0.5), (1.0 + left) / 2.0, 1.5 / 63.0) << x;
  }
  pass.cast = 0.0;
  guides.Remove(Layer::kShadow);
  EXPECT_NEAR(ToonLab(Tooned(pass, guides).At(100, 0)).x, std::cbrt(0.5), 1e-3) << "shadow is not read then";
}

TEST(ToonWrapped, NeedsTheCosineAndNoBrightness) {
  ToonPass pass = WrappedToon(3);
  const auto needs = [&](Layer layer) { return RequiredLayers(StepOf(pass).pass).Has(layer); };
  const auto looks = [&] { return LooksAtMeasures(std::vector{StepOf(pass).pass}); };
  EXPECT_TRUE(needs(Layer::kCosine) && needs(Layer::kShadow) && needs(Layer::kAlbedo));
  EXPECT_FALSE(needs(Layer::kLuminance) || looks());
  pass.cast = 0.0;
  EXPECT_FALSE(needs(Layer::kShadow));
  pass.shading = ToonPass::Shading::kRamp;
  EXPECT_TRUE(needs(Layer::kDepth) && looks());
  EXPECT_FALSE(needs(Layer::kAlbedo)) << "a ramp has colours of its own";
  pass.ramp_rows = ToonPass::Rows::kFacing;
  EXPECT_TRUE(needs(Layer::kNormal));
  EXPECT_FALSE(looks());
  pass.ramp_rows = ToonPass::Rows::kHighlight;
  EXPECT_TRUE(needs(Layer::kLpeLSE) && needs(Layer::kLuminance) && looks());
  pass = ToonPass();
  EXPECT_TRUE(needs(Layer::kLuminance) && looks());
  EXPECT_FALSE(needs(Layer::kCosine) || needs(Layer::kShadow));
}

TEST(ToonGooch, IsTheFormula) {
  const GuideSet guides = ToneRow(65);
  const glm::vec3 base = OklabFromLinear({0.2f, 0.1f, 0.05f});
  for (const int bands : {1, 5}) {
    ToonPass pass = WrappedToon(bands);
    pass.shading = ToonPass::Shading::kGooch, pass.softness = 0.0;
    pass.warm_base = 0.4, pass.cool_base = 0.2;
    const Picture made = Tooned(pass, guides);
    for (int x = 0; x < 65; ++x) {
      float t = static_cast<float>(x) / 64.0f;
      if (bands > 1) t = std::min(std::floor(t * 5.0f), 4.0f) / 4.0f;
      const glm::vec3 expected =
          t * (ToonLab(pass.warm) + 0.4f * base) + (1.0f - t) * (ToonLab(pass.cool) + 0.2f * base);
      ExpectLab(ToonLab(made.At(x, 0)), expected, 2e-3f, x);
    }
  }
}

TEST(ToonGooch, SumsAreClippedToWhite) {
  GuideSet guides = ToneRow(3);
  ToonPass pass = WrappedToon(1);
  pass.shading = ToonPass::Shading::kGooch;
  pass.warm = {60000, 60000, 60000}, pass.warm_base = 1.0;
  for (int c = 0; c < 3; ++c) {
    for (float& value : guides.Plane(Layer::kAlbedo, c)) value = 1.0f;
  }
  const Picture made = Tooned(pass, guides);
  for (int c = 0; c < 3; ++c) EXPECT_GE(made.At(2, 0)[c], 65500);
}

TEST(ToonGooch, ShadesThePaintWhereAsked) {
  const GuideSet guides = ToneRow(3);
  ToonPass pass = WrappedToon(1);
  pass.shading = ToonPass::Shading::kGooch, pass.base = ToonPass::Color::kPaint;
  const Picture paint = PlainPicture(3, 1, 30000, 20000, 10000);
  const Picture made = Finished(StepOf(pass), &guides, paint);
  ExpectLab(ToonLab(made.At(2, 0)), ToonLab(pass.warm) + 0.5f * ToonLab(paint.At(2, 0)), 2e-3f, 2);
}

TEST(ToonRamp, ColumnsAreTones) {
  const GuideSet guides = ToneRow(65);
  const ToonPass pass = RampToon("#101020 #804020 #fff4d0", ToonPass::Rows::kFacing);
  const Picture made = Tooned(pass, guides);
  const glm::vec3 dark = ToonLab(pass.ramp_colors->colors[0]), middle = ToonLab(pass.ramp_colors->colors[1]),
                  light = ToonLab(pass.ramp_colors->colors[2]);
  for (int x = 0; x < 65; ++x) {
    const float t = static_cast<float>(x) / 32.0f;
    const glm::vec3 expected = t < 1.0f ? glm::mix(dark, middle, t) : glm::mix(middle, light, t - 1.0f);
    ExpectLab(ToonLab(made.At(x, 0)), expected, 2e-3f, x);
  }
  // With as many bands as columns, each band has its colour.
  ToonPass banded = pass;
  banded.bands = 3, banded.softness = 0.0;
  const Picture flat = Tooned(banded, guides);
  ExpectLab(ToonLab(flat.At(5, 0)), dark, 1e-3f, 5);
  ExpectLab(ToonLab(flat.At(32, 0)), middle, 1e-3f, 32);
  ExpectLab(ToonLab(flat.At(60, 0)), light, 1e-3f, 60);
}

TEST(ToonRamp, RowsGoByHighlights) {
  GuideSet guides = ToneRow(64);
  guides.Add(Layer::kLpeLSE);
  FinishMeasures measures;
  measures.bright = 2.0;
  for (int x = 0; x < 64; ++x) {
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kLpeLSE, c)[std::size_t(x)] = static_cast<float>(x) / 16.0f;
  }
  guides.Plane(Layer::kLpeLSE, 1)[5] = NAN;
  const ToonPass pass = RampToon("#000000 / #804020", ToonPass::Rows::kHighlight);
  const Picture made = Tooned(pass, guides, measures);
  const glm::vec3 dull = ToonLab(pass.ramp_colors->colors[0]), shiny = ToonLab(pass.ramp_colors->colors[1]);
  for (int x = 0; x < 64; ++x) {
    const float share = x == 5 ? 0.0f : std::min(1.0f, static_cast<float>(x) / 32.0f);
    ExpectLab(ToonLab(made.At(x, 0)), glm::mix(dull, shiny, share), 2e-3f, x);
  }
}

TEST(ToonRamp, RowsAreTheLogarithmOfDepth) {
  GuideSet guides = ToneRow(64);
  FinishMeasures measures;
  measures.near = 2.0, measures.far = 32.0;
  for (int x = 0; x < 64; ++x) {
    guides.Plane(Layer::kCosine)[std::size_t(x)] = 1.0f;
    guides.Plane(Layer::kDepth)[std::size_t(x)] = 1.0f + static_cast<float>(x);
  }
  const ToonPass pass = RampToon("#000000 #ffffff / #000000 #804020 / #000000 #203050", ToonPass::Rows::kDepth);
  const Picture made = Tooned(pass, guides, measures);
  const auto colors = pass.ramp_colors->colors;
  for (int x = 0; x < 64; ++x) {
    const float u = std::clamp(std::log((1.0f + static_cast<float>(x)) / 2.0f) / std::log(16.0f), 0.0f, 1.0f) * 2.0f;
    const glm::vec3 expected = u < 1.0f ? glm::mix(ToonLab(colors[1]), ToonLab(colors[3]), u)
                                        : glm::mix(ToonLab(colors[3]), ToonLab(colors[5]), u - 1.0f);
    ExpectLab(ToonLab(made.At(x, 0)), expected, 3e-3f, x);
  }
}

// A wall seen by a wide camera, moved to the side: what faces +Z faces the viewer where the line of sight is along it.
TEST(ToonRamp, RowsAreHowFarSurfacesTurnFromTheViewer) {
  GuideSet guides = FlatGuides(40, 30);
  guides.Add(Layer::kCosine), guides.Remove(Layer::kShadow);
  for (float& cosine : guides.Plane(Layer::kCosine)) cosine = 1.0f;
  ToonPass pass = RampToon("#ffffff / #000000", ToonPass::Rows::kFacing);
  pass.cast = 0.0;
  const auto lightness = [&](int x, int y) { return ToonLab(Tooned(pass, guides).At(x, y)).x; };
  EXPECT_NEAR(lightness(0, 0), 1.0, 1e-3) << "without a camera +Z is towards the viewer";
  GuideCamera camera;
  camera.clip_from_view = glm::dmat4(0.0);
  camera.clip_from_view[0][0] = 1.5, camera.clip_from_view[1][1] = 2.0, camera.clip_from_view[2][0] = 0.25;
  camera.clip_from_view[2][2] = -1.2, camera.clip_from_view[2][3] = -1.0, camera.clip_from_view[3][2] = -0.4;
  guides.camera = camera;
  const Picture made = Tooned(pass, guides);
  for (const auto& [x, y] : {std::pair(0, 0), {39, 0}, {20, 15}, {7, 29}}) {
    // Clip x = 1.5 X + 0.25 Z over -Z, at Z = -1.
    const double across = ((x + 0.5) / 20.0 - 1.0 + 0.25) / 1.5, up = (1.0 - (y + 0.5) / 15.0) / 2.0;
    EXPECT_NEAR(ToonLab(made.At(x, y)).x, 1.0 / std::sqrt(1.0 + across * across + up * up), 2e-3) << x << " " << y;
  }
  guides.attributes["scumble:normal_frame"] = "eye";
  EXPECT_NEAR(lightness(0, 0), 1.0, 1e-3) << "such normals are relative to the line of sight";
  guides.attributes.clear();
  guides.camera->clip_from_view[2][3] = 0.0, guides.camera->clip_from_view[3][3] = 1.0;
  EXPECT_NEAR(lightness(0, 0), 1.0, 1e-3) << "an orthographic view";
  guides.camera.reset();
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kNormal, 0)[i] = 0.8f, guides.Plane(Layer::kNormal, 2)[i] = -0.6f;
  }
  EXPECT_NEAR(lightness(3, 3), 0.6, 2e-3) << "backs turn away as fronts do";
}

TEST(ToonRamp, WithoutColoursIsRefused) {
  ToonPass pass;
  pass.shading = ToonPass::Shading::kRamp;
  const FinishStep step = StepOf(pass);
  const GuideSet guides = ToneRow(3);
  const Status checked = CheckFinish(std::span(&step, 1), &guides);
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().message.find("set finish.it.ramp to"), std::string::npos) << checked.error().message;
}

// No number of the guides may reach the picture as NaN: it would become black or depend on the machine.
TEST(ToonShading, NumbersThatAreNoneMakeNoOther) {
  GuideSet guides = ToneRow(12);
  guides.Add(Layer::kLuminance);
  const float odd[] = {kNoNumber, kBeyond, -kBeyond, 1e38f, -1e38f, -0.0f};
  FinishMeasures measures;
  measures.near = 1.0, measures.far = 8.0;
  for (const auto light : {ToonPass::Light::kLuminance, ToonPass::Light::kWrapped}) {
    for (const auto shading : {ToonPass::Shading::kPlain, ToonPass::Shading::kGooch, ToonPass::Shading::kRamp}) {
      for (const auto rows : {ToonPass::Rows::kDepth, ToonPass::Rows::kFacing}) {
        for (const int bands : {1, 3}) {
          for (const float value : odd) {
            ToonPass pass = RampToon("#808080 #909090 / #a0a0a0 #b0b0b0", rows, bands);
            pass.light = light, pass.shading = shading, pass.shade = 0.5, pass.tint = 0.0;
            pass.warm = pass.cool = {30000, 30000, 30000};
            for (const Layer layer : {Layer::kLuminance, Layer::kCosine, Layer::kShadow, Layer::kDepth}) {
              GuideSet broken = guides;
              broken.Plane(layer)[5] = value;
              const Picture made = Tooned(pass, broken, measures);
              // Every colour of these passes is a grey or a brown lighter than this.
              for (int x = 4; x < 7; ++x) EXPECT_GT(made.At(x, 0)[0], 5000) << int(layer) << " " << value << " " << x;
            }
            GuideSet broken = guides;
            for (int c = 0; c < 3; ++c) broken.Plane(Layer::kNormal, c)[5] = value;
            EXPECT_GT(Tooned(pass, broken, measures).At(5, 0)[0], 5000) << value;
          }
        }
      }
    }
  }
}

TEST(ToonShading, BytesDoNotDependOnThreads) {
  const GuideSet guides = BallUnder(120, 50.0f, {0.6f, 0.8f, 0.0f});
  FinishMeasures measures;
  measures.near = 4.9, measures.far = 5.0;
  for (const auto rows : {ToonPass::Rows::kDepth, ToonPass::Rows::kFacing}) {
    const ToonPass pass = RampToon("#101020 #804020 #fff4d0 / #202040 #808080 #a0b0c0", rows, 4);
    const Picture one = Tooned(pass, guides, measures, 1), four = Tooned(pass, guides, measures, 4);
    EXPECT_FALSE(one.empty());
    EXPECT_EQ(one.rgba, four.rgba);
  }
}

}  // namespace
}  // namespace scumble
