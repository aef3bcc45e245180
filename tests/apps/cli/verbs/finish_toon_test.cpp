// Wrapped light, Gooch's shading and ramps of toon from the command line.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

constexpr const char* kLitBall = SCUMBLE_SOURCE_DIR "/scenes/ball.glb";

class CliToon : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    RunOk({"guidegen", kLitBall, "--size", "40", "--layers", "cosine,shadow,albedo,uv", "-o", "g.exr"});
    Picture grey(40, 40);
    std::fill(grey.rgba.begin(), grey.rgba.end(), std::uint16_t{65535});
    ASSERT_TRUE(WritePicture(At("p.png"), grey));
  }
  Arguments Toon(const std::vector<std::string>& keys) {
    Arguments arguments{"finish", "p.png", "g.exr", "--finish", "toon", "--bits", "16", "-o", "o.png"};
    for (const std::string& key : keys) arguments.insert(arguments.end(), {"--set", "finish.toon." + key});
    return arguments;
  }
  Picture Made(const std::vector<std::string>& keys) {
    RunOk(Toon(keys));
    return ReadPicture(At("o.png")).value();
  }
};

TEST_F(CliToon, RampsAreTextOrFiles) {
  const std::vector<std::string> base{"light=wrapped", "shading=ramp", "ramp_rows=facing"};
  const auto with = [&](const std::string& more) {
    std::vector<std::string> keys = base;
    if (!more.empty()) keys.push_back(more);
    return keys;
  };
  const Picture text = Made(with("ramp=#000000 #ff0000 / #000000 #0000ff"));
  Picture colors(2, 2);
  const std::uint16_t texels[] = {0, 0, 0, 65535, 65535, 0, 0, 65535, 0, 0, 0, 65535, 0, 0, 65535, 65535};
  std::copy(std::begin(texels), std::end(texels), colors.rgba.begin());
  ASSERT_TRUE(WritePicture(At("ramp.png"), colors));
  EXPECT_EQ(Made(with("ramp=ramp.png")).rgba, text.rgba);
  EXPECT_NE(text.rgba, ReadPicture(At("p.png")).value().rgba);
  // In a preset a file lies beside it.
  std::filesystem::create_directories(At("looks"));
  WriteText("looks/x.toml",
            "help = \"x\"\n[[finish]]\neffect = \"toon\"\nlight = \"wrapped\"\nshading = \"ramp\"\nramp_rows = "
            "\"facing\"\nramp = \"ramp.png\"\n");
  ASSERT_TRUE(WritePicture(At("looks/ramp.png"), colors));
  RunOk({"finish", "p.png", "g.exr", "--finish", "looks/x.toml", "--bits", "16", "-o", "o.png"});
  EXPECT_EQ(ReadPicture(At("o.png")).value().rgba, text.rgba);
  ExpectError({"finish", "p.png", "g.exr", "--finish", "looks/x.toml", "-o", "looks/ramp.png"}, 2,
              {"a file of a finish"});

  ExpectError(Toon(with("")), 3, {"finish toon: shading is \"ramp\"", "set finish.toon.ramp to colours"});
  ExpectError(Toon(with("ramp=none.png")), 3, {"finish toon: ramp: ", "none.png"});
  ExpectError(Toon(with("ramp=#000000 #12345")), 2, {"#12345 is no colour"});
  ExpectError(Toon(with("ramp=#000000 #ffffff / #000000")), 2, {"row 2 has 1 colours, the rows before have 2"});
  ASSERT_TRUE(WritePicture(At("wide.png"), Picture(1025, 1)));
  ExpectError(Toon(with("ramp=wide.png")), 3, {"finish toon: ramp: wide.png: the ramp is 1025×1 pixels", "1024"});
}

TEST_F(CliToon, NeedsTheLayersItReads) {
  EXPECT_EQ(Made({"light=wrapped", "shading=gooch", "bands=1"}).width, 40);
  ExpectError(Toon({}), 3, {"g.exr has no layer luminance", "--layers luminance"});
  EXPECT_TRUE(Contains(RunOk({"info", "g.exr"}).out, "cosine, uv"));
}

TEST_F(CliToon, ARampCoversThePaint) {
  const auto said = [&](const std::string& shading) {
    return RunOk({"finish", "p.png", "g.exr", "--finish", "grade", "--finish", "toon", "--set",
                  "finish.toon.base=paint", "--set", "finish.toon.light=wrapped", "--set",
                  "finish.toon.ramp=#000000 #ffffff", "--set", "finish.toon.shading=" + shading, "-o", "o.png"})
        .err;
  };
  EXPECT_TRUE(Contains(said("ramp"), "finish grade is covered by toon"));
  EXPECT_FALSE(Contains(said("gooch"), "covered by"));
}

// Colours are read for frames that come to show them, and missing ones are told before anything is cast.
TEST_F(CliToon, RampsOverTime) {
  const auto with = [&](const Arguments& more) {
    Arguments all{"stylize", Scene("ball.glb"), "--size", "32", "--style", "render", "--finish", "toon"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const Arguments ramp{"--set", "finish.toon.ramp=\"#000000 #ff0000\""};
  Arguments moving = with(ramp);
  moving.insert(moving.end(),
                {"--set", "finish.toon.shading=[[1,\"plain\"],[3,\"ramp\"]]", "--frames", "1-3", "-o", "m.####.png"});
  RunOk(moving);
  Arguments still = with(ramp);
  still.insert(still.end(), {"--set", "finish.toon.shading=\"ramp\"", "--frame", "3", "-o", "s.png"});
  RunOk(still);
  const auto third = ReadPicture(At("m.0003.png")), alone = ReadPicture(At("s.png")),
             first = ReadPicture(At("m.0001.png"));
  ASSERT_TRUE(third && alone && first);
  EXPECT_EQ(third->rgba, alone->rgba);
  EXPECT_NE(first->rgba, third->rgba);
  const CommandResult bare = Run(with({"--set", "finish.toon.shading=\"ramp\"", "-o", "b.png"}));
  EXPECT_EQ(bare.code, 3);
  EXPECT_TRUE(Contains(bare.err, "there are no colours for it")) << bare.err;
}

}  // namespace
}  // namespace scumble
