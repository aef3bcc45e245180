// Frames painted by bands of rows against frames painted through a field of the whole picture: one picture, to the
// byte.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/support/every_instruction_set.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

enum class Cover { kAll, kNone, kOne, kLastRow, kHoles, kSoft };

// Hills of several objects at several depths, with all layers that a style by bands may read, all from one number.
GuideSet RandomGuides(int width, int height, Cover cover, std::uint64_t seed) {
  GuideSet guides = MakeGuides(width, height, [&](int x, int y) {
    if (Hash(seed, x / 23, y / 17, 1) % 9 == 0) return AnyDirection(Hash(seed, x, y));
    const float u = 0.05f * static_cast<float>(x), v = 0.07f * static_cast<float>(y);
    return glm::normalize(glm::vec3(std::sin(u + 0.3f * v), std::cos(v - 0.2f * u), 0.8f));
  });
  for (const Layer layer : {Layer::kLuminance, Layer::kAlbedo}) guides.Add(layer);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const int x = int(i) % width, y = int(i) / width;
    float& coverage = guides.Plane(Layer::kCoverage)[i];
    const bool one = x == width / 2 && y == height / 2;
    if (cover == Cover::kNone || (cover == Cover::kOne && !one) || (cover == Cover::kLastRow && y != height - 1))
      coverage = 0;
    if (cover >= Cover::kHoles && Hash(seed, x / 19, y / 13, 2) % 3 == 0) coverage = 0.0f;
    if (cover == Cover::kSoft && coverage > 0.0f && Hash(seed, x, y, 3) % 5 == 0) coverage = 0.4f;
    if (Hash(seed, i, 4) % 97 == 0) coverage = std::numeric_limits<float>::quiet_NaN();
    guides.Plane(Layer::kObject)[i] = static_cast<float>(1 + Hash(seed, x / 31, y / 29, 5) % 4);
    guides.Plane(Layer::kDepth)[i] =
        5.0f + static_cast<float>(Hash(seed, x / 11, y / 7, 6) % 3) + 0.01f * static_cast<float>(x);
    guides.Plane(Layer::kLuminance)[i] = 2.0f * UnitFloat(Hash(seed, i, 7));
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = UnitFloat(Hash(seed, x / 9, y / 9, c + 8));
  }
  return guides;
}

// A pixel's style, or none; in regions, or changing from pixel to pixel.
StyleMap RandomMap(int width, int height, std::uint64_t styles, std::uint64_t seed) {
  StyleMap map{std::vector<std::uint16_t>(std::size_t(width) * height)};
  for (std::size_t i = 0; i < map.style.size(); ++i) {
    const int x = int(i) % width, y = int(i) / width, side = seed % 3 == 0 ? 1 : 14;
    const std::uint64_t piece = Hash(seed, x / side, y / side) % (styles + 2);
    map.style[i] = piece < styles    ? static_cast<std::uint16_t>(piece)
                   : piece == styles ? StyleMap::kPassThrough
                                     : StyleMap::kShadowCatcher;
  }
  return map;
}

// What kinds of styles go by bands.
Style StyleOf(int kind, int radius, std::uint64_t seed) {
  Style style = PlainStyle(NoisePicture(48 + static_cast<int>(seed % 40)));
  style.transfer.blend_radius = radius;
  style.transfer.jitter_fps = seed % 2 == 0 ? 0.0 : -1.0;
  switch (kind) {
    case 1:
      style.transfer.edge_aware = true;
      break;
    case 2:
      style.transfer.colorize = 0.7;
      style.transfer.colorize_mode = seed % 3 == 0 ? ColorizeMode::kOklab : ColorizeMode::kMultiply;
      break;
    case 3:
      style.exemplars.push_back({"lit.png", PositionPicture(style.exemplars[0].picture.width), std::nullopt});
      style.exemplars[0].luminance = 0.3, style.exemplars[1].luminance = 1.5;
      style.transfer.luminance_weight = 0.4;
      break;
    case 4:
      style.transfer.variety = 20.0;
      style.transfer.edge_aware = true;
      break;
    default:
      break;
  }
  return style;
}

struct BandJob {
  std::vector<const PreparedStyle*> styles;
  const StyleMap* map = nullptr;
  const GuideSet& guides;
  TransferOptions options;
};

// The third of three frames, in buffers that hold what no transfer leaves: then seeds are looked up that were kept.
Picture Paint(const BandJob& job, bool keep_field, int threads) {
  TransferScratch scratch;
  Picture out(job.guides.width(), job.guides.height());
  TransferOptions options = job.options;
  options.threads = threads, options.keep_field = keep_field;
  for (int k = 0; k < 3; ++k) {
    std::fill(out.rgba.begin(), out.rgba.end(), std::uint16_t{4711});
    ++options.frame;
    const Status done = job.map ? Transfer(job.styles, *job.map, job.guides, options, scratch, out)
                                : Transfer(*job.styles.front(), job.guides, options, scratch, out);
    EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().message);
  }
  EXPECT_EQ(scratch.field.x.size(), keep_field ? job.guides.pixel_count() : 0);
  EXPECT_EQ(scratch.active.size(), keep_field ? job.guides.pixel_count() : 0);
  return out;
}

void ExpectSame(const BandJob& job) {
  const Picture whole = Paint(job, true, 1);
  for (const int threads : {1, 3}) {
    const Picture banded = Paint(job, false, threads);
    ASSERT_EQ(banded.width, whole.width);
    for (int y = 0; y < whole.height; ++y) {
      for (int x = 0; x < whole.width; ++x) {
        for (int c = 0; c < 4; ++c)
          ASSERT_EQ(banded.At(x, y)[c], whole.At(x, y)[c]) << x << ", " << y << ", " << threads;
      }
    }
  }
}

std::vector<std::optional<Region>> RegionsOf(int width, int height) {
  return {std::nullopt, Region{width / 3, height / 4, width - width / 5, height - height / 7},
          Region{width / 2, height / 2, width / 2 + 1, height / 2 + 1}, Region{0, height - 1, width, height}};
}

TEST(Bands, OneStyleIsPaintedAsThroughAField) {
  const std::pair<int, int> sizes[] = {{1, 1}, {1, 70}, {130, 1}, {67, 45}, {531, 143}, {200, 300}};
  std::uint64_t seed = 1;
  for (const auto& [width, height] : sizes) {
    for (const Cover cover : {Cover::kAll, Cover::kNone, Cover::kOne, Cover::kLastRow, Cover::kHoles, Cover::kSoft}) {
      const GuideSet guides = RandomGuides(width, height, cover, ++seed);
      for (int kind = 0; kind < 5; ++kind) {
        const int radius = static_cast<int>((seed + kind) % 4);
        const auto prepared = Prepare(StyleOf(kind, radius, seed), height);
        ASSERT_TRUE(prepared.ok()) << prepared.error().message;
        for (const std::optional<Region>& region : RegionsOf(width, height)) {
          SCOPED_TRACE(::testing::Message() << width << "×" << height << ", cover " << int(cover) << ", kind " << kind
                                            << ", radius " << radius << (region ? ", region" : ""));
          BandJob job{{&*prepared}, nullptr, guides, {}};
          job.options.region = region, job.options.seed = seed, job.options.exposure = kind == 3 ? 0.3 : 0.0;
          ExpectSame(job);
          if (HasFatalFailure()) return;
        }
      }
    }
  }
}

TEST(Bands, ManyStylesArePaintedAsThroughAField) {
  const Picture under = NoisePicture(600);
  std::uint64_t seed = 1;
  for (const auto& [width, height] : {std::pair{90, 61}, std::pair{540, 137}, std::pair{33, 260}}) {
    for (const Cover cover : {Cover::kAll, Cover::kHoles, Cover::kSoft}) {
      const GuideSet guides = RandomGuides(width, height, cover, ++seed);
      std::vector<PreparedStyle> prepared;
      for (int s = 0; s < 7; ++s) {
        auto one = Prepare(StyleOf(s % 5, static_cast<int>((seed + s) % 4), seed + s), height);
        ASSERT_TRUE(one.ok());
        prepared.push_back(std::move(*one));
      }
      const StyleMap map = RandomMap(width, height, 7, seed);
      BandJob job{{}, &map, guides, {}};
      for (const PreparedStyle& style : prepared) job.styles.push_back(&style);
      Picture over(width, height);
      for (std::size_t i = 0; i < over.rgba.size(); ++i) over.rgba[i] = under.rgba[i];
      for (const std::optional<Region>& region : RegionsOf(width, height)) {
        job.options.region = region, job.options.seed = seed, job.options.exposure = 0.5;
        job.options.over = seed % 2 == 0 ? &over : nullptr;
        ExpectSame(job);
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(Bands, EveryInstructionSetPaintsTheSame) {
  const GuideSet guides = RandomGuides(300, 90, Cover::kHoles, 5);
  const auto prepared = Prepare(StyleOf(1, 2, 4), 90);
  ASSERT_TRUE(prepared.ok());
  const BandJob job{{&*prepared}, nullptr, guides, {}};
  const Picture expected = Paint(job, true, 1);
  OnEveryInstructionSet([&] { EXPECT_EQ(Paint(job, false, 2).rgba, expected.rgba); });
}

// A style that needs all sources at once is painted through a field, whatever the others are.
TEST(Bands, OneStyleThatNeedsTheFieldBringsItForAll) {
  const GuideSet guides = RandomGuides(80, 60, Cover::kHoles, 9);
  Style wide = StyleOf(0, 5, 2), lit = StyleOf(0, 1, 3);
  lit.transfer.method = Method::kLitSphere;
  for (const Style& style : {wide, lit}) {
    const auto one = Prepare(style, 60), other = Prepare(StyleOf(0, 1, 4), 60);
    ASSERT_TRUE(one.ok() && other.ok());
    const StyleMap map = RandomMap(80, 60, 2, 4);
    const PreparedStyle* const styles[] = {&*other, &*one};
    TransferScratch scratch;
    Picture out;
    ASSERT_TRUE(Transfer(styles, map, guides, {}, scratch, out).ok());
    EXPECT_EQ(scratch.field.x.size(), guides.pixel_count());
  }
}

TEST(Bands, StagesTakeTime) {
  const GuideSet guides = RandomGuides(120, 200, Cover::kHoles, 3);
  const auto prepared = Prepare(StyleOf(0, 1, 4), 200);
  ASSERT_TRUE(prepared.ok());
  TransferScratch scratch;
  Picture out;
  int calls = 0;
  TransferOptions options;
  options.progress = [&calls](double) { return ++calls > 0; };
  ASSERT_TRUE(Transfer(*prepared, guides, options, scratch, out).ok());
  EXPECT_GE(calls, 200 / 24) << "of rows that are done together";
  EXPECT_GT(scratch.times.match_ms, 0.0);
  EXPECT_GT(scratch.times.vote_ms, 0.0);
}

}  // namespace
}  // namespace scumble
