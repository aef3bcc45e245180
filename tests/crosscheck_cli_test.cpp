// scumble crosscheck: what it says before it would run Blender.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/cli_harness.h"

namespace scumble {
namespace {

const std::string kSuzanne = SCUMBLE_SOURCE_DIR "/scenes/suzanne.glb";
constexpr const char* kBaseline =
    R"({"scumble_baseline": 1, "blender": "3.4.1", "scenes": {"suzanne.glb": {"size": "64x36",
  "samples": 4, "max_bounces": 2, "limits": {"normal 99% within": 0.001}}}})";

class CrosscheckCli : public CliTest {
 protected:
  void Write(const std::string& name, const std::string& text) const { std::ofstream(At(name)) << text; }
};

TEST_F(CrosscheckCli, HelpNamesEveryOption) {
  const std::string help = Run({"crosscheck", "--help"}).out;
  for (const std::string option : {"--samples", "--max-bounces", "--baseline", "--write-baseline", "--keep", "--frame",
                                   "--size", "--camera", "--blender", "--output", "--json"}) {
    EXPECT_NE(help.find(option), std::string::npos) << option;
  }
}

TEST_F(CrosscheckCli, MistakesAreSaidBeforeBlenderRuns) {
  const auto expect = [&](const Arguments& arguments, int code, const std::string& part) {
    Arguments all{"crosscheck", "--blender", "/nowhere/blender"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandResult result = Run(all);
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  };
  expect({kSuzanne, "--frame", "2"}, 2, "--frame is for .blend scenes");
  expect({kSuzanne, "--size", "0"}, 2, "--size");
  expect({kSuzanne, "--samples", "-1"}, 2, "--samples");
  expect({kSuzanne, "--max-bounces", "5000"}, 2, "--max-bounces");
  expect({kSuzanne, kSuzanne, "--write-baseline", "b.json"}, 2, "two scenes");
  expect({kSuzanne, kSuzanne, "--keep", "."}, 2, "kept as suzanne.cycles.exr");
  expect({"x.obj"}, 3, "a cross-check needs a scene");
  expect({kSuzanne, "-o", "nowhere/report.html"}, 4, "there is no folder");
  expect({kSuzanne, "--write-baseline", "nowhere/b.json"}, 4, "there is no folder");
  Write("file", "");
  expect({kSuzanne, "--keep", "file"}, 4, "--keep file is no folder");
  expect({kSuzanne, "--baseline", "none.json"}, 3, "none.json");
  Write("broken.json", "{\n]");
  expect({kSuzanne, "--baseline", "broken.json"}, 3, "broken.json is no baseline");
  Write("b.json", kBaseline);
  expect({kSuzanne, "--baseline", "b.json", "--size", "64x36"}, 3, "--samples 4 and not 64");
  expect({SCUMBLE_SOURCE_DIR "/scenes/snail.glb", "--baseline", "b.json"}, 3, "no scene snail.glb");
  expect({kSuzanne, "--size", "64x36", "--samples", "1"}, 5, "/nowhere/blender cannot be run");
  EXPECT_FALSE(std::filesystem::exists(At("report.html")));
}

}  // namespace
}  // namespace scumble
