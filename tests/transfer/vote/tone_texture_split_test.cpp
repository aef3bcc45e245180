// Base layer by Lit Sphere, detail layer by StyleBlit: the split against plain convolution, the sum against its
// definition.
#include "transfer/vote/tone_texture_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <set>
#include <vector>

#include "core/filter/masked_blur.h"
#include "core/image/color.h"
#include "core/image/fragments.h"
#include "tests/support/light_fixtures.h"
#include "tests/support/numbers.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

// Irregular colours and opacities, from `least_alpha` on.
Picture AnyPicture(int width, int height, std::uint64_t seed, int least_alpha) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    const std::uint64_t hash = Hash(seed, i);
    picture.rgba[i] =
        static_cast<std::uint16_t>(i % 4 < 3 ? hash & 0xffff : least_alpha + hash % (65536 - least_alpha));
  }
  return picture;
}

std::vector<std::uint8_t> AnyMask(int width, int height) {
  std::vector<std::uint8_t> mask(std::size_t(width) * height);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const double x = double(i % width) - 0.4 * width, y = double(i / width) - 0.5 * height;
    mask[i] = x * x + y * y < 0.16 * width * height && Hash(3, i) % 10 != 0;
  }
  mask.front() = 1;  // far from the others
  return mask;
}

// ---- The blur -------------------------------------------------------------------------------------------------------

// The kernel by its definition: the box of weights 1 and, at either end, one below 1, whose variance is a quarter of
// sigma², four times convolved with itself.
std::vector<double> Kernel(double sigma) {
  const double variance = sigma * sigma / 4;
  int l = 0;
  while ((l + 1) * (l + 2) / 3.0 <= variance) ++l;  // variance of 2 (l + 1) + 1 equal weights
  double flat = 0.0;                                // of the squares of -l … l
  for (int i = -l; i <= l; ++i) flat += i * i;
  // (flat + 2 e (l + 1)²) / (2 l + 1 + 2 e) = variance
  const double e = ((2 * l + 1) * variance - flat) / (2.0 * ((l + 1) * (l + 1) - variance));
  std::vector<double> box(std::size_t(2 * l + 3), 1.0), kernel{1.0};
  box.front() = box.back() = e;
  for (int pass = 0; pass < 4; ++pass) {
    std::vector<double> wider(kernel.size() + box.size() - 1, 0.0);
    for (std::size_t a = 0; a < kernel.size(); ++a) {
      for (std::size_t b = 0; b < box.size(); ++b) wider[a + b] += kernel[a] * box[b];
    }
    kernel = wider;
  }
  const double sum = std::accumulate(kernel.begin(), kernel.end(), 0.0);
  for (double& weight : kernel) weight /= sum;
  return kernel;
}

TEST(MaskedBlur, ItsKernelIsNearlyTheGaussianOfThatSigma) {
  for (const double sigma : {0.3, 1.0, 2.7, 9.0, 40.0}) {
    const std::vector<double> kernel = Kernel(sigma);
    const int reach = static_cast<int>(kernel.size() / 2);
    double variance = 0.0, worst = 0.0;
    const double peak = 1.0 / (sigma * std::sqrt(2 * 3.14159265358979));
    for (int i = -reach; i <= reach; ++i) {
      variance += kernel[std::size_t(i + reach)] * i * i;
      worst = std::max(
          worst, std::fabs(kernel[std::size_t(i + reach)] - peak * std::exp(-0.5 * i * i / sigma / sigma)) / peak);
    }
    EXPECT_NEAR(variance, sigma * sigma, 1e-9 * sigma * sigma);
    EXPECT_LT(worst, sigma >= 2.0 ? 0.05 : 1.0) << sigma;
  }
}

TEST(MaskedBlur, IsTheQuotientOfPlainConvolutions) {
  const int width = 41, height = 34;
  const Picture picture = AnyPicture(width, height, 1, 0);
  const std::vector<std::uint8_t> mask = AnyMask(width, height);
  for (const double sigma : {0.3, 1.0, 2.7, 9.0, 33.0}) {
    const Picture blurred = internal::MaskedBlur(picture, mask, sigma);
    const std::vector<double> kernel = Kernel(sigma);
    const int reach = static_cast<int>(kernel.size() / 2);
    const auto weight = [&](int d) { return std::abs(d) > reach ? 0.0 : kernel[std::size_t(d + reach)]; };
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double sum[4] = {0, 0, 0, 0}, total = 0.0;
        for (int v = 0; v < height; ++v) {
          for (int u = 0; u < width; ++u) {
            if (!mask[std::size_t(v) * width + u]) continue;
            const double w = weight(u - x) * weight(v - y);
            total += w;
            const std::uint16_t* texel = picture.At(u, v);
            for (int c = 0; c < 4; ++c)
              sum[c] += w * (c < 3 ? std::floor(texel[c] * double(texel[3]) / 65535 + 0.5) : texel[3]);
          }
        }
        const bool inside = mask[std::size_t(y) * width + x];
        for (int c = 0; c < 4; ++c) {
          ASSERT_NEAR(blurred.At(x, y)[c], inside ? sum[c] / total : 0.0, 0.51) << sigma << " at " << x << ", " << y;
        }
      }
    }
  }
}

TEST(MaskedBlur, KeepsAFlatToneAndBecomesTheMean) {
  const int width = 30, height = 50;
  Picture flat(width, height);
  for (std::size_t i = 0; i < flat.rgba.size(); ++i) flat.rgba[i] = i % 4 == 3 ? 65535 : 12345;
  const std::vector<std::uint8_t> mask = AnyMask(width, height);
  for (const double sigma : {0.5, 7.0, 49.0, 50.0, double(kInfinity)}) {
    const Picture blurred = internal::MaskedBlur(flat, mask, sigma);
    for (std::size_t i = 0; i < mask.size(); ++i) {
      ASSERT_EQ(blurred.rgba[4 * i], mask[i] ? 12345 : 0) << sigma;
      ASSERT_EQ(blurred.rgba[4 * i + 3], mask[i] ? 65535 : 0) << sigma;
    }
  }
  const Picture any = AnyPicture(width, height, 2, 0), mean = internal::MaskedBlur(any, mask, kInfinity);
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i]) sum += std::floor(any.rgba[4 * i] * double(any.rgba[4 * i + 3]) / 65535 + 0.5), count += 1.0;
  }
  for (std::size_t i = 0; i < mask.size(); ++i) {
    ASSERT_NEAR(mean.rgba[4 * i], mask[i] ? sum / count : 0.0, 0.51);
  }
}

// ---- The transfer ---------------------------------------------------------------------------------------------------

TEST(Hybrid, ZeroIsThePlainEngineAndAnEvenToneToo) {
  const GuideSet guides = HillGuides(120, 90);
  for (const int radius : {0, 1, 4}) {
    for (const Method method : {Method::kStyleBlit, Method::kLitSphere, Method::kBruteForce}) {
      Style style = PlainStyle(NoisePicture(80));
      style.transfer.method = method;
      style.transfer.blend_radius = radius;
      const Transferred plain = MustTransfer(style, guides);
      style.transfer.hybrid = 0.0;
      EXPECT_EQ(Prepare(style, 90)->base_layers, nullptr);
      EXPECT_EQ(MustTransfer(style, guides).picture.rgba, plain.picture.rgba);
      style.transfer.hybrid = kInfinity;
      const Transferred even = MustTransfer(style, guides);
      EXPECT_EQ(even.picture.rgba, plain.picture.rgba) << "one tone everywhere";
      EXPECT_TRUE(SameField(even.field, plain.field));
      style.transfer.hybrid = 3.0;
      EXPECT_NE(MustTransfer(style, guides).picture.rgba, plain.picture.rgba);
    }
  }
}

TEST(Hybrid, ASphereBecomesItsExemplar) {
  Style style = PlainStyle(NoisePicture(96));
  style.transfer.hybrid = 5.0;
  style.transfer.blend_radius = 0;
  const Transferred result = MustTransfer(style, SphereGuides(96));
  const auto prepared = Prepare(style, 96);
  int count = 0;
  for (const Source at : prepared->exemplar->UsablePixels()) {
    if (result.field.x[std::size_t(at.y) * 96 + at.x] != at.x)
      continue;  // some seeds are on the rim, which is not used
    if (result.field.y[std::size_t(at.y) * 96 + at.x] != at.y) continue;
    ++count;
    ASSERT_EQ(result.picture.At(at.x, at.y)[0], style.exemplars[0].picture.At(at.x, at.y)[0]) << at.x << ", " << at.y;
  }
  EXPECT_GT(count, 6000);
}

// Hills under light that changes from left to right, for two exemplars.
GuideSet HillsLitFromTheLeft(int width, int height) {
  GuideSet guides = HillGuides(width, height);
  guides.Add(Layer::kLuminance);
  guides.Add(Layer::kAlbedo);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kLuminance)[i] = 1.0f - float(i % width) / float(width);
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = 0.2f + 0.3f * float(c);
  }
  return guides;
}

Style TwoExemplars(int size, bool is_sphere) {
  Style style = PlainStyle(AnyPicture(size, size, 5, 30000));
  style.exemplars[0].luminance = 0.9;
  style.exemplars.push_back({"dark.png", AnyPicture(size, size, 6, 30000), 0.2});
  for (Exemplar& exemplar : style.exemplars) {
    exemplar.is_sphere = is_sphere;
    if (!is_sphere) exemplar.guides = SphereGuides(size);
  }
  style.transfer.hybrid = 4.0;
  style.transfer.luminance_weight = 0.1f;
  return style;
}

// A channel of a base layer, colours times alpha.
double OfBase(const Picture& base, int x, int y, int c) {
  const std::uint16_t* texel = base.At(x, y);
  return c < 3 ? texel[c] * double(texel[3]) / 65535 : texel[3];
}

// Bilinear in doubles, over usable texels.
std::array<double, 4> ToneAt(const PreparedExemplar& exemplar, const Picture& tone, glm::vec3 normal) {
  std::array<double, 4> sum{};
  if (!exemplar.is_sphere()) {
    const Source at = exemplar.NearestNeighbour(normal);
    for (int c = 0; c < 4; ++c) sum[c] = OfBase(tone, at.x, at.y, c);
    return sum;
  }
  const glm::vec2 place = exemplar.OnDisc(normal);
  const double u = (place.x + 1.0) * exemplar.size() / 2 - 0.5, v = (1.0 - place.y) * exemplar.size() / 2 - 0.5;
  double total = 0.0;
  for (int y = int(std::floor(v)); y <= int(std::floor(v)) + 1; ++y) {
    for (int x = int(std::floor(u)); x <= int(std::floor(u)) + 1; ++x) {
      if (!exemplar.Usable(x, y)) continue;
      const double weight = (1.0 - std::fabs(u - x)) * (1.0 - std::fabs(v - y));
      total += weight;
      for (int c = 0; c < 4; ++c) sum[c] += weight * OfBase(tone, x, y, c);
    }
  }
  for (double& value : sum) value /= total;
  return sum;
}

TEST(Hybrid, IsTheOwnTonePlusTheMeanOfTheTexturesVotedFor) {
  const GuideSet guides = HillsLitFromTheLeft(70, 60);
  for (const bool is_sphere : {true, false}) {
    Style style = TwoExemplars(90, is_sphere);
    style.transfer.edge_aware = false;
    style.transfer.blend_radius = 2;
    const auto prepared = Prepare(style, 60);
    ASSERT_TRUE(prepared.ok()) << prepared.error().message;
    const PreparedExemplar& exemplar = *prepared->exemplar;
    const Transferred result = MustTransfer(style, guides);
    const SourceField& field = result.field;
    int foreign = 0;
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 70; ++x) {
        const std::size_t p = field.Index(x, y);
        if (field.level[p] == SourceField::kNoSource) continue;
        const int own = prepared->illumination.Choose(guides.Plane(Layer::kLuminance)[p]);
        foreign += own != field.exemplar[p];
        const auto tone = ToneAt(exemplar, prepared->base_layers->picture(own), guides.Vec3(Layer::kNormal, p));
        double texture[4] = {0, 0, 0, 0}, votes = 0.0;
        for (int v = std::max(0, y - 2); v <= std::min(59, y + 2); ++v) {
          for (int u = std::max(0, x - 2); u <= std::min(69, x + 2); ++u) {
            const std::size_t q = field.Index(u, v);
            const int sx = field.x[q] + x - u, sy = field.y[q] + y - v;
            if (field.level[q] == SourceField::kNoSource || !exemplar.Usable(sx, sy)) continue;
            if (std::max(std::abs(u - x), std::abs(v - y)) > 1 << field.level[q]) continue;
            const std::uint16_t* paint = exemplar.picture(field.exemplar[q]).At(sx, sy);
            for (int c = 0; c < 4; ++c) {
              const double value = c < 3 ? paint[c] * double(paint[3]) / 65535 : paint[3];
              texture[c] += value - OfBase(prepared->base_layers->picture(field.exemplar[q]), sx, sy, c);
            }
            votes += 1.0;
          }
        }
        const double alpha = std::clamp(tone[3] + texture[3] / votes, 0.0, 65535.0);
        // Base layers are read in steps of 1/256 texel, and both parts are rounded separately.
        constexpr double kSlack = 300.0;
        ASSERT_NEAR(result.picture.At(x, y)[3], alpha, kSlack) << x << ", " << y;
        for (int c = 0; c < 3; ++c) {
          const double color = std::clamp(tone[c] + texture[c] / votes, 0.0, alpha);
          const double got = result.picture.At(x, y)[c] * double(result.picture.At(x, y)[3]) / 65535;
          ASSERT_NEAR(got, color, kSlack) << x << ", " << y;
        }
      }
    }
    EXPECT_GT(foreign, 30) << "pixels whose chunk has another light than they";
  }
}

// What the mode is for: 0.5 + 0.3 nx in tone, and a texture of known strength over it.
Picture RampPicture(int size, int texture) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double nx = (2.0 * x + 1 - size) / size;
      // Strokes of three texels, so that their mean over a few is near 0.
      const int noise = texture ? static_cast<int>(Hash(x / 3, y / 3) % std::uint64_t(2 * texture + 1)) - texture : 0;
      for (int c = 0; c < 3; ++c)
        picture.At(x, y)[c] = static_cast<std::uint16_t>(32768.0 + 20000.0 * nx + noise + 0.5);
      picture.At(x, y)[3] = 65535;
    }
  }
  return picture;
}

struct Departure {
  double worst = 0.0, mean_square = 0.0, worst_local_mean = 0.0;
};

// From the formula, where the hills are not too steep: there the blur does not reach the rim, where a mean leans
// inward.
Departure FromTheRamp(const Transferred& result, const GuideSet& guides) {
  Departure departure;
  const int width = guides.width(), height = guides.height(), reach = 7;
  std::vector<double> off(guides.pixel_count(), std::nan(""));
  double count = 0.0;
  for (std::size_t i = 0; i < off.size(); ++i) {
    const glm::vec3 n = guides.Vec3(Layer::kNormal, i);
    if (result.field.level[i] == SourceField::kNoSource || n.x * n.x + n.y * n.y > 0.3f) continue;
    const int u = result.field.x[i], v = result.field.y[i];  // of 256: the chunk's place must be as far from the rim
    if ((u - 127.5) * (u - 127.5) + (v - 127.5) * (v - 127.5) > 85 * 85) continue;
    off[i] = result.picture.rgba[4 * i] - (32768.0 + 20000.0 * n.x);
    departure.worst = std::max(departure.worst, std::fabs(off[i]));
    departure.mean_square += off[i] * off[i], count += 1.0;
  }
  departure.mean_square /= count;
  EXPECT_GT(count, 2000);
  for (int y = reach; y + reach < height; y += 5) {
    for (int x = reach; x + reach < width; x += 5) {
      double sum = 0.0, n = 0.0;
      for (int v = y - reach; v <= y + reach; ++v) {
        for (int u = x - reach; u <= x + reach; ++u) {
          const double here = off[guides.Index(u, v)];
          if (!std::isnan(here)) sum += here, n += 1.0;
        }
      }
      if (n > 200) departure.worst_local_mean = std::max(departure.worst_local_mean, std::fabs(sum / n));
    }
  }
  return departure;
}

TEST(Hybrid, KeepsTheToneExactAndTheTextureUnblurred) {
  const GuideSet guides = HillGuides(260, 200);
  Style style = PlainStyle(RampPicture(256, 0));
  style.transfer.threshold = 0.6f;  // chunks far larger than the tone bears
  style.transfer.blend_radius = 0;
  const Departure plain_ramp = FromTheRamp(MustTransfer(style, guides), guides);
  style.transfer.hybrid = 9.0;
  const Departure hybrid_ramp = FromTheRamp(MustTransfer(style, guides), guides);
  EXPECT_GT(plain_ramp.worst, 5000.0);
  EXPECT_LT(hybrid_ramp.worst, 4.0);

  style = PlainStyle(RampPicture(256, 6000));
  style.transfer.threshold = 0.6f;
  style.transfer.blend_radius = 0;
  const Departure plain = FromTheRamp(MustTransfer(style, guides), guides);
  style.transfer.hybrid = 9.0;
  const Departure hybrid = FromTheRamp(MustTransfer(style, guides), guides);
  EXPECT_GT(plain.worst_local_mean, 3.0 * hybrid.worst_local_mean);
  // A texture evenly spread over ±6000 has a mean square of 12·10⁶; what of it is slow goes with the tone.
  EXPECT_NEAR(hybrid.mean_square, 6000.0 * 6000.0 / 3.0, 0.12 * 6000.0 * 6000.0 / 3.0);
}

TEST(Hybrid, FollowsTheScale) {
  Style style = PlainStyle(NoisePicture(96));
  style.transfer.hybrid = 6.0;
  style.transfer.scale = 0.5;
  const auto prepared = Prepare(style, 60);
  ASSERT_TRUE(prepared.ok());
  EXPECT_EQ(prepared->base_layers->picture(0).rgba, MakeBaseLayers(*prepared->exemplar, 3.0).picture(0).rgba);
  style.transfer.scale = 1.0, style.transfer.reference_height = 40;
  const auto taller = Prepare(style, 60);
  ASSERT_TRUE(taller.ok());
  EXPECT_EQ(taller->base_layers->picture(0).rgba, MakeBaseLayers(*taller->exemplar, 9.0).picture(0).rgba);
}

// Two exemplars of one colour each.
Style BrightAndDark(int size, int alpha) {
  Style style = PlainStyle(Picture(size, size));
  style.exemplars[0].luminance = 0.9;
  style.exemplars.push_back({"dark.png", Picture(size, size), 0.2});
  for (std::size_t k = 0; k < 2; ++k) {
    std::vector<std::uint16_t>& rgba = style.exemplars[k].picture.rgba;
    for (std::size_t i = 0; i < rgba.size(); ++i)
      rgba[i] = static_cast<std::uint16_t>(i % 4 == 3 ? alpha : k == 0 ? 60000 : 20000);
  }
  style.transfer.hybrid = 4.0;
  style.transfer.blend_radius = 0;
  return style;
}

double LightAt(const Picture& picture, int x, int y) { return Srgb16ToLinear(picture.At(x, y)[1]); }

// Borders of hard and of soft light have the area of a straight line, where light is known at pixel centres alone.
TEST(Hybrid, BordersOfTonesAreNoStairs) {
  const double slope = 0.23, at = 20.4;
  for (const double steepness : {10.0, 0.01}) {
    for (const int alpha : {65535, 30000}) {
      GuideSet guides = SlantedShadow(64, at, slope);
      for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
          const double below = y + 0.5 - at - slope * (x + 0.5);
          guides.Plane(Layer::kLuminance)[guides.Index(x, y)] =
              static_cast<float>(std::clamp(0.55 + steepness * below, 0.0, 1.0));
        }
      }
      const Picture made = MustTransfer(BrightAndDark(64, alpha), guides).picture;
      const double dark = LightAt(made, 20, 8), bright = LightAt(made, 20, 56);
      ASSERT_GT(bright, dark + 0.1);
      const Errors errors =
          ErrorsAlong(64, at, slope, [&](int x, int y) { return (bright - LightAt(made, x, y)) / (bright - dark); });
      EXPECT_LT(errors.mean, 0.1) << steepness;
      EXPECT_LT(errors.most, 0.3) << steepness;
      for (std::size_t i = 3; i < made.rgba.size(); i += 4) ASSERT_EQ(made.rgba[i], alpha);
    }
  }
}

// Neither do borders of objects mix, nor pixels that have fragments.
TEST(Hybrid, OnlyBordersWithinOneSurfaceAreMixed) {
  GuideSet guides = SlantedShadow(64, 20.4, 0.23);
  const auto tones = [&] {
    std::set<std::uint16_t> colors;
    const Picture made = MustTransfer(BrightAndDark(64, 65535), guides).picture;
    for (std::size_t i = 0; i < made.rgba.size(); i += 4) colors.insert(made.rgba[i]);
    return colors.size();
  };
  EXPECT_GT(tones(), 2u);
  const auto object = guides.Plane(Layer::kObject), light = guides.Plane(Layer::kLuminance);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) object[i] = light[i] > 0.5f ? 1.0f : 2.0f;
  EXPECT_EQ(tones(), 2u);

  std::ranges::fill(object, 1.0f);
  const auto fragments = std::make_shared<Fragments>();
  for (std::uint32_t i = 0; i < guides.pixel_count(); ++i) fragments->pixel.push_back(i);
  fragments->values = GuideSet(static_cast<int>(guides.pixel_count()), 1);
  for (const LayerInfo& info : AllLayers()) {
    for (int c = 0; guides.Has(info.layer) && c < ChannelCount(info.layer); ++c) {
      fragments->values.Add(info.layer);
      std::ranges::copy(guides.Plane(info.layer, c), fragments->values.Plane(info.layer, c).begin());
    }
  }
  std::ranges::fill(fragments->values.Plane(Layer::kCoverage), 0.5f);
  guides.fragments = fragments;
  EXPECT_EQ(tones(), 2u);
}

TEST(Hybrid, ThreadsAndRegionsDoNotChangeAByte) {
  GuideSet guides = HillsLitFromTheLeft(131, 97);
  for (int y = 0; y < 97; ++y) {
    for (int x = 0; x < 131; ++x) {
      float& light = guides.Plane(Layer::kLuminance)[guides.Index(x, y)];
      light += 0.03f * static_cast<float>(y % 31) + (3 * x + 7 * y > 500 ? 0.4f : 0.0f);
    }
  }
  for (const bool is_sphere : {true, false}) {
    Style style = TwoExemplars(120, is_sphere);
    style.transfer.colorize = 0.7, style.transfer.colorize_mode = ColorizeMode::kOklab;
    style.transfer.variety = 10.0;
    style.transfer.blend_radius = 3;
    TransferOptions options;
    options.threads = 1;
    const Picture whole = MustTransfer(style, guides, options).picture;
    options.threads = 3;
    EXPECT_EQ(MustTransfer(style, guides, options).picture.rgba, whole.rgba);
    const auto prepared = Prepare(style, 97);
    Picture tiled;
    TransferScratch scratch;
    for (int y = 0; y < 97; y += 23) {
      for (int x = 0; x < 131; x += 31) {
        options.region = Region{x, y, x + 31, y + 23};
        ASSERT_TRUE(Transfer(*prepared, guides, options, scratch, tiled).ok());
      }
    }
    EXPECT_EQ(tiled.rgba, whole.rgba);
  }
}

TEST(Hybrid, RefusesWhatIsNoWidth) {
  Style style = PlainStyle(NoisePicture(32));
  for (const double bad : {-1.0, std::nan("")}) {
    style.transfer.hybrid = bad;
    const auto prepared = Prepare(style, 32);
    ASSERT_FALSE(prepared.ok());
    EXPECT_NE(prepared.error().message.find("transfer.hybrid"), std::string::npos);
  }
}

}  // namespace
}  // namespace scumble
