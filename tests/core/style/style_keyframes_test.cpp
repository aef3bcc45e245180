// Keys of a style that change over time.
#include "core/style/style_keyframes.h"

#include <gtest/gtest.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/io/picture_file.h"
#include "core/style/style_file.h"
#include "pipeline/frame_range.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

class StyleKeyframes : public testing::Test {
 protected:
  void SetUp() override {
    Picture picture(8, 8);
    for (std::uint16_t& value : picture.rgba) value = 65535;
    ASSERT_TRUE(WritePicture(folder_ / "lit.png", picture));
  }

  // A style with these lines under [transfer].
  Expected<Style> Load(const std::string& lines, const std::vector<std::string>& overrides = {}) {
    std::ofstream(folder_ / "style.toml", std::ios::binary)
        << "[transfer]\n" + lines + "\n[[exemplar]]\nimage = \"lit.png\"\n";
    const auto sets = ParseStyleOverrides(overrides);
    return sets ? LoadStyle(folder_.path(), *sets) : sets.error();
  }
  Style Loaded(const std::string& lines, const std::vector<std::string>& overrides = {}) {
    Expected<Style> style = Load(lines, overrides);
    EXPECT_TRUE(style) << (style ? "" : style.error().message);
    return style ? *style : Style();
  }
  static TransferSettings At(Style& style, std::int64_t frame) {
    const auto changed = SetStyleFrame(style, frame);
    EXPECT_TRUE(changed) << (changed ? "" : changed.error().message);
    return style.transfer;
  }
  void ExpectRefusal(const std::string& lines, const std::vector<std::string>& words) {
    SCOPED_TRACE(lines);
    scumble::ExpectRefusal(Load(lines), words);
  }

  TemporaryFolder folder_;
};

TEST_F(StyleKeyframes, NumbersMoveOnAStraightLineAndStandStillOutside) {
  Style style = Loaded("threshold = [[1, 0.1], [5, 0.3], [9, 0.2]]");
  EXPECT_EQ(style.transfer.threshold, 0.1f) << "as loaded, it is frame 0";
  const std::vector<std::pair<int, float>> expected = {{-100, 0.1f}, {1, 0.1f},  {2, 0.15f}, {3, 0.2f},
                                                       {5, 0.3f},    {7, 0.25f}, {9, 0.2f},  {1000, 0.2f}};
  for (const auto& [frame, value] : expected) EXPECT_FLOAT_EQ(At(style, frame).threshold, value) << frame;
}

TEST_F(StyleKeyframes, WholeNumbersWrittenForAFractionMoveToo) {
  Style style = Loaded("scale = [[0, 1], [10, 2]]\nrim = [[0, 2], [4, 4]]");
  EXPECT_EQ(At(style, 5).scale, 1.5);
  EXPECT_EQ(At(style, 1).rim, 2.5);
}

TEST_F(StyleKeyframes, WholeNumbersFlagsAndWordsHoldUntilTheNext) {
  Style style = Loaded(
      "levels = [[1, 2], [5, 6]]\nedge_aware = [[1, false], [5, true]]\nmethod = [[1, \"litsphere\"], [5, "
      "\"styleblit\"]]\njitter_fps = [[1, 12], [5, 24]]\npaper = [[1, \"#000000\"], [5, \"\"]]");
  for (const int frame : {-3, 0, 1, 4}) {
    const TransferSettings settings = At(style, frame);
    EXPECT_EQ(settings.levels, 2) << frame;
    EXPECT_FALSE(settings.edge_aware) << frame;
    EXPECT_EQ(settings.method, Method::kLitSphere) << frame;
    EXPECT_EQ(settings.jitter_fps, 12.0) << frame;
    EXPECT_TRUE(style.paper.color) << frame;
  }
  for (const int frame : {5, 6, 400}) {
    const TransferSettings settings = At(style, frame);
    EXPECT_EQ(settings.levels, 6) << frame;
    EXPECT_TRUE(settings.edge_aware) << frame;
    EXPECT_EQ(settings.method, Method::kStyleBlit) << frame;
    EXPECT_EQ(settings.jitter_fps, 24.0) << frame;
    EXPECT_FALSE(style.paper.color) << frame;
  }
}

TEST_F(StyleKeyframes, InfinityHoldsToo) {
  Style style = Loaded("threshold = [[1, 0.5], [3, inf], [5, 0.5]]");
  EXPECT_EQ(At(style, 2).threshold, 0.5f);
  EXPECT_EQ(At(style, 3).threshold, std::numeric_limits<float>::infinity());
  EXPECT_EQ(At(style, 4).threshold, std::numeric_limits<float>::infinity());
  EXPECT_EQ(At(style, 5).threshold, 0.5f);
}

TEST_F(StyleKeyframes, FramesDoNotDependOnTheOrderTheyAreAskedFor) {
  Style forth = Loaded("threshold = [[0, 0.1], [7, 0.9]]\nvariety = [[2, 0], [20, 30]]"), back = forth;
  std::vector<TransferSettings> settings;
  for (int frame = 0; frame < 25; ++frame) settings.push_back(At(forth, frame));
  for (int frame = 24; frame >= 0; --frame) {
    const TransferSettings again = At(back, frame);
    EXPECT_EQ(again.threshold, settings[frame].threshold) << frame;
    EXPECT_EQ(again.variety, settings[frame].variety) << frame;
  }
}

TEST_F(StyleKeyframes, OnlyWhatChangesIsNamed) {
  Style style = Loaded("threshold = [[1, 0.1], [5, 0.3]]\nlevels = [[1, 2], [4, 6]]");
  using Keys = std::vector<std::string>;
  EXPECT_EQ(*SetStyleFrame(style, 1), Keys());
  EXPECT_EQ(*SetStyleFrame(style, 2), Keys({"transfer.threshold"}));
  EXPECT_EQ(*SetStyleFrame(style, 2), Keys());
  EXPECT_EQ(*SetStyleFrame(style, 4), Keys({"transfer.levels", "transfer.threshold"}))
      << "in the order of the alphabet";
  EXPECT_EQ(*SetStyleFrame(style, 100), Keys({"transfer.threshold"}));
}

TEST_F(StyleKeyframes, OverridesReplaceTracksAndMayBeTracks) {
  const std::string keyed = "threshold = [[1, 0.1], [5, 0.3]]";
  Style plain = Loaded(keyed, {"transfer.threshold=0.7"});
  EXPECT_EQ(At(plain, 3).threshold, 0.7f);
  Style other = Loaded(keyed, {"transfer.threshold=[[1, 0.5], [3, 0.6]]"});
  EXPECT_EQ(At(other, 3).threshold, 0.6f);
  Style added = Loaded("", {"transfer.levels=[[1, 3], [4, 5]]"});
  EXPECT_EQ(At(added, 3).levels, 3);
  EXPECT_EQ(At(added, 4).levels, 5);
  const auto refused = Load("", {"transfer.levels=[[1, 3.5]]"});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUsage) << "on the command line it is the caller's mistake";
}

TEST_F(StyleKeyframes, LayersOfAllFrames) {
  const Style style = Loaded("colorize = [[10, 0], [20, 1], [30, 0]]");
  EXPECT_FALSE(RequiredLayers(style).Has(Layer::kAlbedo));
  const auto layers = LayersOverTime(style);
  ASSERT_TRUE(layers);
  EXPECT_TRUE(layers->Has(Layer::kAlbedo));
  EXPECT_EQ(*LayersOverTime(Loaded("threshold = 0.2")), RequiredLayers(Loaded("threshold = 0.2")));
}

// They are asked for in every frame, and no picture changes them: one that is gone by then is not missed.
TEST_F(StyleKeyframes, LayersOfAllFramesAreKnownWithoutReadingPaper) {
  ASSERT_TRUE(WritePicture(folder_ / "night.png", Picture(4, 4)));
  Style style = Loaded("paper = [[1, \"#ffffff\"], [48, \"night.png\"]]\ncolorize = [[10, 0], [20, 1]]");
  std::filesystem::remove(folder_ / "night.png");
  const auto layers = LayersOverTime(style);
  ASSERT_TRUE(layers) << layers.error().message;
  EXPECT_TRUE(layers->Has(Layer::kAlbedo));
  EXPECT_FALSE(SetStyleFrame(style, 48)) << "the frame that shows it reads it";
}

// As many frames as a style.toml of 1 MB names. To look at half the track for each of them and for the one behind comes
// to 10¹⁰ keys of 48 bytes, seconds at any speed of memory; halving it, to 200,000 times 17, a thousandth of that.
TEST_F(StyleKeyframes, TracksOfManyFramesAreSearchedByHalves) {
  Style style = Loaded("");
  StyleTrack track;
  for (std::int64_t frame = 0; frame < 100'000; ++frame) track.keys.push_back({frame, KeyValue(double(frame % 2))});
  const std::clock_t start = std::clock();
  ASSERT_TRUE(AddTrack(style, *FindStyleKey("transfer.colorize"), std::move(track)));
  const auto layers = LayersOverTime(style);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  ASSERT_TRUE(layers) << layers.error().message;
  EXPECT_TRUE(layers->Has(Layer::kAlbedo));
  EXPECT_EQ(At(style, 99'999).colorize, 1.0);
  EXPECT_EQ(At(style, 50'000).colorize, 0.0);
  EXPECT_LT(seconds, 3.0 * SCUMBLE_TESTS_SLOWER);
}

// Numbers of frames are those of pictures, and halfway from the first to the last of all is frame 0.
TEST_F(StyleKeyframes, FramesGoAsFarAsThoseOfPictures) {
  static_assert(kMaxTrackFrame == kMaxFrame);
  Style style = Loaded("threshold = [[-999999999, 0.25], [999999999, 0.75]]");
  EXPECT_EQ(style.transfer.threshold, 0.5f);
  EXPECT_EQ(At(style, std::numeric_limits<std::int64_t>::min()).threshold, 0.25f);
  EXPECT_EQ(At(style, std::numeric_limits<std::int64_t>::max()).threshold, 0.75f);
  EXPECT_TRUE(LayersOverTime(style));
  for (const char* frame : {"-9223372036854775807", "-1000000000", "1000000000", "9223372036854775807"}) {
    ExpectRefusal("threshold = [[" + std::string(frame) + ", 0.1]]",
                  {"style.toml:2", "transfer.threshold", "no frame " + std::string(frame), "-999999999 to 999999999"});
  }
}

TEST_F(StyleKeyframes, WhatIsWrongIsSaid) {
  ExpectRefusal("threshold = []", {"style.toml:2", "threshold", "pairs of frame and value"});
  ExpectRefusal("threshold = [1, 0.1]", {"[[1, 0.1], [24, 0.3]]"});
  ExpectRefusal("threshold = [[1, 0.1, 2]]", {"[[1, 0.1], [24, 0.3]]"});
  ExpectRefusal("threshold = [[1]]", {"[[1, 0.1], [24, 0.3]]"});
  ExpectRefusal("threshold = [[1.5, 0.1]]", {"[[1, 0.1], [24, 0.3]]"});
  ExpectRefusal("threshold = [[1, [2, 3]]]", {"[[1, 0.1], [24, 0.3]]"});
  ExpectRefusal("threshold = [[5, 0.1], [1, 0.2]]", {"frame 1 comes after frame 5", "rising"});
  ExpectRefusal("threshold = [[5, 0.1], [5, 0.2]]", {"rising"});
  ExpectRefusal("threshold = [[1, 0.1], [5, -1]]", {"at frame 5", "-1", "0 or more"});
  ExpectRefusal("threshold = [[1, 0.1], [5, \"big\"]]", {"at frame 5", "expected a number"});
  ExpectRefusal("levels = [[1, 2], [5, 2.5]]", {"at frame 5", "whole number"});
  ExpectRefusal("paper = [[1, \"lost.png\"]]", {"at frame 1", "lost.png"});
  std::ofstream(folder_ / "style.toml") << "name = [[1, \"a\"]]\n[[exemplar]]\nimage = \"lit.png\"\n";
  const auto named = LoadStyle(folder_.path());
  ASSERT_FALSE(named);
  EXPECT_NE(named.error().message.find("name cannot change over time"), std::string::npos) << named.error().message;
}

}  // namespace
}  // namespace scumble
