// Frame ranges and names of frames.
#include "pipeline/frame_range.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace scumble {
namespace {

std::vector<int> Frames(const std::string& text) {
  const auto frames = ParseFrames(text);
  EXPECT_TRUE(frames) << frames.error().message;
  return frames ? *frames : std::vector<int>();
}

std::string Named(const std::string& name, int frame) {
  const auto parsed = FrameName::Parse(name);
  EXPECT_TRUE(parsed) << name;
  return parsed ? parsed->At(frame) : "";
}

TEST(Frames, RangesAsAnimationProgramsWriteThem) {
  using List = std::vector<int>;
  EXPECT_EQ(Frames("7"), List({7}));
  EXPECT_EQ(Frames("1-4"), List({1, 2, 3, 4}));
  EXPECT_EQ(Frames("3,5-7"), List({3, 5, 6, 7}));
  EXPECT_EQ(Frames("12-19x3"), List({12, 15, 18}));
  EXPECT_EQ(Frames("12-18X3"), List({12, 15, 18}));
  EXPECT_EQ(Frames("4-1"), List({4, 3, 2, 1}));
  EXPECT_EQ(Frames("4-1x-1"), List({4, 3, 2, 1}));
  EXPECT_EQ(Frames("5-1x2"), List({5, 3, 1}));
  EXPECT_EQ(Frames("6-1x-2"), List({6, 4, 2}));
  EXPECT_EQ(Frames("-2-1"), List({-2, -1, 0, 1}));
  EXPECT_EQ(Frames("-3--1"), List({-3, -2, -1}));
  EXPECT_EQ(Frames("-1--5x-2"), List({-1, -3, -5}));
  EXPECT_EQ(Frames("5-5"), List({5}));
  EXPECT_EQ(Frames("5-5x-3"), List({5}));
  EXPECT_EQ(Frames(" 1 , 3 "), List({1, 3}));
  EXPECT_EQ(Frames("0008"), List({8}));
  // The longest step there is leads from the first frame that there may be to the last, and back.
  EXPECT_EQ(Frames("-999999999-999999999x1999999998"), List({-999999999, 999999999}));
  EXPECT_EQ(Frames("999999999--999999999x-1999999998"), List({999999999, -999999999}));
  EXPECT_EQ(Frames(FramesToText(List({-999999999, 999999999, 7}))), List({-999999999, 999999999, 7}));
}

TEST(Frames, AFrameThatComesAgainCountsOnce) {
  EXPECT_EQ(Frames("5,1-6x2,5,1"), std::vector<int>({5, 1, 3}));
  EXPECT_EQ(Frames("1-3,3-1"), std::vector<int>({1, 2, 3}));
}

TEST(Frames, WhatIsWrongIsSaid) {
  const std::map<std::string, std::string> wrong = {{"", "1-24"},
                                                    {"x", "1-24"},
                                                    {"1-", "12-24x2"},
                                                    {"1-2-3", "12-24x2"},
                                                    {"1--", "12-24x2"},
                                                    {"1-4x", "12-24x2"},
                                                    {"1-4x2z", "12-24x2"},
                                                    {"1.5", "12-24x2"},
                                                    {"7x2", "12-24x2"},
                                                    {"1,,3", "nothing between"},
                                                    {"1,", "after the last"},
                                                    {",1", "nothing between"},
                                                    {"1..24", "one dash"},
                                                    {"1-9y2", "1-24x2"},
                                                    {"1-9:2", "1-24x2"},
                                                    {"1-9x0", "step of 0"},
                                                    {"1-9x-1", "counts down"},
                                                    {"1-24x9223372036854775807", "at most 1999999998, as 1-24x2"},
                                                    {"-5--7x-9223372036854775808", "at most 1999999998"},
                                                    {"-5--7x-9223372036854775807", "at most 1999999998"},
                                                    {"1-24x1999999999", "at most 1999999998"},
                                                    {"-9223372036854775808", "-999999999 to 999999999"},
                                                    {"1-1000000000", "999999999"},
                                                    {"99999999999999999999", "1-24"},
                                                    {"1-2000000", "more than 1000000 frames"},
                                                    {"1-600000,1-600000", "more than 1000000 frames"},
                                                    {"999999999--999999999", "more than 1000000 frames"}};
  for (const auto& [text, words] : wrong) {
    const auto frames = ParseFrames(text);
    ASSERT_FALSE(frames) << text;
    EXPECT_EQ(frames.error().kind, ErrorKind::kUsage) << text;
    EXPECT_NE(frames.error().message.find("--frames " + text), std::string::npos) << frames.error().message;
    EXPECT_NE(frames.error().message.find(words), std::string::npos) << frames.error().message;
  }
  EXPECT_NE(ParseFrames("1,2,abc").error().message.find("at 'abc'"), std::string::npos);
}

TEST(Frames, ShortTextReadsBack) {
  const std::map<std::string, std::string> shorter = {
      {"1,2,3,4", "1-4"},         {"1,2", "1-2"},        {"1,3", "1,3"}, {"1,3,5", "1-5x2"},   {"5,3,1", "5-1x-2"},
      {"3,2,1", "3-1"},           {"-3,-2,-1", "-3--1"}, {"7", "7"},     {"1,2,3,9", "1-3,9"}, {"9,1-3", "9,1-3"},
      {"1,2,4,6,8", "1-2,4-8x2"}, {"-1,4", "-1,4"}};
  for (const auto& [text, expected] : shorter) {
    EXPECT_EQ(FramesToText(Frames(text)), expected);
    EXPECT_EQ(Frames(FramesToText(Frames(text))), Frames(text)) << text;
  }
  EXPECT_EQ(FramesToText({}), "");
}

TEST(FrameNames, HashesAndPrintf) {
  EXPECT_EQ(Named("p.####.png", 7), "p.0007.png");
  EXPECT_EQ(Named("p.#.png", 12), "p.12.png");
  EXPECT_EQ(Named("p.##.png", 1234), "p.1234.png");
  EXPECT_EQ(Named("####.png", 7), "0007.png");
  EXPECT_EQ(Named("out/a#b/p####", 7), "out/a#b/p0007");
  EXPECT_EQ(Named("take#2.###.png", 7), "take#2.007.png") << "the last run, as in Blender";
  EXPECT_EQ(Named("p.%04d.png", 7), "p.0007.png");
  EXPECT_EQ(Named("p.%d.png", 7), "p.7.png");
  EXPECT_EQ(Named("p.%02d.png", 123), "p.123.png");
  EXPECT_EQ(Named("50%.png", 7), "50%.png");
  EXPECT_EQ(Named("50%off/p.%d.png", 7), "50%off/p.7.png");
  EXPECT_EQ(Named("p.%4x.png", 7), "p.%4x.png");
  EXPECT_EQ(Named("####/p.png", 7), "####/p.png");
}

TEST(FrameNames, NegativeFrames) {
  EXPECT_EQ(Named("p.####.png", -5), "p.-0005.png");
  EXPECT_EQ(Named("p.%04d.png", -5), "p.-005.png");
  EXPECT_EQ(Named("p.%d.png", -5), "p.-5.png");
}

TEST(FrameNames, WhetherThereIsAPlace) {
  const auto name = [](const std::string& text) { return *FrameName::Parse(text); };
  EXPECT_FALSE(name("p.png").has_place());
  EXPECT_FALSE(name("####/p.png").has_place());
  EXPECT_TRUE(name("take#2.png").has_place());
  EXPECT_FALSE(name("take#2.png").must_have_frame());
  EXPECT_TRUE(name("p.##.png").must_have_frame());
  EXPECT_TRUE(name("p.%d.png").must_have_frame());
  for (const char* two : {"%d.%d.png", "####.%04d.png", "%04d.####.png"}) {
    const auto parsed = FrameName::Parse(two);
    ASSERT_FALSE(parsed) << two;
    EXPECT_EQ(parsed.error().kind, ErrorKind::kUsage);
    EXPECT_NE(parsed.error().message.find("two places"), std::string::npos);
  }
}

}  // namespace
}  // namespace scumble
