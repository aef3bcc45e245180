// Smooth borders between objects against pictures of all subsamples.
#include "core/image/fragments.h"

#include <array>
#include <optional>
#include <vector>

#include "tests/support/fragment_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

// Three styles of one colour each, by object: the mean of the subsamples' colours in linear light is known.
TEST(FragmentPaint, ColoursAreMixedByCoverage) {
  const GuideSet guides = GuidesAt(kPictureWidth, kPictureHeight, kAa);
  const GuideSet fine = GuidesAt(kPictureWidth * kAa, kPictureHeight * kAa, 1);
  const std::array<std::uint16_t, 3> colors[] = {{60000, 2000, 30000}, {1000, 50000, 9000}, {20000, 20000, 65535}};
  std::vector<PreparedStyle> prepared;
  for (const auto& color : colors) prepared.push_back(MustPrepareStyle(PlainStyle(PlainColor(color))));
  const StyleAssignment assignment{{{IdOfObject(guides, "near"), 1}, {IdOfObject(guides, "far"), 2}}, {}, 0};
  const StyleMap map = MapStyles(guides, assignment), of_fine = MapStyles(fine, assignment);
  const Picture picture = MustPaint({&prepared[0], &prepared[1], &prepared[2]}, map, guides);
  int mixed = 0;
  for (int y = 0; y < kPictureHeight; ++y) {
    for (int x = 0; x < kPictureWidth; ++x) {
      float sum[3] = {};
      bool differs = false;
      for (int k = 0; k < kAa * kAa; ++k) {
        const std::size_t at = fine.Index(x * kAa + k % kAa, y * kAa + k / kAa);
        differs = differs || of_fine.style[at] != map.style[guides.Index(x, y)];
        for (int c = 0; c < 3; ++c) sum[c] += Srgb16ToLinear(colors[of_fine.style[at]][c]) / (kAa * kAa);
      }
      mixed += differs;
      const std::uint16_t* pixel = picture.At(x, y);
      ASSERT_EQ(pixel[3], 65535);
      for (int c = 0; c < 3; ++c) {
        if (differs) {
          EXPECT_NEAR(Srgb16ToLinear(pixel[c]), sum[c], 1e-4) << x << ", " << y;
        } else {
          EXPECT_EQ(pixel[c], colors[map.style[guides.Index(x, y)]][c]) << x << ", " << y;
        }
      }
    }
  }
  EXPECT_GT(mixed, 100);
}

// What finishing effects change surface by surface.
TEST(FragmentPaint, KeepsTheColoursThatItMixes) {
  const GuideSet guides = GuidesAt(kPictureWidth, kPictureHeight, kAa);
  const std::array<std::uint16_t, 3> wall = {60000, 2000, 30000}, balls = {1000, 50000, 9000};
  const PreparedStyle first = MustPrepareStyle(PlainStyle(PlainColor(wall)));
  const PreparedStyle second = MustPrepareStyle(PlainStyle(PlainColor(balls)));
  const StyleAssignment assignment{{{IdOfObject(guides, "near"), 1}, {IdOfObject(guides, "far"), 1}}, {}, 0};
  const StyleMap map = MapStyles(guides, assignment);
  TransferOptions options;
  options.keep_colors = true;
  TransferScratch scratch;
  Picture out;
  ASSERT_TRUE(Transfer({{&first, &second}}, map, guides, options, scratch, out));
  const FragmentColors& colors = scratch.colors;
  const std::vector<std::uint32_t>& pixels = guides.fragments->pixel;
  ASSERT_EQ(colors.own.size(), pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_EQ(colors.own[i][c], (map.fragment_style[i] == 1 ? balls : wall)[c]);
      if (i > 0 && pixels[i - 1] == pixels[i]) continue;
      ASSERT_EQ(colors.centre[i][c], (map.style[pixels[i]] == 1 ? balls : wall)[c]);
      ASSERT_EQ(colors.mixed[i][c], out.rgba[4 * pixels[i] + c]);
    }
  }
}

struct BorderError {
  double smooth, jagged;
};

// Against a picture `expected` of the style.
BorderError ErrorAtBorders(const Style& style, const GuideSet& guides, const Picture& expected) {
  const Picture smooth = MustTransfer(style, guides).picture;
  const Picture jagged = MustTransfer(style, WithoutFragments(guides)).picture;
  return {MeanFlipAtBorders(expected, smooth, guides), MeanFlipAtBorders(expected, jagged, guides)};
}

// Lit Sphere paints a subsample by its normal alone, so the supersampled picture is four times as wide and high.
TEST(FragmentPaint, LitSphereIsTheLargePictureMadeSmall) {
  const GuideSet guides = GuidesAt(kPictureWidth, kPictureHeight, kAa);
  const GuideSet fine = GuidesAt(kPictureWidth * kAa, kPictureHeight * kAa, 1);
  Style style = PlainStyle(BrushedPicture(160, 0.0));
  style.transfer.method = Method::kLitSphere;
  style.transfer.blend_radius = 0;
  const Picture large = MustTransfer(style, fine).picture;
  const Picture expected = Supersampled(kPictureWidth, kPictureHeight, [&](int x, int y, int k) {
    return large.At(x * kAa + k % kAa, y * kAa + k / kAa);
  });
  const BorderError error = ErrorAtBorders(style, guides, expected);
  EXPECT_LT(error.smooth, 0.01);
  EXPECT_GT(error.jagged, 5 * error.smooth);
}

// Votes of every kind: the nearest pixel of a subsample's object has the paint that it would have, but for the strokes'
// course over one pixel, which is longest in the large chunks of kBruteForce.
TEST(FragmentPaint, BordersAreThoseOfTheSupersampledVotes) {
  const GuideSet guides = GuidesAt(kPictureWidth, kPictureHeight, kAa, {Layer::kPref});
  const GuideSet fine = GuidesAt(kPictureWidth * kAa, kPictureHeight * kAa, 1);
  for (const int kind : {0, 1, 2, 3, 4, 5, 6, 7}) {
    SCOPED_TRACE(kind);
    Style style = PlainStyle(BrushedPicture(160, 0.02));
    style.transfer.edge_aware = true;
    style.transfer.blend_radius = 1;
    if (kind == 1) style.transfer.blend_radius = 3;
    if (kind == 2) style.transfer.blend_radius = 5;
    if (kind == 3) style.transfer.hybrid = 4.0;
    if (kind == 4) style.transfer.method = Method::kBruteForce;
    if (kind == 5) style.transfer.coherent = true;
    if (kind == 6) style.transfer.match_step = 2;
    if (kind == 7) style.transfer.match_step = 4, style.transfer.hybrid = 4.0;
    const Picture jagged = MustTransfer(style, WithoutFragments(guides)).picture;
    const Picture expected = Supersampled(kPictureWidth, kPictureHeight, [&](int x, int y, int k) {
      const auto [u, v] = NearestOfObject(guides, fine, x, y, k);
      return jagged.At(u, v);
    });
    const BorderError error = ErrorAtBorders(style, guides, expected);
    EXPECT_LT(error.smooth, 0.011);
    EXPECT_GT(error.jagged, 4 * error.smooth);
  }
}

TEST(FragmentPaint, OtherPixelsAreTheSame) {
  const GuideSet guides = GuidesAt(kPictureWidth, kPictureHeight, kAa);
  const Style style = PlainStyle(NoisePicture(100));
  const Picture smooth = MustTransfer(style, guides).picture;
  const Picture jagged = MustTransfer(style, WithoutFragments(guides)).picture;
  std::vector<std::uint8_t> mixed(guides.pixel_count());
  for (const std::uint32_t pixel : guides.fragments->pixel) mixed[pixel] = 1;
  int changed = 0;
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    const bool same = std::equal(&smooth.rgba[4 * i], &smooth.rgba[4 * i] + 4, &jagged.rgba[4 * i]);
    EXPECT_TRUE(same || mixed[i]);
    changed += !same;
  }
  EXPECT_GT(changed, 100);
}

// Styles of all kinds side by side: threads, regions, bands and fields make one picture.
TEST(FragmentPaint, ThreadsRegionsAndBandsMakeOnePicture) {
  GuideSet guides = GuidesAt(kPictureWidth, kPictureHeight, kAa, {Layer::kAlbedo, Layer::kLuminance});
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) guides.Plane(Layer::kLuminance)[i] = UnitFloat(Hash(i));
  Style plain = PlainStyle(NoisePicture(100)), lit = plain, tinted = plain;
  plain.transfer.blend_radius = 0;
  lit.exemplars.push_back({"lit.png", BrushedPicture(100, 0.15), std::nullopt});
  lit.exemplars[0].luminance = 0.2, lit.exemplars[1].luminance = 0.8;
  lit.transfer.blend_radius = 2, lit.transfer.edge_aware = true;
  tinted.transfer.colorize = 0.7, tinted.transfer.blend_radius = 3;
  const PreparedStyle prepared[] = {MustPrepareStyle(plain), MustPrepareStyle(lit), MustPrepareStyle(tinted)};
  const std::vector<const PreparedStyle*> styles = {&prepared[0], &prepared[1], &prepared[2]};
  const StyleAssignment assignment{{{IdOfObject(guides, "near"), 1}, {IdOfObject(guides, "far"), 2}}, {}, 0};
  const StyleMap map = MapStyles(guides, assignment);
  TransferOptions options;
  options.threads = 1, options.keep_field = true;
  const Picture whole = MustPaint(styles, map, guides, options);
  for (const bool keep_field : {false, true}) {
    for (const int threads : {1, 3}) {
      options.keep_field = keep_field, options.threads = threads, options.region = std::nullopt;
      EXPECT_EQ(MustPaint(styles, map, guides, options).rgba, whole.rgba);
      for (const Region& region :
           {Region{10, 7, 90, 61}, Region{0, 30, kPictureWidth, 31}, Region{50, 0, 51, kPictureHeight}}) {
        options.region = region;
        const Picture part = MustPaint(styles, map, guides, options);
        for (int y = region.y0; y < region.y1; ++y) {
          for (int x = region.x0; x < region.x1; ++x) {
            ASSERT_TRUE(std::equal(part.At(x, y), part.At(x, y) + 4, whole.At(x, y))) << x << ", " << y;
          }
        }
      }
    }
  }
}

TEST(FragmentPaint, ObjectsThatAreLeftShowThePictureUnderneath) {
  const GuideSet guides = GuidesAt(kPictureWidth, kPictureHeight, kAa);
  const PreparedStyle red = MustPrepareStyle(PlainStyle(PlainColor({65535, 0, 0})));
  const StyleAssignment assignment{{{IdOfObject(guides, "near"), 0}}, {}, StyleMap::kPassThrough};
  const StyleMap map = MapStyles(guides, assignment);
  std::vector<float> share(guides.pixel_count());  // of the near ball
  for (std::size_t i = 0; i < share.size(); ++i) share[i] = map.style[i] == 0 ? 1.0f : 0.0f;
  for (std::size_t f = 0; f < guides.fragments->count(); ++f) {
    const float coverage = guides.fragments->values.Plane(Layer::kCoverage)[f];
    const std::uint32_t pixel = guides.fragments->pixel[f];
    if (map.fragment_style[f] == 0) share[pixel] += coverage;
    if (map.style[pixel] == 0) share[pixel] -= coverage;
  }
  const Picture alone = MustPaint({&red}, map, guides);
  for (std::size_t i = 0; i < share.size(); ++i) {
    EXPECT_NEAR(alone.rgba[4 * i + 3] / 65535.0, share[i], 1e-4);
    EXPECT_TRUE(share[i] <= 0.0f || alone.rgba[4 * i] == 65535);
  }
  const Picture under = PlainColor({0, 0, 65535});
  Picture over(kPictureWidth, kPictureHeight);
  for (std::size_t i = 0; i < over.rgba.size(); ++i) over.rgba[i] = under.rgba[i % 4];
  TransferOptions options;
  options.over = &over;
  const Picture laid = MustPaint({&red}, map, guides, options);
  for (std::size_t i = 0; i < share.size(); ++i) {
    EXPECT_NEAR(Srgb16ToLinear(laid.rgba[4 * i]), share[i], 1e-4);
    EXPECT_NEAR(Srgb16ToLinear(laid.rgba[4 * i + 2]), 1.0f - share[i], 1e-4);
  }
}

}  // namespace
}  // namespace scumble
