// scumble styles tune: proposals, and what is written.
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "core/io/picture_file.h"
#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

class StylesTune : public CliTest {
 protected:
  // Real paint, by chunks so large that hills have the paint of plains.
  void WriteCoarse() {
    std::filesystem::create_directories(At("coarse"));
    std::filesystem::copy_file(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/graphite/lit.png", At("coarse/lit.png"),
                               std::filesystem::copy_options::overwrite_existing);
    WriteText("coarse/style.toml",
              "# mine\nname = \"coarse\"\n[transfer]\nthreshold = 1.2  # too much\nlevels = 6\n[[exemplar]]\nimage = "
              "\"lit.png\"\n");
  }
  // The page's pictures as files, in its order.
  std::vector<std::string> PicturesOf(const std::string& page_name) const {
    const std::string page = Bytes(page_name), before = "data:image/png;base64,";
    std::vector<std::string> pictures;
    for (std::size_t at = page.find(before); at != std::string::npos; at = page.find(before, at)) {
      at += before.size();
      pictures.push_back(FromBase64(page.substr(at, page.find('"', at) - at)));
    }
    return pictures;
  }
  static std::string FromBase64(const std::string& text) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0, count = 0;
    for (const char one : text) {
      const std::size_t digit = digits.find(one);
      if (digit == std::string::npos) break;
      bits = (bits << 6 | unsigned(digit)) & 0xffffu, count += 6;
      if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 0xffu);
    }
    return bytes;
  }
  Arguments Tune(const Arguments& more = {}) const {
    return With({"styles", "tune", "coarse", "--scene", Scene("suzanne.glb"), "--size", "160x90", "--set",
                 "transfer.blend_radius=1"},
                more);
  }
};

TEST_F(StylesTune, ProposesWhatIsNearerToTheExemplar) {
  WriteCoarse();
  const CommandResult run = RunOk(Tune({"--json", "-o", "sheet", "--write", "1", "--set", "transfer.edge=exact"}));
  const nlohmann::json report = run.Json();
  EXPECT_EQ(report["style"], "coarse");
  EXPECT_EQ(report["scenes"], nlohmann::json({"suzanne"}));
  ASSERT_GE(report["proposals"].size(), 1u);
  ASSERT_LE(report["proposals"].size(), 5u);
  double last = 0.0;
  for (const auto& one : report["proposals"]) {
    EXPECT_GT(one["texture"].get<double>(), last) << "nearest first, each once";
    EXPECT_LT(one["texture"].get<double>(), 1.0);
    EXPECT_GT(one["time"].get<double>(), 0.0);
    last = one["texture"];
  }
  const std::vector<std::string> settings = report["proposals"][0]["settings"];
  ASSERT_FALSE(settings.empty());
  EXPECT_TRUE(std::any_of(settings.begin(), settings.end(), [](const std::string& one) {
    return one.starts_with("transfer.threshold=");
  })) << "1.2 is too much";

  // The contact sheet loads nothing and has the style and the proposals.
  const std::string page = Bytes("sheet/tune.html");
  EXPECT_EQ(page.find("://"), std::string::npos);
  std::size_t pictures = 0;
  for (std::size_t at = page.find("<img"); at != std::string::npos; at = page.find("<img", at + 1)) ++pictures;
  EXPECT_EQ(pictures, 1 + report["proposals"].size());
  EXPECT_EQ(page.find("<code></code>"), std::string::npos) << "the style as it is has no options";

  // What was written makes the picture of the proposal, and the rest of the file is as it was.
  const std::string text = Bytes("coarse/style.toml");
  EXPECT_EQ(text.find("# mine\nname = \"coarse\"\n[transfer]\n"), 0u) << text;
  EXPECT_NE(text.find("# too much\nlevels = 6\n[[exemplar]]\nimage = \"lit.png\"\n"), std::string::npos) << text;
  EXPECT_NE(text.find("blend_radius = 1\n"), std::string::npos) << text;
  EXPECT_NE(text.find("edge = \"exact\"\n"), std::string::npos) << text;
  const Arguments stylize{"stylize", Scene("suzanne.glb"), "--size", "160x90", "--style", "coarse"};
  RunOk(With(stylize, {"-o", "written.png"}));
  WriteCoarse();
  Arguments sets{"--set", "transfer.blend_radius=1"};
  for (const std::string& setting : settings) sets = With(sets, {"--set", setting});
  RunOk(With(With(stylize, sets), {"-o", "set.png"}));
  EXPECT_EQ(Bytes("written.png"), Bytes("set.png"));

  // By no clock and no threads: the same again.
  const nlohmann::json again = RunOk(Tune({"--json", "--threads", "1"})).Json();
  ASSERT_EQ(again["proposals"].size(), report["proposals"].size());
  for (std::size_t i = 0; i < again["proposals"].size(); ++i) {
    for (const char* key : {"settings", "texture"}) EXPECT_EQ(again["proposals"][i][key], report["proposals"][i][key]);
  }
}

// On its paper, with the scene's colours and its effects, as stylize paints it; all of that changes no figure.
TEST_F(StylesTune, PicturesAreThoseOfStylize) {
  WriteCoarse();
  const nlohmann::json plain = RunOk(Tune({"--json", "-o", "plain"})).Json();
  std::filesystem::create_directories(At("full"));
  std::filesystem::copy_file(At("coarse/lit.png"), At("full/lit.png"));
  WriteText(
      "full/style.toml",
      "name = \"full\"\n[transfer]\nthreshold = 1.2\nlevels = 6\ncolorize = 1.0\npaper = \"#ffd080\"\n[[exemplar]]\n"
      "image = \"lit.png\"\n[[finish]]\neffect = \"outline\"\n");
  Arguments tune = Tune({"--json", "-o", "sheet"});
  tune[2] = "full";
  const nlohmann::json full = RunOk(tune).Json();
  ASSERT_GE(full["proposals"].size(), 1u);
  ASSERT_EQ(full["proposals"].size(), plain["proposals"].size());
  for (std::size_t i = 0; i < full["proposals"].size(); ++i) {
    for (const char* key : {"settings", "texture"}) EXPECT_EQ(full["proposals"][i][key], plain["proposals"][i][key]);
  }
  const std::vector<std::string> pictures = PicturesOf("sheet/tune.html");
  ASSERT_EQ(pictures.size(), 1 + full["proposals"].size());
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    Arguments stylize{"stylize", Scene("suzanne.glb"),     "--style", "full", "--size", "160x90",
                      "--set",   "transfer.blend_radius=1"};
    if (i > 0) {
      for (const std::string setting : full["proposals"][i - 1]["settings"])
        stylize = With(stylize, {"--set", setting});
    }
    RunOk(With(stylize, {"-o", "p.png"}));
    WriteText("shown.png", pictures[i]);
    EXPECT_TRUE(Pixels("shown.png") == Pixels("p.png")) << i;
  }
}

TEST_F(StylesTune, InterruptedLeavesNoFolder) {
  WriteCoarse();
  const pid_t child = Start({"styles", "tune", "coarse", "--size", "1280x720", "-o", "sheets/coarse"});
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // of the minutes that four scenes take
  ::kill(child, SIGINT);
  EXPECT_EQ(Finish(child).code, 128 + SIGINT) << "it was at work";
  EXPECT_FALSE(Exists("sheets"));
}

TEST_F(StylesTune, KeysThatAreGivenStay) {
  WriteCoarse();
  const nlohmann::json report =
      RunOk(Tune({"--json", "--set", "transfer.threshold=0.2", "--set", "transfer.hybrid=0"})).Json();
  for (const auto& one : report["proposals"]) {
    for (const std::string setting : one["settings"]) {
      EXPECT_FALSE(setting.starts_with("transfer.threshold=") || setting.starts_with("transfer.hybrid=")) << setting;
    }
  }
}

TEST_F(StylesTune, RefusesWhatCannotBeTuned) {
  WriteCoarse();
  WritePainted("alone.png", 64, 64);
  ExpectError(Tune({"--set", "transfer.method=litsphere"}), 2, {"there is nothing to tune", "styleblit"});
  ExpectError({"styles", "tune", "nowhere", "--scene", Scene("suzanne.glb")}, 3, {"nowhere"});
  ExpectError({"styles", "tune", "coarse", "--scene", "gone.glb"}, 3, {"gone.glb"});
  ExpectError({"styles", "tune", "alone.png", "--scene", Scene("suzanne.glb"), "--write", "1"}, 3,
              {"alone.png has no style.toml"});
  WriteText("toon/style.toml", "[transfer]\nmethod = \"toon\"\n");
  ExpectError({"styles", "tune", "toon", "--scene", Scene("suzanne.glb")}, 2, {"method = \"toon\"", "nothing to tune"});
  // What cannot be written is refused at once.
  ExpectError(Tune({"-o", "coarse/style.toml"}), 4, {"-o coarse/style.toml: it is no folder, and none can be made: "});
  ExpectError(Tune({"-o", "/proc/foo"}), 4, {"-o /proc/foo: it is no folder, and none can be made: ", "name another"});
  for (const char* set : {"finish.hatch.spacing=3", "exemplar.1.fills=true", "transfer.paper=alone.png"}) {
    ExpectError(Tune({"--write", "1", "--set", set}), 2, {set, "--write cannot put that into style.toml"});
  }
  ExpectError(Tune({"--write", "1", "--set", "transfer.scale=[[1, 2], [5, 3]]"}), 2,
              {"transfer.scale", "expected a number"});
  WriteText("inline/style.toml", "transfer = { threshold = 0.2 }\n[[exemplar]]\nimage = \"../alone.png\"\n");
  ExpectError({"styles", "tune", "inline", "--scene", "gone.glb", "--write", "1"}, 3,
              {"inline/style.toml", "--write cannot put keys into [transfer]"});
  ExpectError({"styles", "tune", "oil", "--scene", Scene("suzanne.glb"), "--write", "1"}, 2,
              {"oil is a bundled style", "copy"});
}

}  // namespace
}  // namespace scumble
