// What is warned of is in the JSON output, too: each text once.
#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"
#include "tests/support/gltf_builder.h"

namespace scumble {
namespace {

class CliWarnings : public CliTest {
 protected:
  void SetUp() override {
    WriteStyle("style");
    WriteText("s.obj", "mtllib none.mtl\no Tri\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  }
  void WriteGlb(const std::string& name, const GltfBuilder& builder) {
    const std::vector<unsigned char> glb = builder.Glb();
    WriteText(name, std::string(glb.begin(), glb.end()));
  }
  // The warnings on stderr, which must be those in the JSON output: of a sequence, of a picture, or of guides.
  std::vector<std::string> WarningsOf(const Arguments& arguments) {
    const CommandResult run = RunOk(With(arguments, {"--json"}));
    std::vector<std::string> told;
    const std::string start = "scumble: warning: ";
    for (std::size_t at = run.err.find(start); at != std::string::npos; at = run.err.find(start, at + 1)) {
      const std::size_t begin = at + start.size();
      told.push_back(run.err.substr(begin, run.err.find('\n', begin) - begin));
    }
    const auto once = [](std::vector<std::string> texts) {
      std::sort(texts.begin(), texts.end());
      texts.erase(std::unique(texts.begin(), texts.end()), texts.end());
      return texts;
    };
    const auto listed = run.Json().at("warnings").get<std::vector<std::string>>();
    EXPECT_EQ(once(listed), once(told)) << Joined(arguments);
    EXPECT_EQ(once(listed).size(), listed.size()) << run.out;
    return listed;
  }
};

TEST_F(CliWarnings, AreInTheJsonOutputOfEveryRun) {
  const Arguments scene = {"s.obj", "--size", "16"}, style = {"--style", "style"};
  const std::string lost = "s.obj: a material library is missing";
  const auto of_scene = [&](const std::string& verb, const Arguments& more) {
    const std::vector<std::string> warnings = WarningsOf(With(With({verb}, scene), more));
    ASSERT_EQ(warnings.size(), 1u) << verb;
    EXPECT_TRUE(Contains(warnings[0], lost)) << warnings[0];
  };
  of_scene("guidegen", {"-o", "g.exr"});
  of_scene("guidegen", {"--frames", "1-2", "-o", "g#.exr"});
  of_scene("guidegen", {"--explain"});
  of_scene("stylize", With(style, {"-o", "p.png"}));
  of_scene("stylize", With(style, {"--frames", "1-2", "-o", "p#.png"}));
  const Arguments idle = {"--assign", "Nobody=style"};
  EXPECT_EQ(WarningsOf(With(With(With({"stylize"}, scene), style), With(idle, {"-o", "p.png"}))).size(), 2u);
  EXPECT_EQ(WarningsOf(With(With({"transfer", "g.exr"}, style), With(idle, {"-o", "p.png"}))).size(), 1u);
  EXPECT_EQ(WarningsOf(With(With({"transfer", "g#.exr"}, style), {"--frames", "1-2", "-o", "p#.png"})).size(), 0u);
  EXPECT_EQ(WarningsOf(With(With({"transfer", "g.exr"}, style), {"--fast-io", "-o", "p.png"})).size(), 1u);
}

TEST_F(CliWarnings, NamesWithLineBreaksStayOnTheirLine) {
  GltfBuilder b;
  b.Triangle("Two\nlines");
  WriteGlb("s.glb", b);
  const CommandResult info = RunOk({"info", "s.glb"});
  EXPECT_TRUE(Contains(info.out, "Two\\nlines\n")) << info.out;
  EXPECT_EQ(RunOk({"info", "s.glb", "--json"}).Json()["objects"][0], "Two\nlines");
  const CommandResult run =
      RunOk({"stylize", "s.glb", "--size", "8", "--style", "style", "--assign", "Nobody=style", "-o", "p.png"});
  EXPECT_TRUE(Contains(run.Warning(), "its objects are Two\\nlines; its materials")) << run.err;
  b.Append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  b.Root({{"name", "Evil\n\x1b]0;\xc2\x9b"}, {"camera", 0}});
  WriteGlb("s.glb", b);
  ExpectError({"guidegen", "s.glb", "--camera", "Nope", "--size", "8", "-o", "g.exr"}, 2,
              {"there are: 'Evil\\n\\x1b]0;\\u009b"});
}

TEST_F(CliWarnings, AThingMayBeHiddenByAScaleOfZero) {
  GltfBuilder b;
  b.Triangle();
  b.Root({{"name", "Hidden"}, {"mesh", 0}, {"scale", {0, 0, 0}}});
  WriteGlb("s.glb", b);
  const Arguments guidegen = {"guidegen", "s.glb", "--size", "8", "-o", "g.exr"};
  EXPECT_EQ(RunOk(guidegen).Warning(), "");
  b.Root({{"name", "Flat"}, {"mesh", 0}, {"scale", {1, 0, 0}}});
  WriteGlb("s.glb", b);
  EXPECT_TRUE(Contains(RunOk(guidegen).Warning(), "left out (node 2 'Flat')"));
}

}  // namespace
}  // namespace scumble
