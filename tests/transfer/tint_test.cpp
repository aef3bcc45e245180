// Base colours on the paint: the formulas of transfer/tint/colorize.h, implemented once more in double.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "tests/support/transfer_fixtures.h"
#include "transfer/tint/colorize.h"

namespace scumble {
namespace {

using namespace testing;
using glm::dvec3;

dvec3 Oklab(dvec3 c) {
  const double l = std::cbrt(0.4122214708 * c.r + 0.5363325363 * c.g + 0.0514459929 * c.b);
  const double m = std::cbrt(0.2119034982 * c.r + 0.6806995451 * c.g + 0.1073969566 * c.b);
  const double s = std::cbrt(0.0883024619 * c.r + 0.2817188376 * c.g + 0.6299787005 * c.b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

dvec3 FromOklab(dvec3 lab) {
  const double l = lab.x + 0.3963377774 * lab.y + 0.2158037573 * lab.z;
  const double m = lab.x - 0.1055613458 * lab.y - 0.0638541728 * lab.z;
  const double s = lab.x - 0.0894841775 * lab.y - 1.2914855480 * lab.z;
  const double l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
  return {4.0767416621 * l3 - 3.3077115913 * m3 + 0.2309699292 * s3,
          -1.2684380046 * l3 + 2.6097574011 * m3 - 0.3413193965 * s3,
          -0.0041960863 * l3 - 0.7034186147 * m3 + 1.7076147010 * s3};
}

// The largest share of the chroma, in steps of 1/5000, at which no channel leaves 0 … top by more than 1/10000.
dvec3 Fitted(dvec3 lab, double top) {
  for (int share = 5000; share > 0; --share) {
    const dvec3 c = FromOklab({lab.x, lab.y * share / 5000.0, lab.z * share / 5000.0});
    if (std::min({c.r, c.g, c.b}) >= -1e-4 && std::max({c.r, c.g, c.b}) <= top + 1e-4) {
      return {lab.x, lab.y * share / 5000.0, lab.z * share / 5000.0};
    }
  }
  return {lab.x, 0.0, 0.0};
}

dvec3 Wanted(dvec3 paint, dvec3 albedo, double reference, double weight) {
  albedo = glm::clamp(albedo, 0.0, 1.0);
  const dvec3 own = Oklab(paint), scene = Oklab(albedo);
  dvec3 target = scene * (own.x / reference);
  if (own.x > reference) {
    const double t = (own.x - reference) / (1.0 - std::min(reference, scene.x));
    target = Fitted({scene.x + t * (1.0 - scene.x), scene.y * (1.0 - t * t), scene.z * (1.0 - t * t)},
                    std::max({0.98, albedo.r, albedo.g, albedo.b}));
  }
  return FromOklab(Fitted(own * (1.0 - weight) + target * weight, 1.0));
}

dvec3 Linear(const std::uint16_t* texel) {
  return {Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])};
}

// Coloured paint in every lightness of a range.
Picture Paint(int size, int darkest, int lightest) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const int tone = darkest + static_cast<int>(Hash(x, y) % std::uint64_t(lightest - darkest));
      std::uint16_t* texel = picture.At(x, y);
      for (int c = 0; c < 3; ++c) {
        texel[c] =
            static_cast<std::uint16_t>(std::clamp(tone + static_cast<int>(Hash(x, y, c) % 9000) - 4500, 0, 65535));
      }
      texel[3] = 65535;
    }
  }
  return picture;
}

double MeanL(const PreparedExemplar& exemplar, int index) {
  double sum = 0.0, count = 0.0;
  for (const Source& at : exemplar.UsablePixels()) {
    sum += Oklab(Linear(exemplar.picture(index).At(at.x, at.y))).x, count += 1.0;
  }
  return sum / count;
}

// The hills in two lights, with base colours in and out of the gamut.
GuideSet ColoredHills(int width, int height) {
  GuideSet guides = HillGuides(width, height);
  guides.Add(Layer::kLuminance), guides.Add(Layer::kAlbedo);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = guides.Index(x, y);
      guides.Plane(Layer::kLuminance)[i] = x < width / 2 ? 0.8f : 0.1f;
      const float red = y % 20 < 10 ? 1.4f : 0.05f;
      guides.Plane(Layer::kAlbedo, 0)[i] = red;
      guides.Plane(Layer::kAlbedo, 1)[i] = static_cast<float>(x) / width;
      guides.Plane(Layer::kAlbedo, 2)[i] = y % 20 < 10 ? -0.2f : 0.9f * y / height;
    }
  }
  return guides;
}

Style Lights(Picture lit, Picture shade) {
  Style style = PlainStyle(std::move(lit));
  style.exemplars[0].luminance = 0.8;
  style.exemplars.push_back({"shade.png", std::move(shade), 0.1});
  style.transfer.colorize_mode = ColorizeMode::kOklab;
  return style;
}

TEST(Tint, IsTheWholeFormulaAtAnyWeightWithTwoExemplars) {
  const GuideSet guides = ColoredHills(90, 80);
  for (const bool lit_first : {true, false}) {
    Style style = lit_first ? Lights(Paint(96, 20000, 65535), Paint(96, 0, 30000))
                            : Lights(Paint(96, 0, 30000), Paint(96, 20000, 65535));
    const Picture plain = MustTransfer(style, guides).picture;
    for (const double weight : {0.3, 0.6, 1.0}) {
      style.transfer.colorize = weight;
      const auto prepared = Prepare(style, 80);
      ASSERT_TRUE(prepared);
      const double reference = std::max(MeanL(*prepared->exemplar, 0), MeanL(*prepared->exemplar, 1));
      EXPECT_NEAR(prepared->reference_lightness, reference, 1e-5);
      const Picture tinted = MustTransfer(style, guides).picture;
      std::set<int> lighter;
      for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
        if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
        const dvec3 paint = Linear(&plain.rgba[4 * i]);
        const dvec3 expected = Wanted(paint, guides.Vec3(Layer::kAlbedo, i), reference, weight);
        const dvec3 found = Linear(&tinted.rgba[4 * i]);
        lighter.insert(Oklab(paint).x > reference);
        for (int c = 0; c < 3; ++c) {  // the gamut is searched in steps of a thousandth
          ASSERT_NEAR(found[c], std::clamp(expected[c], 0.0, 1.0), 3e-3) << "weight " << weight << " pixel " << i;
        }
        ASSERT_EQ(tinted.rgba[4 * i + 3], plain.rgba[4 * i + 3]);
      }
      EXPECT_EQ(lighter.size(), 2u) << "paint on both sides of the reference";
    }
  }
}

// One wall, the left half lit and the right half in shadow; exemplars of flat paint.
TEST(Tint, KeepsTheRatioOfLightAndShade) {
  GuideSet guides = MakeGuides(80, 40, [](int, int) { return glm::vec3(0, 0, 1); });
  guides.Add(Layer::kLuminance), guides.Add(Layer::kAlbedo);
  for (int i = 0; i < 80 * 40; ++i) {
    guides.Plane(Layer::kLuminance)[i] = i % 80 < 40 ? 0.8f : 0.1f;
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = 0.6f - 0.2f * c;
  }
  const auto flat = [](int tone) { return Paint(64, tone, tone + 3000); };
  Style style = Lights(flat(52000), flat(24000));
  style.transfer.luminance_weight = std::numeric_limits<float>::infinity();
  style.transfer.blend_radius = 0;
  const auto ratio = [&] {
    const Picture picture = MustTransfer(style, guides).picture;
    double sides[2] = {0.0, 0.0};
    for (int i = 0; i < 80 * 40; ++i) {
      const dvec3 c = Linear(&picture.rgba[4 * std::size_t(i)]);
      sides[i % 80 >= 40] += Luminance(float(c.r), float(c.g), float(c.b));
    }
    return sides[0] / sides[1];
  };
  const double plain = ratio();
  ASSERT_GT(plain, 3.5);
  style.transfer.colorize = 1.0;
  EXPECT_NEAR(ratio(), plain, 0.05 * plain);
}

// A blend of the paint of two exemplars lies between what each becomes, whichever the pixel's own is: no rings of light
// along the edge of a shadow.
TEST(Tint, ShadowEdgesThatMeltStayBetweenBothSides) {
  GuideSet guides = MakeGuides(80, 40, [](int, int) { return glm::vec3(0, 0, 1); });
  guides.Add(Layer::kLuminance), guides.Add(Layer::kAlbedo);
  for (int i = 0; i < 80 * 40; ++i) {
    guides.Plane(Layer::kLuminance)[i] = i % 80 < 40 ? 0.8f : 0.1f;
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = 0.5f;
  }
  Picture light(64, 64), dark(64, 64);
  for (std::size_t i = 0; i < light.rgba.size(); ++i) {
    light.rgba[i] = static_cast<std::uint16_t>(i % 4 == 3 ? 65535 : 50000);
    dark.rgba[i] = static_cast<std::uint16_t>(i % 4 == 3 ? 65535 : 20000);
  }
  Style style = Lights(light, dark);
  style.transfer.luminance_weight = std::numeric_limits<float>::infinity();
  style.transfer.blend_radius = 4;
  style.transfer.colorize = 1.0;
  const Picture picture = MustTransfer(style, guides).picture;
  const int steps = 2 * 4 + 1;
  int last = 65536;
  for (int x = 30; x < 50; ++x) {
    const int here = picture.At(x, 20)[0];
    ASSERT_LE(here, last) << x;
    if (last < 65536) {
      ASSERT_LE(last - here, (picture.At(0, 20)[0] - picture.At(79, 20)[0]) * 2 / steps) << x;
    }
    last = here;
  }
  EXPECT_GT(picture.At(0, 20)[0], 2 * picture.At(79, 20)[0]);
}

std::uint16_t Grey(double lightness) { return Srgb16FromLinear(static_cast<float>(lightness * lightness * lightness)); }

// Any albedo, saturated ones included: lightness follows the paint's, and nothing short of white paint reaches the top
// of a channel.
TEST(Tint, IsMonotoneInThePaintAndClipsNothing) {
  for (int k = 0; k < 3000; ++k) {
    glm::vec3 albedo(0.9f * UnitFloat(Hash(k, 1)), 0.9f * UnitFloat(Hash(k, 2)), 0.9f * UnitFloat(Hash(k, 3)));
    if (k % 3 == 0) albedo = glm::vec3(k & 8 ? 0.9f : 0.01f, k & 16 ? 0.9f : 0.01f, k & 32 ? 0.9f : 0.01f);
    const internal::Tint tint{0.2f + 0.7f * UnitFloat(Hash(k, 4)), 1.0f, ColorizeMode::kOklab};
    double last = -1.0;
    for (int step = 0; step <= 40; ++step) {
      std::uint16_t texel[4] = {Grey(step / 40.0), Grey(step / 40.0), Grey(step / 40.0), 65535};
      tint.Apply(albedo, texel);
      const double lightness = Oklab(Linear(texel)).x;
      ASSERT_GE(lightness, last - 2e-4) << "albedo " << k << " step " << step;
      if (step < 39) {
        ASSERT_LT(std::max({texel[0], texel[1], texel[2]}), Grey(1.0) - 100) << "albedo " << k << " step " << step;
      }
      last = lightness;
    }
  }
}

// Strokes on light and dark surfaces keep the share of their contrast in the formula: L / R below the reference, the
// room above it.
TEST(Tint, StrokesKeepTheirContrast) {
  for (const float albedo : {0.9f, 0.6f, 0.3f, 0.1f, 0.02f}) {
    const double scene = std::cbrt(static_cast<double>(albedo)), reference = 0.6;
    const internal::Tint tint{0.6f, 1.0f, ColorizeMode::kOklab};
    double variance = 0.0, mean = 0.0, own_variance = 0.0, count = 0.0;
    for (int k = 0; k < 2000; ++k) {
      const double own = 0.4 + 0.4 * UnitFloat(Hash(k));  // mean 0.6
      std::uint16_t texel[4] = {Grey(own), Grey(own), Grey(own), 65535};
      tint.Apply(glm::vec3(albedo), texel);
      const double found = Oklab(Linear(texel)).x;
      mean += found, variance += found * found, own_variance += (own - 0.6) * (own - 0.6), count += 1.0;
    }
    variance -= mean * mean / count;
    const double least = std::min(scene / reference, (1.0 - scene) / (1.0 - std::min(reference, scene)));
    EXPECT_GT(variance, least * least * own_variance) << albedo;
    EXPECT_GT(variance, 0.1 * own_variance) << albedo;
  }
}

TEST(Tint, AnyInputGivesAColour) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  for (const float reference : {0.0f, 0.5f, 1.0f}) {
    for (const float albedo : {0.0f, 1.0f, kInfinity, -kInfinity, kNan}) {
      for (const int tone : {0, 30000, 65535}) {
        std::uint16_t texel[4];
        std::fill_n(texel, 4, static_cast<std::uint16_t>(tone));
        internal::Tint{reference, 1.0f, ColorizeMode::kOklab}.Apply(glm::vec3(albedo), texel);
        EXPECT_EQ(texel[3], tone);
        if (albedo == 0.0f && tone == 0) {
          EXPECT_EQ(texel[0], 0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace scumble
