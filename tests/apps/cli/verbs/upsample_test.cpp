// --upsample: pictures larger than their guides.
#include "core/filter/resample.h"
#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

class Upsample : public CliTest {};

TEST_F(Upsample, StylizeIsTheTwoStepsThroughFiles) {
  WriteStyle("style");
  const std::string scene = Scene("suzanne.glb");
  RunOk({"stylize", scene, "--style", "style", "--size", "120x80", "--aa", "4", "--upsample", "2", "-o", "one.png"});
  RunOk({"guidegen", scene, "--size", "60x40", "--aa", "4", "-o", "guides.exr"});
  const CommandResult made = RunOk(
      {"transfer", "guides.exr", "--style", "style", "--upsample", "2", "--threads", "1", "--json", "-o", "two.png"});
  EXPECT_EQ(Bytes("one.png"), Bytes("two.png"));
  EXPECT_EQ(made.Json()["width"], 120);
  EXPECT_EQ(made.Json()["height"], 80);
  EXPECT_EQ(made.Json()["upsample"], 2);
  RunOk({"stylize", scene, "--style", "style", "--size", "120x80", "--aa", "4", "-o", "full.png"});
  EXPECT_FALSE(Pixels("one.png") == Pixels("full.png"));
  RunOk({"stylize", scene, "--style", "style", "--size", "120x80", "--aa", "4", "--upsample", "1", "-o", "1.png"});
  EXPECT_EQ(Bytes("1.png"), Bytes("full.png"));
}

// Borders between objects are painted from the fragments of the smaller guides, in memory and from a file, whatever
// layers the style reads.
TEST_F(Upsample, BordersBetweenObjectsStaySmooth) {
  WriteStyle("style");
  const std::string scene = Scene("toys.glb");
  for (const Arguments& style :
       {Arguments{"--style", "style"}, Arguments{"--style", "style", "--set", "transfer.edge_aware=false"}}) {
    const auto painted = [&](const std::string& size, const std::string& aa, const std::string& factor) {
      Arguments stylize = With(style, {"--size", size, "--aa", aa, "--upsample", factor, "-o", "one.png"});
      stylize.insert(stylize.begin(), {"stylize", scene});
      RunOk(stylize);
      return Pixels("one.png");
    };
    RunOk({"guidegen", scene, "--size", "60x40", "--aa", "4", "-o", "guides.exr"});
    for (const auto& [factor, size] : {std::pair{"1", "60x40"}, {"2", "120x80"}}) {
      const auto one = painted(size, "4", factor);
      Arguments transfer = With(style, {"--upsample", factor, "-o", "two.png"});
      transfer.insert(transfer.begin(), {"transfer", "guides.exr"});
      RunOk(transfer);
      EXPECT_TRUE(one == Pixels("two.png")) << Joined(transfer);
    }
  }
}

// A step takes longer than matching all pixels, so none comes with --upsample unasked.
TEST_F(Upsample, EveryPixelOfTheLargerPictureIsMatched) {
  WriteStyle("style");
  WriteGuideFile("ball.exr", Ball(32));
  const Arguments transfer{"transfer", "ball.exr", "--style", "style", "--upsample", "4", "-o"};
  RunOk(With(transfer, {"plain.png"}));
  RunOk(With(transfer, {"one.png", "--set", "transfer.match_step=1"}));
  EXPECT_EQ(Bytes("one.png"), Bytes("plain.png"));
  RunOk(With(transfer, {"four.png", "--set", "transfer.match_step=4"}));
  EXPECT_FALSE(Pixels("four.png") == Pixels("plain.png"));
}

TEST_F(Upsample, ThePictureUnderneathHasThePicturesSize) {
  WriteStyle("style");
  WriteGuideFile("ball.exr", Ball(32));
  WritePainted("small.png", 32, 32), WritePainted("large.png", 96, 96);
  const Arguments transfer{"transfer", "ball.exr", "--style", "style", "--upsample", "3", "-o", "out.png"};
  RunOk(With(transfer, {"--over", "large.png"}));
  ExpectError(With(transfer, {"--over", "small.png"}), 3, {"small.png", "32×32", "ball.exr upsampled is 96×96"});
}

TEST_F(Upsample, SizesThatCannotBeAreRefused) {
  WriteStyle("style");
  const Arguments stylize{"stylize", Scene("suzanne.glb"), "--style", "style", "-o", "out.png"};
  ExpectError(With(stylize, {"--size", "121x80", "--upsample", "2"}), 2, {"--size 121x80", "--upsample 2", "122x80"});
  ExpectError(With(stylize, {"--size", "120x80", "--upsample", "0"}), 2, {"--upsample"});
  ExpectError(With(stylize, {"--size", "120x80", "--upsample", "9"}), 2, {"--upsample"});
  EXPECT_FALSE(Exists("out.png"));
}

TEST_F(Upsample, ASequenceIsResumedAtThePicturesSize) {
  WriteStyle("style");
  WriteGuideFile("g.0001.exr", Ball(32)), WriteGuideFile("g.0002.exr", Ball(32));
  const Arguments transfer{"transfer", "g.####.exr", "--style", "style", "--upsample",
                           "2",        "--frames",   "1-2",     "-o",    "p.####.png"};
  RunOk(transfer);
  const std::string first = Bytes("p.0001.png");
  std::filesystem::remove(At("p.0002.png"));
  const auto before = std::filesystem::last_write_time(At("p.0001.png"));
  RunOk(With(transfer, {"--resume"}));
  EXPECT_EQ(std::filesystem::last_write_time(At("p.0001.png")), before) << "a whole picture of the right size is kept";
  EXPECT_TRUE(Exists("p.0002.png"));
  // Made without --upsample it has another size, and is made anew.
  RunOk({"transfer", "g.0001.exr", "--style", "style", "-o", "p.0001.png"});
  RunOk(With(transfer, {"--resume"}));
  EXPECT_EQ(Bytes("p.0001.png"), first);
}

// Of stylize all pictures have the size of --size, whatever their guides had.
TEST_F(Upsample, StylizeKeepsFramesOfTheSameFactorAlone) {
  WriteStyle("style");
  const auto kept = [&](const std::string& factor) {
    return RunOk({"stylize", Scene("ball.glb"), "--style", "style", "--size", "32", "--frames", "1-2", "--upsample",
                  factor, "--json", "--resume", "-o", "p#.png"})
        .Json()["kept"];
  };
  EXPECT_EQ(kept("1"), 0);
  EXPECT_EQ(kept("1"), 2);
  EXPECT_EQ(kept("2"), 0);
  EXPECT_EQ(kept("2"), 2);
  EXPECT_EQ(kept("1"), 0);
}

TEST_F(Upsample, TheStylesStepAndHybridAreKeysLikeOthers) {
  WriteStyle("style");
  WriteGuideFile("ball.exr", Ball(48));
  const Arguments transfer{"transfer", "ball.exr", "--style", "style", "-o"};
  RunOk(With(transfer, {"plain.png"}));
  RunOk(With(transfer, {"neutral.png", "--set", "transfer.match_step=1", "--set", "transfer.hybrid=0"}));
  EXPECT_EQ(Bytes("neutral.png"), Bytes("plain.png"));
  RunOk(With(transfer, {"step.png", "--set", "transfer.match_step=4"}));
  EXPECT_FALSE(Pixels("step.png") == Pixels("plain.png"));
  RunOk(With(transfer, {"hybrid.png", "--set", "transfer.hybrid=4", "--set", "transfer.threshold=0.4"}));
  EXPECT_FALSE(Pixels("hybrid.png") == Pixels("plain.png"));
  // Frame 2 of a keyed style equals the picture with those values without keys.
  RunOk({"transfer", "ball.exr", "--style", "style", "--set", "transfer.match_step=[[1,1],[2,4]]", "--set",
         "transfer.hybrid=[[1,0],[3,8]]", "--frames", "1-3", "-o", "k.#.png"});
  RunOk(With(transfer, {"two.png", "--set", "transfer.match_step=4", "--set", "transfer.hybrid=4"}));
  EXPECT_EQ(Bytes("k.1.png"), Bytes("plain.png"));
  EXPECT_EQ(Bytes("k.2.png"), Bytes("two.png"));
  ExpectError(With(transfer, {"x.png", "--set", "transfer.match_step=9"}), 2, {"transfer.match_step", "1 to 8"});
  ExpectError(With(transfer, {"x.png", "--set", "transfer.hybrid=-1"}), 2, {"transfer.hybrid", "0 or more"});
}

// --upscale: the small picture itself, enlarged.
TEST_F(Upsample, AnUpscaledPictureIsTheSmallOneEnlarged) {
  WriteStyle("style");
  const Arguments stylize{"stylize", Scene("suzanne.glb"), "--style", "style", "--bits", "16"};
  RunOk(With(stylize, {"--size", "60x40", "-o", "small.png"}));
  const Picture small = *ReadPicture(At("small.png"));
  for (const int factor : {2, 3}) {
    const std::string size = std::to_string(60 * factor) + "x" + std::to_string(40 * factor);
    const CommandResult made = RunOk(With(
        stylize, {"--size", size, "--upsample", std::to_string(factor), "--upscale", "--json", "-o", "large.png"}));
    EXPECT_EQ(made.Json()["upscale"], true);
    EXPECT_EQ(made.Json()["width"], 60 * factor);
    EXPECT_EQ(ReadPicture(At("large.png"))->rgba, Resample(small, 60 * factor, 40 * factor).rgba);
    RunOk({"guidegen", Scene("suzanne.glb"), "--style", "style", "--size", "60x40", "-o", "guides.exr"});
    RunOk({"transfer", "guides.exr", "--style", "style", "--bits", "16", "--upsample", std::to_string(factor),
           "--upscale", "--threads", "1", "-o", "again.png"});
    EXPECT_EQ(ReadPicture(At("again.png"))->rgba, ReadPicture(At("large.png"))->rgba);
  }
}

TEST_F(Upsample, UpscaleIsRefusedWhereItMeansNothing) {
  WriteStyle("style");
  const Arguments stylize{"stylize", Scene("suzanne.glb"), "--style", "style", "--size", "60x40", "-o",
                          "p.png",   "--upscale"};
  const auto refused = [&](const Arguments& more, const std::string& why) {
    const CommandResult result = Run(With(stylize, more));
    EXPECT_EQ(result.code, 2) << result.err;
    EXPECT_NE(result.err.find(why), std::string::npos) << result.err;
    EXPECT_FALSE(Exists("p.png"));
  };
  refused({}, "it needs --upsample N");
  refused({"--upsample", "2", "--over", "under.png"}, "--upscale with --over");
  refused({"--upsample", "2", "--show", "chunks"}, "--upscale with --show");
}

}  // namespace
}  // namespace scumble
