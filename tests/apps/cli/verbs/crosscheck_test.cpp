// scumble crosscheck: its checks before it runs Blender.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/cli_harness.h"

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
  expect({kSuzanne, "-o", "r.txt"}, 2, "-o r.txt ends in .txt");
  expect({kSuzanne, "-o", "nowhere/report.html"}, 4, "there is no folder");
  expect({"--blender", "", kSuzanne}, 2, "--blender");
  expect({kSuzanne, "--write-baseline", "nowhere/b.json"}, 4, "there is no folder");
  Write("file", "");
  expect({kSuzanne, "--keep", "file"}, 4, "--keep file is no folder");
  expect({kSuzanne, "--keep", "file/more"}, 4, "--keep file/more is no folder and none can be made: Not a directory");
  expect({kSuzanne, "--baseline", "none.json"}, 3, "none.json");
  Write("broken.json", "{\n]");
  expect({kSuzanne, "--baseline", "broken.json"}, 3, "broken.json is no baseline");
  Write("b.json", kBaseline);
  expect({kSuzanne, "--baseline", "b.json", "--size", "64x36"}, 3, "--samples 4 and not 64");
  expect({SCUMBLE_SOURCE_DIR "/scenes/snail.glb", "--baseline", "b.json"}, 3, "no scene snail.glb");
  expect({kSuzanne, "--size", "64x36", "--samples", "1"}, 5, "/nowhere/blender cannot be run");
  EXPECT_FALSE(std::filesystem::exists(At("report.html")));
}

TEST_F(CrosscheckCli, ABadSceneIsAVerdictAndTheReportIsWritten) {
  Write("bad's.glb", "none");
  const CommandResult result = Run({"crosscheck", "bad's.glb", "UP.GLB", "--size", "32", "--samples", "1", "--json",
                                    "--camera", "My Camera", "--blender", "./my blender", "-o", "report.html"});
  EXPECT_EQ(result.code, 3) << result.err;
  EXPECT_NE(result.Error().find("bad's.glb"), std::string::npos) << result.err;
  EXPECT_NE(result.Error().find("2 of 2 scenes could not be compared"), std::string::npos) << result.err;
  const nlohmann::json json = result.Json();
  ASSERT_EQ(json.size(), 2u) << result.out;
  EXPECT_EQ(json[0]["verdict"], "could not be compared");
  EXPECT_EQ(json[0]["passed"], false);
  EXPECT_NE(json[0]["failure"].get<std::string>().find("bad's.glb"), std::string::npos);
  EXPECT_NE(json[1]["failure"].get<std::string>().find("no such file"), std::string::npos) << "an ending in capitals";
  const std::string html = Bytes("report.html");
  EXPECT_NE(html.find("could not be compared"), std::string::npos);
  EXPECT_NE(html.find("&#39;bad&#39;\\&#39;&#39;s.glb&#39; UP.GLB --size 32"), std::string::npos);
  EXPECT_NE(html.find("--camera=&#39;My Camera&#39; --blender &#39;./my blender&#39;"), std::string::npos);
}

}  // namespace
}  // namespace scumble
