// `--isa` reproduces the same bytes, and ranges whose guides were cast by several sets or by several versions of Embree
// are warned of.
#include <filesystem>
#include <regex>
#include <string>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

class CliIsa : public CliTest {
 protected:
  GuideSet Taken(const std::string& name) const {
    Expected<GuideSet> guides = ReadGuides(At(name), {});
    EXPECT_TRUE(guides) << guides.error().message;
    return guides ? *std::move(guides) : GuideSet(1, 1);
  }
};

// Every machine has SSE2. A file does not depend on threads, and one instruction set gives equal results for any order
// of work: so all bytes are equal, header, subsamples and bounced light included.
TEST_F(CliIsa, OneSetWritesTheSameFileForAnyThreads) {
  const Arguments guidegen = {"guidegen",  Scene("stilllife.glb"),
                              "--isa",     "sse2",
                              "--size",    "96x54",
                              "--aa",      "2",
                              "--samples", "2",
                              "--layers",  "position,luminance,shadow,lpe.full"};
  RunOk(With(guidegen, {"--threads", "1", "-o", "one.exr"}));
  const Expected<GuideSet> guides = ReadGuides(At("one.exr"), {});
  ASSERT_TRUE(guides) << guides.error().message;
  EXPECT_EQ(guides->attributes.at("scumble:isa"), "sse2");
  EXPECT_TRUE(std::regex_match(guides->attributes.at("scumble:embree"), std::regex("[34][.][0-9]+[.][0-9]+")));
  for (const char* threads : {"2", "3", "7"}) {
    RunOk(With(guidegen, {"--threads", threads, "-o", "more.exr"}));
    EXPECT_TRUE(Bytes("one.exr") == Bytes("more.exr")) << threads << " threads";
  }
}

// As on a farm of different machines. The frame that differs is named, with both casters, and once.
TEST_F(CliIsa, RangesOfSeveralCastersAreWarnedOf) {
  WriteStyle("style");
  for (const char* file : {"g.0001.exr", "g.0002.exr", "g.0003.exr"}) {
    RunOk({"guidegen", Scene("stilllife.glb"), "--size", "48x27", "--isa", "sse2", "-o", file});
  }
  const Arguments transfer = {"transfer", "g.####.exr", "--style", "style", "--frames", "1-3", "-o", "p.####.png"};
  EXPECT_EQ(RunOk(transfer).Warning(), "");

  GuideSet guides = Taken("g.0002.exr");
  const std::string version = guides.attributes.at("scumble:embree");
  guides.attributes["scumble:embree"] = "2.17.7";
  for (const char* file : {"g.0002.exr", "g.0003.exr"}) WriteGuideFile(file, guides);
  const std::string other = "frame 2: its guides were cast by Embree 2.17.7 on sse2, those of frame 1 by Embree " +
                            version + " on sse2; the last bits of guides may differ: ";
  CommandResult mixed = RunOk(transfer);
  EXPECT_TRUE(mixed.Warning().starts_with(other)) << mixed.err;
  EXPECT_EQ(mixed.err.find("guides were cast", mixed.err.find(other) + other.size()), std::string::npos) << mixed.err;

  // Without its version, a file counts by its instruction set alone: as sse2 it does not differ.
  guides.attributes.erase("scumble:embree");
  for (const char* file : {"g.0002.exr", "g.0003.exr"}) WriteGuideFile(file, guides);
  EXPECT_EQ(RunOk(transfer).Warning(), "");
  guides.attributes["scumble:isa"] = "avx2";
  WriteGuideFile("g.0002.exr", guides);
  mixed = RunOk(transfer);
  EXPECT_TRUE(mixed.Warning().starts_with("frame 2: its guides were cast by avx2, those of frame 1 by sse2;"))
      << mixed.err;
}

TEST_F(CliIsa, AResumedRangeIsWarnedOfOtherCasters) {
  const Arguments guidegen = {
      "guidegen",  Scene("stilllife.glb"), "--size", "48x27", "--isa", "sse2", "--frames", "1-2", "--resume", "-o",
      "g.####.exr"};
  RunOk(guidegen);
  GuideSet guides = Taken("g.0001.exr");
  guides.attributes["scumble:embree"] = "2.17.7";
  WriteGuideFile("g.0001.exr", guides);
  std::filesystem::remove(At("g.0002.exr"));
  const CommandResult mixed = RunOk(guidegen);
  EXPECT_TRUE(mixed.Warning().starts_with("frame 2: its guides were cast by Embree ")) << mixed.err;
  EXPECT_NE(mixed.Warning().find("those of frame 1 by Embree 2.17.7 on sse2"), std::string::npos) << mixed.err;
}

}  // namespace
}  // namespace scumble
