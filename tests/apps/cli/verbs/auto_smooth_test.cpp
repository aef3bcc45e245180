// --auto-smooth, and what a run says of normals that it made.
#include <array>
#include <set>
#include <string>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

class CliAutoSmooth : public CliTest {
 protected:
  CliAutoSmooth() {
    // As many programs write one: positions and polygons.
    WriteText("box.obj",
              "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
              "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  }
  // The number of normals in the picture.
  std::size_t CountNormals(const std::string& file) {
    const auto guides = ReadGuides(At(file), {});
    EXPECT_TRUE(guides.ok());
    std::set<std::array<float, 3>> normals;
    for (std::size_t i = 0; guides && i < guides->pixel_count(); ++i) {
      const auto at = [&](int c) { return guides->Plane(Layer::kNormal, c)[i]; };
      if (guides->Plane(Layer::kCoverage)[i] > 0.0f) normals.insert({at(0), at(1), at(2)});
    }
    return normals.size();
  }
  const Arguments guidegen_ = {"guidegen", "box.obj", "--size", "48", "-o", "g.exr"};
};

TEST_F(CliAutoSmooth, ABoxIsABoxAndTheRunSaysSoOnce) {
  const CommandResult made = RunOk(guidegen_);
  EXPECT_EQ(CountNormals("g.exr"), 3u);
  const std::string note =
      "box.obj: 12 triangles without normals are smooth up to 60°; --auto-smooth DEGREES changes it";
  EXPECT_NE(made.err.find(note), std::string::npos) << made.err;
  EXPECT_EQ(RunOk(With(guidegen_, {"--quiet"})).err, "");
  RunOk(With(guidegen_, {"--auto-smooth", "180"}));
  EXPECT_GT(CountNormals("g.exr"), 100u);
  RunOk(With(guidegen_, {"--auto-smooth=0"}));
  EXPECT_EQ(CountNormals("g.exr"), 3u);
  // Once for all frames, and in each command.
  WriteStyle("style");
  for (const Arguments& arguments :
       {Arguments{"guidegen", "box.obj", "--size", "16", "--frames", "1-3", "-o", "g.#.exr"},
        Arguments{"stylize", "box.obj", "--size", "16", "--style", "style", "-o", "p.png"},
        Arguments{"stylize", "box.obj", "--size", "16", "--style", "style", "--frames", "1-2", "-o", "p.#.png"},
        Arguments{"stylize", "box.obj", "--size", "16", "--style", "style", "--frame", "2", "-o", "p.png"}}) {
    const std::string err = RunOk(With(arguments, {"--auto-smooth", "30"})).err;
    const std::size_t first = err.find("are smooth up to 30°, as --auto-smooth says");
    ASSERT_NE(first, std::string::npos) << Joined(arguments) << err;
    EXPECT_EQ(err.find("--auto-smooth", first + 30), std::string::npos) << err;
  }
}

TEST_F(CliAutoSmooth, IsASettingOfTheGuides) {
  const Arguments frames = {"guidegen", "box.obj", "--size", "16", "--frames", "1-2", "-o", "g.#.exr", "--resume"};
  const auto made = [&](const Arguments& more) { return RunOk(With(frames, more)).out; };
  EXPECT_NE(made({}).find("2 made, 0 kept"), std::string::npos);
  EXPECT_NE(made({}).find("0 made, 2 kept"), std::string::npos);
  EXPECT_NE(made({"--auto-smooth", "45"}).find("2 made, 0 kept"), std::string::npos);
  EXPECT_NE(made({"--auto-smooth", "45.0"}).find("0 made, 2 kept"), std::string::npos);
}

TEST_F(CliAutoSmooth, WhatCannotBe) {
  for (const std::string angle : {"-1", "181", "nan", "inf", "12°", "flat", "1e9"}) {
    ExpectError(With(guidegen_, {"--auto-smooth=" + angle}), 2,
                {"--auto-smooth", "'" + angle + "' is no angle: expected degrees, 0 to 180"});
  }
  WriteText("a.blend", "BLENDER");
  ExpectError({"guidegen", "a.blend", "--auto-smooth", "30", "-o", "g.exr"}, 2,
              {"--auto-smooth is for files that lack normals", "a.blend", "leave it out"});
  EXPECT_NE(RunOk({"guidegen", Scene("ball.glb"), "--size", "16", "--auto-smooth", "30", "-o", "g.exr"})
                .err.find("--auto-smooth changes nothing: the file gives all its normals"),
            std::string::npos);
}

}  // namespace
}  // namespace scumble
