// The search for the module of formats, and the program without it: in the folders of builds and installations.
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModule = "libscumble_formats.so";

class CliModule : public CliTest {
 protected:
  CliModule() : settings_(CopyProgram("home/bin")) {
    fs::remove(At("home/bin") / kModule);
    fs::create_directories(At("home/lib/scumble"));
  }
  void Put(const fs::path& module, const std::string& folder) {
    fs::copy_file(module, At(folder) / kModule, fs::copy_options::overwrite_existing);
  }
  static fs::path Module() { return fs::path(SCUMBLE_BINARY).parent_path() / kModule; }
  CommandResult RunHere(const Arguments& arguments) { return Run(arguments, settings_); }

  CommandSettings settings_;
};

TEST_F(CliModule, BesideTheProgramOrInstalledAndNowhereElse) {
  WriteGuideFile("g.exr", Ball(16));
  const Arguments compare = {"compare", "g.exr", "g.exr"};  // any channels of any file
  Put(Module(), ".");                                       // the folder that it runs in
  ExpectError(compare, 5, {kModule, At("home/bin").string(), At("home/lib/scumble").string()}, settings_);
  for (const std::string folder : {"home/bin", "home/lib/scumble"}) {
    Put(Module(), folder);
    const CommandResult found = RunHere(compare);
    EXPECT_EQ(found.code, 0) << folder << found.err;
    fs::remove(At(folder) / kModule);
  }
}

TEST_F(CliModule, OneOfOtherTypesIsRefused) {
  WriteGuideFile("g.exr", Ball(16));
  Put(SCUMBLE_OTHER_MODULE, "home/bin");
  ExpectError({"compare", "g.exr", "g.exr"}, 5, {At("home/bin").string(), "of another version"}, settings_);
  WriteText(std::string("home/bin/") + kModule, "no library");
  ExpectError({"compare", "g.exr", "g.exr"}, 5, {"cannot be loaded"}, settings_);
}

TEST_F(CliModule, GuidesAndPicturesThatAreWrittenNeedNone) {
  WriteStyle("style");
  const std::vector<Arguments> commands = {
      {"guidegen", Scene("ball.glb"), "--size", "32", "-o", "g.exr"},
      {"info", "g.exr"},
      {"transfer", "g.exr", "--style", "style", "-o", "p.exr"},
      {"transfer", "g.exr", "--style", "style", "-o", "p.tif"},
      {"stylize", Scene("ball.glb"), "--style", "style", "--size", "32", "-o", "s.exr"}};
  for (const Arguments& command : commands) {
    const CommandResult without = RunHere(command);
    EXPECT_EQ(without.code, 0) << without.err;
  }
  EXPECT_EQ(Bytes("p.exr"), Bytes("s.exr"));
}

TEST_F(CliModule, ResumeWithoutItKeepsPlainPngsAndMakesNothingAgain) {
  WriteStyle("style");
  const Arguments stylize = {"stylize", Scene("ball.glb"), "--style", "style", "--size", "32", "--frames", "1-2"};
  const Arguments png = With(stylize, {"-o", "p#.png"}), tiff = With(stylize, {"-o", "p#.tif"});
  RunOk(png), RunOk(tiff);
  const std::string before = Bytes("p1.tif");
  const CommandResult kept = RunHere(With(png, {"--resume"}));
  EXPECT_EQ(kept.code, 0) << kept.err;
  EXPECT_NE(kept.out.find("0 made, 2 kept;"), std::string::npos) << kept.out;
  ExpectError(With(tiff, {"--resume"}), 5, {kModule}, settings_);
  EXPECT_EQ(Bytes("p1.tif"), before);
}

}  // namespace
}  // namespace scumble
