// Fragments beside everything else that paints a picture: shadow catchers, rendered objects, pictures underneath,
// painted edges and sequences.
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/support/fragment_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

using Color = std::array<std::uint16_t, 3>;
constexpr Color kDark = {3000, 2000, 9000}, kRed = {60000, 4000, 2000}, kBlue = {5000, 20000, 65535};

Picture Everywhere(const Color& color) {
  Picture picture(kPictureWidth, kPictureHeight);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) picture.rgba[i] = i % 4 == 3 ? 65535 : color[i % 4];
  return picture;
}

// The near ball is painted red, the far one is left as it is rendered, and the wall catches shadows in dark paint.
struct Still {
  GuideSet guides = GuidesAt(kPictureWidth, kPictureHeight, kAa, {Layer::kShadow});
  GuideSet fine = GuidesAt(kPictureWidth * kAa, kPictureHeight* kAa, 1);
  PreparedStyle shadow, red;
  StyleAssignment assignment;

  Still() {
    Style style = PlainStyle(PlainColor(kDark));
    style.transfer.shadow = ShadowMode::kPaint;
    shadow = MustPrepareStyle(style), red = MustPrepareStyle(PlainStyle(PlainColor(kRed)));
    assignment.of_object = {{IdOfObject(guides, "near"), 1},
                            {IdOfObject(guides, "far"), StyleMap::kPassThrough},
                            {IdOfObject(guides, "thing"), StyleMap::kShadowCatcher}};
  }

  void SetShadow(const std::function<float(int x, int y)>& strength) {
    for (int y = 0; y < kPictureHeight; ++y) {
      for (int x = 0; x < kPictureWidth; ++x) guides.Plane(Layer::kShadow)[guides.Index(x, y)] = strength(x, y);
    }
  }

  Picture Paint(const GuideSet& of, const Picture* over) const {
    TransferOptions options;
    options.over = over;
    return MustPaint({&shadow, &red}, MapStyles(of, assignment), of, options);
  }
};

TEST(FragmentUses, ShadowsRenderedAndPaintedObjectsMixByCoverage) {
  Still still;
  still.SetShadow([](int, int) { return 1.0f; });
  const StyleMap fine = MapStyles(still.fine, still.assignment);
  const Picture under = Everywhere(kBlue);
  const Picture alone = still.Paint(still.guides, nullptr), laid = still.Paint(still.guides, &under);
  int mixed = 0;
  for (int y = 0; y < kPictureHeight; ++y) {
    for (int x = 0; x < kPictureWidth; ++x) {
      float color[3] = {}, painted = 0.0f;
      std::array<int, 3> seen = {};
      for (int k = 0; k < kAa * kAa; ++k) {
        const std::uint16_t style = fine.style[still.fine.Index(x * kAa + k % kAa, y * kAa + k / kAa)];
        const bool is_red = style == 1, is_dark = style == StyleMap::kShadowCatcher;
        const Color& of = is_red ? kRed : is_dark ? kDark : kBlue;
        for (int c = 0; c < 3; ++c) color[c] += Srgb16ToLinear(of[std::size_t(c)]) / (kAa * kAa);
        painted += is_red || is_dark ? 1.0f / (kAa * kAa) : 0.0f;
        ++seen[is_red ? 0 : is_dark ? 1 : 2];
      }
      mixed += (seen[0] > 0) + (seen[1] > 0) + (seen[2] > 0) > 1;
      EXPECT_NEAR(alone.At(x, y)[3] / 65535.0f, painted, 1e-4) << x << ", " << y;
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(Srgb16ToLinear(laid.At(x, y)[c]), color[c], 1e-4) << x << ", " << y << ", " << c;
      }
    }
  }
  EXPECT_GT(mixed, 100);
}

TEST(FragmentUses, ShadowsOfAnyStrengthEndSmoothlyAtObjects) {
  Still still;
  still.SetShadow([](int x, int y) { return 0.5f + 0.4f * std::sin(0.11f * float(x)) * std::cos(0.07f * float(y)); });
  const Picture under = Everywhere({50000, 50000, 30000});
  const Picture jagged = still.Paint(WithoutFragments(still.guides), &under);
  const Picture smooth = still.Paint(still.guides, &under);
  const Picture expected = Supersampled(kPictureWidth, kPictureHeight, [&](int x, int y, int k) {
    const auto [u, v] = NearestOfObject(still.guides, still.fine, x, y, k);
    return jagged.At(u, v);
  });
  const double error = MeanFlipAtBorders(expected, smooth, still.guides);
  EXPECT_LT(error, 0.01);
  EXPECT_GT(MeanFlipAtBorders(expected, jagged, still.guides), 4 * error);
}

// A ball of dark paint on white paper, whose line goes on along outlines.
Style LineStyle() {
  Picture picture(100, 100);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const double r = std::hypot(x - 49.5, y - 49.5) / 50.0;
      const bool paint = r < 1.02 + 0.06 * (UnitFloat(Hash(x / 3, y / 3)) - 0.5);
      std::uint16_t* texel = picture.At(x, y);
      texel[0] = texel[1] = texel[2] = paint ? 0 : 65535, texel[3] = 65535;
    }
  }
  return PlainStyle(std::move(picture));
}

// The line lies over the mixed border, as opaque as over a border in steps.
TEST(FragmentUses, PaintedEdgesLieOverTheMixedBorder) {
  const GuideSet guides = GuidesAt(kPictureWidth, kPictureHeight, kAa);
  const PreparedStyle grey = MustPrepareStyle(PlainStyle(PlainColor({40000, 40000, 40000})));
  Style style = LineStyle();
  const PreparedStyle exact = MustPrepareStyle(style);
  style.transfer.edge = EdgeMode::kExemplar;
  const PreparedStyle lined = MustPrepareStyle(style);
  ASSERT_FALSE(lined.rims.empty());
  const StyleMap map = MapStyles(guides, {{{IdOfObject(guides, "near"), 1}}, {}, 0});
  StyleMap of_steps = map;
  of_steps.fragment_style.clear();
  const GuideSet steps = WithoutFragments(guides);
  const Picture smooth_exact = MustPaint({&grey, &exact}, map, guides);
  const Picture smooth_lined = MustPaint({&grey, &lined}, map, guides);
  const Picture steps_exact = MustPaint({&grey, &exact}, of_steps, steps);
  const Picture steps_lined = MustPaint({&grey, &lined}, of_steps, steps);
  std::vector<std::uint8_t> mixed(guides.pixel_count());
  for (const std::uint32_t pixel : guides.fragments->pixel) mixed[pixel] = 1;
  int compared = 0;
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    const auto tone = [&](const Picture& picture) { return double(Srgb16ToLinear(picture.rgba[4 * i])); };
    ASSERT_EQ(smooth_lined.rgba[4 * i + 3], 65535);
    if (!mixed[i]) {
      ASSERT_EQ(smooth_lined.rgba[4 * i], steps_lined.rgba[4 * i]) << i;
      continue;
    }
    if (map.style[i] != 0) continue;  // the ball is as dark as its line
    const double open = tone(steps_lined) / tone(steps_exact);
    EXPECT_NEAR(tone(smooth_lined), open * tone(smooth_exact), 2e-4) << i;
    compared += open < 0.95;
  }
  EXPECT_GT(compared, 30);
}

// Frames of a moving ball: what the frame before left in memory changes nothing, and each border is that of its frame.
TEST(FragmentUses, SequencesHaveSmoothBordersInEveryFrame) {
  Style style = PlainStyle(BrushedPicture(160, 0.02));
  style.transfer.coherent = true, style.transfer.edge_aware = true;
  const PreparedStyle prepared = MustPrepareStyle(style);
  TransferScratch kept;
  Picture kept_out;
  for (int frame = 0; frame < 3; ++frame) {
    Scene scene = TwoBalls();
    scene.instances[1].world_from_object = Moved(-0.5 + 0.13 * frame, 0.1, 0.4);
    const GuideSet guides = GuidesAt(kPictureWidth, kPictureHeight, kAa, {Layer::kPref}, scene);
    const GuideSet fine = GuidesAt(kPictureWidth * kAa, kPictureHeight * kAa, 1, {}, scene);
    TransferOptions options;
    options.frame = frame;
    ASSERT_TRUE(Transfer(prepared, guides, options, kept, kept_out).ok());
    const Picture smooth = MustTransfer(style, guides, options).picture;
    EXPECT_EQ(smooth.rgba, kept_out.rgba) << frame;
    const Picture jagged = MustTransfer(style, WithoutFragments(guides), options).picture;
    const Picture expected = Supersampled(kPictureWidth, kPictureHeight, [&](int x, int y, int k) {
      const auto [u, v] = NearestOfObject(guides, fine, x, y, k);
      return jagged.At(u, v);
    });
    EXPECT_LT(MeanFlipAtBorders(expected, smooth, guides), 0.01) << frame;
  }
}

}  // namespace
}  // namespace scumble
