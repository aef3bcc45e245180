// Many pixels tinted at once equal each tinted by itself, to the last bit.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/every_instruction_set.h"
#include "tests/support/numbers.h"
#include "tests/support/transfer_fixtures.h"
#include "transfer/tint/colorize.h"
#include "transfer/tint/tint_row.h"

namespace scumble {
namespace {

using namespace testing;

struct Pixels {
  std::vector<float> albedo[3];
  std::vector<std::uint16_t> texels;

  explicit Pixels(std::size_t count) : texels(4 * count) {
    for (auto& plane : albedo) plane.resize(count);
  }
  std::size_t count() const { return albedo[0].size(); }
};

// Albedos of many kinds: even, dark, of every magnitude, nearly 1, the same everywhere, beyond the gamut, and extremes.
float AnyAlbedo(int kind, std::size_t i, int c) {
  constexpr float kExtremes[] = {0.0f,  -0.0f, 1.0f, 1.0000001f, 2.0f, 1e-30f,   1e-45f,     3.0517578e-5f,
                                 1e30f, -1.0f, 0.5f, kInfinity,  kNan, 65504.0f, -kInfinity, 0.0031308f};
  const float u = UnitFloat(Hash(kind, i, c));
  switch (kind % 8) {
    case 0:
      return u;
    case 1:
      return u * u * u * u;
    case 2:
      return std::ldexp(1.0f + u, -int(Hash(i, c, 9) % 30));
    case 3:
      return 1.0f - 1e-3f * u;
    case 4:
      return UnitFloat(Hash(kind, c));
    case 5:
      return 2.5f * u - 0.2f;
    case 6:
      return i / 50 % 2 == 0 ? 1.0f : 0.0f;
    default:
      return kExtremes[Hash(kind, i, c) % std::size(kExtremes)];
  }
}

Pixels AnyPixels(std::size_t count, int kind) {
  Pixels pixels(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (int c = 0; c < 3; ++c) {
      pixels.albedo[c][i] = AnyAlbedo(kind, i, c);
      // Every code once in 65,536; with kinds of 16 and more only dark ones.
      const std::size_t code = i + 20011 * std::size_t(c);
      pixels.texels[4 * i + std::size_t(c)] = static_cast<std::uint16_t>(kind < 16 ? code : code % 3000);
    }
    pixels.texels[4 * i + 3] = static_cast<std::uint16_t>(Hash(i, 5));
  }
  return pixels;
}

void ExpectPlain(const Pixels& pixels, const internal::Tint& tint) {
  std::vector<std::uint16_t> expected = pixels.texels, found = pixels.texels;
  for (std::size_t i = 0; i < pixels.count(); ++i) {
    tint.Apply({pixels.albedo[0][i], pixels.albedo[1][i], pixels.albedo[2][i]}, &expected[4 * i]);
  }
  const float* const albedo[3] = {pixels.albedo[0].data(), pixels.albedo[1].data(), pixels.albedo[2].data()};
  internal::TintRow(tint, albedo, pixels.count(), found.data());
  const auto [a, b] = std::mismatch(expected.begin(), expected.end(), found.begin());
  if (a == expected.end()) return;
  const auto at = static_cast<std::size_t>(a - expected.begin());
  ADD_FAILURE() << "texel " << at / 4 << " channel " << at % 4 << ": " << pixels.texels[at] << " by albedo "
                << pixels.albedo[at % 4][at / 4] << ", weight " << tint.weight << " became " << *b << ", not " << *a;
}

internal::Tint Multiplied(float weight) { return {0.0f, weight, ColorizeMode::kMultiply}; }

TEST(FastTint, MultipliesEveryCodeAsThePlainTintDoes) {
  OnEveryInstructionSet([] {
    for (int kind = 0; kind < 24; ++kind) {
      ExpectPlain(AnyPixels(65536, kind), Multiplied(kind % 3 == 0 ? 1.0f : UnitFloat(Hash(kind, 77))));
    }
  });
}

// Paint of any colour, and paint that is nearly grey, as much of it is; references as low and as high as they may be.
TEST(FastTint, TakesHueAndChromaAsThePlainTintDoes) {
  constexpr float kReferences[] = {0.75f, 0.0f, 1.0f, 0.3f, 0.6f, 0.9f, 1e-7f},
                  kWeights[] = {1.0f, 0.5f, 0.01f, 1.0f, 0.9f};
  OnEveryInstructionSet([&] {
    for (int kind = 0; kind < 48; ++kind) {
      Pixels pixels = AnyPixels(6000, kind % 24);
      for (std::size_t i = 0; i < pixels.count(); ++i) {
        const std::uint64_t grey = 10000 + Hash(i / 8, kind) % 45000;
        for (std::size_t c = 0; c < 3 && kind < 24; ++c) {
          pixels.texels[4 * i + c] = static_cast<std::uint16_t>(kind % 2 ? Hash(i, c, kind) : grey + Hash(i, c) % 9000);
        }
      }
      ExpectPlain(pixels, {kReferences[kind % 7], kWeights[kind % 5], ColorizeMode::kOklab});
    }
  });
}

// Greys of every code, on one albedo and on albedos of every magnitude.
TEST(FastTint, TintsEveryGrey) {
  OnEveryInstructionSet([] {
    Pixels pixels(1 << 17);
    for (std::size_t i = 0; i < pixels.count(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        pixels.albedo[c][i] =
            i < 65536 ? 0.3f : std::ldexp(1.0f + static_cast<float>(i % 65536) / 65536.0f, -int(i % 70));
        pixels.texels[4 * i + c] = static_cast<std::uint16_t>(i);
      }
    }
    ExpectPlain(pixels, {0.6f, 1.0f, ColorizeMode::kOklab});
  });
}

TEST(FastTint, EveryLengthAndPlace) {
  OnEveryInstructionSet([] {
    for (std::size_t count = 0; count < 70; ++count) {
      ExpectPlain(AnyPixels(count, int(count)), Multiplied(0.7f));
      ExpectPlain(AnyPixels(count, int(count)), {0.6f, 0.7f, ColorizeMode::kOklab});
    }
    for (const std::size_t count : {255u, 256u, 257u, 511u, 1000u}) {
      ExpectPlain(AnyPixels(count, 0), {0.5f, 1.0f, ColorizeMode::kOklab});
    }
  });
}

// White things keep the paint's very codes when it is multiplied, whatever the weight.
TEST(FastTint, WhiteMultipliesToTheSame) {
  OnEveryInstructionSet([] {
    Pixels pixels = AnyPixels(65536, 0);
    for (auto& plane : pixels.albedo) std::fill(plane.begin(), plane.end(), 1.0f);
    const float* const albedo[3] = {pixels.albedo[0].data(), pixels.albedo[1].data(), pixels.albedo[2].data()};
    for (const float weight : {1.0f, 0.5f, 0.25f}) {
      std::vector<std::uint16_t> found = pixels.texels;
      internal::TintRow(Multiplied(weight), albedo, pixels.count(), found.data());
      ASSERT_EQ(found, pixels.texels) << weight;
    }
  });
}

// The pixels around a run keep their bytes, whatever lies in between.
TEST(FastTint, OnlyActivePixelsOfTheRegionChange) {
  constexpr int kColumns = 83, kLines = 9;
  GuideSet guides(kColumns, kLines);
  guides.Add(Layer::kAlbedo);
  for (int c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) guides.Plane(Layer::kAlbedo, c)[i] = AnyAlbedo(0, i, c);
  }
  Picture before(kColumns, kLines);
  for (std::size_t i = 0; i < before.rgba.size(); ++i) before.rgba[i] = static_cast<std::uint16_t>(Hash(i));
  for (const ColorizeMode mode : {ColorizeMode::kMultiply, ColorizeMode::kOklab}) {
    for (const int dense : {1, 2, 10, 60}) {
      std::vector<std::uint8_t> active(guides.pixel_count());
      for (std::size_t i = 0; i < active.size(); ++i)
        active[i] = Hash(i, dense) % std::uint64_t(dense) != 0 || dense == 1;
      const internal::Tint tint{0.6f, 0.8f, mode};
      for (const Region& region :
           {Region{0, 0, kColumns, kLines}, Region{7, 2, 80, 5}, Region{82, 0, 83, 9}, Region{}}) {
        Picture expected = before, found = before;
        for (int y = region.y0; y < region.y1; ++y) {
          for (int x = region.x0; x < region.x1; ++x) {
            const std::size_t i = guides.Index(x, y);
            if (active[i]) tint.Apply(guides.Vec3(Layer::kAlbedo, i), expected.At(x, y));
          }
        }
        for (int y = region.y0; y < region.y1; ++y) {
          internal::ColorizeRow({guides, active, tint}, y, region.x0, region.x1, found);
        }
        ASSERT_TRUE(found.rgba == expected.rgba) << "one in " << dense;
      }
    }
  }
}

}  // namespace
}  // namespace scumble
