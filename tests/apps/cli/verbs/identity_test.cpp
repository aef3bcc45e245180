// Every bundled style gives the same bytes in one step or two, on any number of threads, and for any cut of a range of
// frames. The styles are those in exemplars/, so that a new one is tested automatically.
#include <filesystem>
#include <string>
#include <vector>

#include "core/filter/resample.h"
#include "core/io/guide_file.h"
#include "core/style/style_file.h"
#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 6;
constexpr int kPaint = 128;  // pixels along an exemplar's side

class CliIdentity : public CliTest {
 protected:
  static std::vector<fs::path> Styles() {
    const auto styles = FindStyles(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars");
    EXPECT_GE(styles.size(), 4u);
    return styles;
  }

  std::vector<std::string> AllBytes(const std::string& start) const {
    std::vector<std::string> all;
    for (int frame = 1; frame <= kFrames; ++frame) {
      all.push_back(Bytes(start + "." + std::to_string(frame) + ".png"));
      EXPECT_NE(all.back(), "") << start << ", frame " << frame;
    }
    return all;
  }
  // Long lists of bytes say nothing when they differ.
  static void ExpectSame(const std::vector<std::string>& frames, const std::vector<std::string>& expected,
                         const std::string& what) {
    ASSERT_EQ(frames.size(), expected.size());
    for (std::size_t i = 0; i < frames.size(); ++i)
      EXPECT_TRUE(frames[i] == expected[i]) << what << ", frame " << i + 1;
  }

  // Coverage and normals of every so many pixels.
  static GuideSet Smaller(const GuideSet& guides) {
    GuideSet small(kPaint, kPaint);
    small.Add(Layer::kCoverage);
    small.Add(Layer::kNormal);
    for (int y = 0; y < kPaint; ++y) {
      for (int x = 0; x < kPaint; ++x) {
        const std::size_t from = guides.Index(x * guides.width() / kPaint, y * guides.height() / kPaint);
        for (const Layer layer : {Layer::kCoverage, Layer::kNormal}) {
          for (int c = 0; c < ChannelCount(layer); ++c) {
            small.Plane(layer, c)[small.Index(x, y)] = guides.Plane(layer, c)[from];
          }
        }
      }
    }
    return small;
  }

  // The bundled style's paint with everything turned on that styles can have: two lights, a base colour,
  // a painted edge, shadows, variety; and with keys that change from frame to frame. The paint is made smaller, so that
  // preparing it anew for each frame takes no time.
  void WriteMovingStyle(const std::string& folder, const fs::path& bundled) {
    const auto style = LoadStyle(bundled);
    ASSERT_TRUE(style.ok()) << style.error().message;
    std::string text =
        "[transfer]\nreference_height = 0\nlevels = 5\nblend_radius = 2\njitter_fps = 12\nvariety = 8\n"
        "threshold = [[1, 0.05], [6, 0.4]]\ncolorize = [[2, 0.0], [5, 1.0]]\ncolorize_mode = \"oklab\"\n"
        "shadow = \"paint\"\nluminance_weight = [[1, 0.3], [4, 0.0]]\n";
    if (style->exemplars.front().is_sphere) text += "edge = \"exemplar\"\n";
    fs::create_directories(At(folder));
    const std::size_t lights = std::max<std::size_t>(2, style->exemplars.size());
    for (std::size_t i = 0; i < lights; ++i) {
      const Exemplar& exemplar = style->exemplars[std::min(i, style->exemplars.size() - 1)];
      const std::string name = "light" + std::to_string(i) + ".png";
      ASSERT_TRUE(WritePicture(At(folder + "/" + name), Resample(exemplar.picture, kPaint, kPaint)));
      text += "[[exemplar]]\nimage = \"" + name + "\"\nluminance = " + std::to_string(0.7 / double(1 + 3 * i)) + "\n";
      if (exemplar.is_sphere) continue;
      ASSERT_TRUE(WriteGuides(At(folder + "/guides.exr"), Smaller(*exemplar.guides)));
      text += "guides = \"guides.exr\"\n";
    }
    WriteText(folder + "/style.toml", text);
  }
};

// As the style's author wants it, and in plain pixels, where even the small pictures of a test have all levels and a
// vote. Styles take turns with the two.
TEST_F(CliIdentity, OneStepOrTwoOnAnyThreads) {
  const Arguments scene = {Scene("stilllife.glb"), "--view", "35,25", "--size", "96x54", "--aa", "4"};
  const std::vector<Arguments> variants = {
      {}, {"--set", "transfer.reference_height=0", "--set", "transfer.scale=0.1", "--set", "transfer.colorize=0.7"}};
  std::size_t turn = 0;
  for (const fs::path& folder : Styles()) {
    const Arguments& variant = variants[turn++ % variants.size()];
    const Arguments style = With({"--style", folder.string()}, variant);
    RunOk(With(With({"guidegen"}, scene), With(style, {"--threads", "1", "-o", "guides.exr"})));
    RunOk(With(With({"stylize"}, scene), With(style, {"--threads", "4", "-o", "once.png"})));
    RunOk(With({"transfer", "guides.exr"}, With(style, {"--threads", "3", "-o", "twice.png"})));
    EXPECT_NE(Bytes("once.png"), "");
    EXPECT_TRUE(Bytes("once.png") == Bytes("twice.png"))
        << folder.filename() << ", " << variant.size() << " more arguments";
  }
}

// Styles take turns with the ways to cut.
TEST_F(CliIdentity, HoweverARangeIsCut) {
  const Arguments scene = {Scene("stilllife.glb"), "--view", "35,25", "--size", "80x60", "--aa", "4"};
  std::size_t turn = 0;
  for (const fs::path& folder : Styles()) {
    SCOPED_TRACE(folder.filename().string());
    WriteMovingStyle("style", folder);
    const Arguments style = {"--style", "style", "--assign", "Floor=catcher", "--exposure", "0.5", "-q"};
    const Arguments stylize = With(With({"stylize"}, scene), style);
    RunOk(With(stylize, {"--frames", "1-6", "--threads", "1", "-o", "once.#.png"}));
    const auto once = AllBytes("once");
    for (std::size_t i = 1; i < once.size(); ++i)
      EXPECT_FALSE(once[i] == once[i - 1]) << "frame " << i + 1 << " stands still";

    switch (turn++ % 3) {
      case 0:
        RunOk(With(stylize, {"--frames", "1-2", "--threads", "4", "-o", "cut.#.png"}));
        RunOk(With(stylize, {"--frames", "3-6", "--threads", "3", "-o", "cut.#.png"}));
        ExpectSame(AllBytes("cut"), once, "1-2 and 3-6");
        break;
      case 1:
        RunOk(With(stylize, {"--frames", "6-1", "-o", "back.#.png"}));
        ExpectSame(AllBytes("back"), once, "6-1");
        break;
      default:
        RunOk(With(With({"guidegen"}, scene), {"--style", "style", "-q", "--threads", "4", "-o", "guides.exr"}));
        RunOk(With(With({"transfer", "guides.exr"}, style), {"--frames", "1-6", "-o", "two.#.png"}));
        ExpectSame(AllBytes("two"), once, "through files");
        RunOk(With(With({"transfer", "guides.exr"}, style), {"--frame", "4", "--threads", "1", "-o", "four.png"}));
        EXPECT_TRUE(Bytes("four.png") == once[3]) << "a frame by itself";
    }
  }
}

// Bounced light needs chance: so many paths in one step as in two, and another number is another picture.
TEST_F(CliIdentity, SamplesAndBouncesOfLightInOneStepOrTwo) {
  const Arguments view = {Scene("snail.glb"), "--style", "scene-oil", "--set", "transfer.guide_weights.lpe.LDDE=1",
                          "--size",           "96x54"};
  for (const Arguments& light : {Arguments{"--samples", "2"}, {"--samples", "3", "--max-bounces", "1"}}) {
    RunOk(With(With(With({"guidegen"}, view), light), {"-o", "g.exr"}));
    RunOk({"transfer", "g.exr", "--style", "scene-oil", "--set", "transfer.guide_weights.lpe.LDDE=1", "-o",
           "two" + light[1] + ".png"});
    RunOk(With(With(With({"stylize"}, view), light), {"-o", "one" + light[1] + ".png"}));
    EXPECT_TRUE(Bytes("one" + light[1] + ".png") == Bytes("two" + light[1] + ".png")) << Joined(light);
  }
  EXPECT_FALSE(Bytes("one2.png") == Bytes("one3.png"));
}

}  // namespace
}  // namespace scumble
