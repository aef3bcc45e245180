// A frame's finish is given the strokes of its painted edges.
#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/frame/frame_painter.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

// Dark paint without paper, which ends past the sphere's rim.
Style Brush() {
  Picture picture(400, 400);
  for (int y = 0; y < 400; ++y) {
    for (int x = 0; x < 400; ++x) {
      std::uint16_t* const texel = picture.At(x, y);
      texel[0] = texel[1] = texel[2] = 6000;
      texel[3] = std::hypot(x + 0.5 - 200.0, y + 0.5 - 200.0) < 206.0 ? 65535 : 0;
    }
  }
  Style style = PlainStyle(picture);
  style.transfer.edge = EdgeMode::kExemplar;
  return style;
}

// A disc of the first style before background of the second, as StyleMap has it.
TEST(FrameStrokes, AFinishOfTheirStyleTakesThemAndOneOfTheOtherLeavesThem) {
  const GuideSet guides = MakeGuides(200, 180, [](int x, int y) {
    return std::hypot(x + 0.5 - 100.0, y + 0.5 - 90.0) < 60.0 ? glm::vec3(0, 0, 1) : glm::vec3(0.0f);
  });
  Expected<PreparedStyle> brush = PrepareStyle(Brush(), 180, {});
  ASSERT_TRUE(brush);
  const std::vector<PreparedStyle> styles(2, *brush);
  const StyleMap map = MapStyles(guides, {{{1u, std::uint16_t{0}}}, {}, 1});
  GradePass lift;
  lift.lift = 0.4;
  for (const std::uint16_t finished : {0, 1}) {
    FrameFinish finish;
    finish.steps.push_back({{"it", lift, FinishPass::Stage::kPaint, 1.0, {}, {}}, {}});
    for (const std::uint16_t style : map.style) finish.steps.front().only.push_back(style == finished);
    FrameSettings settings;
    settings.finish = &finish;
    TransferScratch scratch;
    Picture picture;
    ASSERT_TRUE(PaintFrame(styles, &map, guides, settings, {}, {}, scratch, picture));
    int outside = 0;
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      const std::uint16_t* const texel = picture.rgba.data() + 4 * i;
      if (texel[3] == 0) continue;
      outside += map.style[i] == 1;
      EXPECT_EQ(texel[0] > 20000, finished == 0) << i;
    }
    EXPECT_GT(outside, 600);
  }
}

}  // namespace
}  // namespace scumble
