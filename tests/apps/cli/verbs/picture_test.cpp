// The command line's pictures: one step or two, any number of threads, random seeds; and comparing results.
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

using CliPictures = CliTest;
using CliCompare = CliTest;

// How a picture is asked for: what concerns the guides, and what concerns the picture.
struct Variant {
  std::vector<std::string> guides;
  std::vector<std::string> picture;
};

class CliOneStepOrTwo : public CliTest {
 protected:
  // Stylises at once with all threads and through a guide file with one: two pictures of the same bytes.
  std::string ExpectSameBytes(const std::string& style, const Variant& variant) {
    const Arguments scene = With({Scene("stilllife.glb"), "--size", "96x54"}, variant.guides);
    const Arguments rest = With({"--style", style}, variant.picture);
    RunOk(With(With({"guidegen"}, scene), {"--style", style, "--threads", "1", "-o", "guides.exr"}));
    RunOk(With(With(With({"stylize"}, scene), rest), {"-o", "once.png"}));
    RunOk(With(With({"transfer", "guides.exr"}, rest), {"--threads", "1", "-o", "twice.png"}));
    EXPECT_EQ(Bytes("once.png"), Bytes("twice.png")) << style;
    EXPECT_NE(Bytes("once.png"), "") << style;
    return Bytes("once.png");
  }
};

TEST_F(CliOneStepOrTwo, SameBytesHoweverItIsAsked) {
  WriteStyle("style");
  WritePainted("under.png", 96, 54);
  const std::string plain = ExpectSameBytes("style", {}), shown = Pixels("once.png");
  RunOk({"stylize", Scene("stilllife.glb"), "--size", "96x54", "--style", "style", "--threads", "1", "-o", "one.png"});
  EXPECT_EQ(Bytes("one.png"), plain);
  RunOk({"transfer", "guides.exr", "--style", "style", "--threads", "0", "-o", "all.png"});
  EXPECT_EQ(Bytes("all.png"), plain);
  for (const Variant& variant : std::vector<Variant>{{{"--aa", "4"}, {}},
                                                     {{}, {"--over", "under.png"}},
                                                     {{"--aa", "4", "--view", "20,30"}, {"--over", "under.png"}},
                                                     {{"--normal-frame", "eye"}, {}}}) {
    ExpectSameBytes("style", variant);
    EXPECT_FALSE(Pixels("once.png") == shown);
  }
  EXPECT_EQ(ExpectSameBytes("style", {{"--half"}, {}}), plain);  // a style of normals has no colour layer to round
}

// One triangle whose normals lean away from the viewer, by 80°.
TEST_F(CliPictures, NormalsThatLeanAwayAreBentUnlessRawOnesAreAskedFor) {
  WriteStyle("style");
  WriteText("leaning.obj", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nvn 0.985 0 0.174\nf 1//1 2//1 3//1\n");
  const Arguments scene = {"leaning.obj", "--size", "32", "--view", "0,0"};
  RunOk(With(With({"guidegen"}, scene), {"-o", "bent.exr"}));
  RunOk(With(With({"guidegen"}, scene), {"--raw-normals", "-o", "raw.exr"}));
  const auto bent = ReadGuides(At("bent.exr"), {}), raw = ReadGuides(At("raw.exr"), {});
  ASSERT_TRUE(bent.ok() && raw.ok());
  const std::size_t middle = bent->Index(16, 16);
  EXPECT_NEAR(raw->Vec3(Layer::kNormal, middle).z, 0.174, 1e-3);
  const glm::dvec3 normal(bent->Vec3(Layer::kNormal, middle));
  EXPECT_NEAR(2.0 * normal.z * normal.z - 1.0, 0.01, 0.02) << "the mirrored ray runs along the surface";
  EXPECT_EQ(bent->attributes.count("scumble:raw_normals"), 0u);
  EXPECT_EQ(raw->attributes.at("scumble:raw_normals"), "true");
  RunOk(With(With({"stylize"}, scene), {"--style", "style", "-o", "bent.png"}));
  RunOk(With(With({"stylize"}, scene), {"--style", "style", "--raw-normals", "-o", "raw.png"}));
  EXPECT_FALSE(Pixels("bent.png") == Pixels("raw.png"));
}

TEST_F(CliPictures, AnEdgeThatTheExemplarHasNotIsWarnedOf) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(64));
  const Arguments transfer = {"transfer", "g.exr", "--style", "style", "--set", "transfer.edge=exemplar",
                              "-o",       "e.png"};
  EXPECT_TRUE(Contains(RunOk(transfer).err, "has no painted edge"));
  EXPECT_FALSE(Contains(RunOk({"transfer", "g.exr", "--style", "style", "-o", "e.png"}).err, "painted edge"));
}

TEST_F(CliPictures, EveryFormatHoldsThePicture) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(64));
  const Arguments transfer = {"transfer", "g.exr", "--style", "style"};
  RunOk(With(transfer, {"-o", "p.png"}));
  const Expected<Picture> png = ReadPicture(At("p.png"));
  ASSERT_TRUE(png);
  const std::vector<std::pair<std::string, std::string>> kinds = {{"16", ".png"}, {"8", ".tif"},  {"16", ".tif"},
                                                                  {"8", ".jpg"},  {"16", ".exr"}, {"32", ".exr"}};
  for (const auto& [bits, ending] : kinds) {
    const std::string name = "picture" + bits + ending;
    RunOk(With(transfer, {"--bits", bits, "-o", name}));
    const Expected<Picture> read = ReadPicture(At(name));
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->rgba.size(), png->rgba.size());
    for (std::size_t i = 0; i < read->rgba.size(); ++i) {
      const bool is_alpha = i % 4 == 3, covered = png->rgba[i - i % 4 + 3] == 65535;
      if (!is_alpha && !covered) continue;  // formats differ in the colour of transparent pixels
      if (ending == ".jpg") continue;       // lossy, and on white
      ASSERT_NEAR(read->rgba[i], png->rgba[i], 257) << name;
    }
  }
}

TEST_F(CliPictures, SeedsDecideAndRepeat) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(64));
  const auto picture = [&](const Arguments& more) {
    RunOk(With({"transfer", "g.exr", "--style", "style", "-o", "p.png"}, more));
    return Bytes("p.png");
  };
  const std::string zero = picture({}), five = picture({"--seed", "5"});
  EXPECT_EQ(picture({"--seed", "0"}), zero);
  EXPECT_EQ(picture({"--seed", "5"}), five);
  EXPECT_NE(five, zero);
  EXPECT_NE(picture({"--seed", "18446744073709551615"}), zero);
  // Frames matter to a style that renews its jitter, and to no other.
  EXPECT_EQ(picture({"--frame", "7"}), zero);
  const std::string renewed = picture({"--frame", "7", "--set", "transfer.jitter_fps=12"});
  EXPECT_NE(renewed, zero);
  EXPECT_EQ(picture({"--frame", "6", "--set", "transfer.jitter_fps=12", "--fps", "24"}), renewed);
  EXPECT_NE(picture({"--frame", "7", "--set", "transfer.jitter_fps=12", "--fps", "12"}), renewed);
  for (const char* fps : {"0", "x", "24/0"}) {
    ExpectError({"transfer", "g.exr", "--style", "style", "-o", "p.png", "--fps", fps}, 2, {"--fps", "24000/1001"});
  }
}

TEST_F(CliPictures, RepeatReportsTheSpread) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(64));
  const Arguments transfer = {"transfer", "g.exr", "--style", "style", "-o", "p.png"};
  RunOk(transfer);
  const std::string once = Bytes("p.png");
  const nlohmann::json json = RunOk(With(transfer, {"--repeat", "3", "--json"})).Json();
  EXPECT_EQ(Bytes("p.png"), once);
  EXPECT_EQ(json["repeat"], 3);
  for (const char* step : {"match", "vote", "compose"}) {
    EXPECT_LE(json["ms"][step]["min"], json["ms"][step]["median"]);
    EXPECT_LE(json["ms"][step]["median"], json["ms"][step]["max"]);
  }
  EXPECT_TRUE(Contains(RunOk(transfer).out, "p.png  read "));
}

TEST_F(CliPictures, ShowWritesWhatExplainsTheResult) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(64));
  const Arguments transfer = {"transfer", "g.exr", "--style", "style", "--json"};
  nlohmann::json plain = RunOk(With(transfer, {"-o", "p.png"})).Json();
  const std::string painted = Pixels("p.png");
  std::string last;
  for (const std::string what : {"sources", "chunks", "borders", "levels", "error", "exemplar", "styles"}) {
    nlohmann::json shown = RunOk(With(transfer, {"--show", what, "-o", "p.png"})).Json();
    for (const char* other : {"ms", "memory", "work"})
      shown.erase(other), plain.erase(other);  // other bytes are written
    EXPECT_EQ(shown, plain) << what;
    EXPECT_FALSE(Pixels("p.png") == painted) << what;
    last = Bytes("p.png");
  }
  const Expected<Picture> styles = ReadPicture(At("p.png"));
  ASSERT_TRUE(styles);
  EXPECT_EQ(styles->At(32, 32)[3], 65535);
  EXPECT_EQ(styles->At(0, 0)[3], 0) << "background";
  EXPECT_EQ(styles->At(32, 32)[0], styles->At(20, 40)[0]) << "one style, one colour";
  const CommandResult wrong = Run(With(transfer, {"--show", "seams", "-o", "p.png"}));
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(Contains(wrong.Error(), "sources")) << wrong.err;
  EXPECT_EQ(Bytes("p.png"), last) << "a refused run writes nothing";
}

TEST_F(CliPictures, SetWinsOverTheStyle) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(64));
  const Arguments transfer = {"transfer", "g.exr", "--style", "style", "-o", "p.png"};
  RunOk(transfer);
  const std::string plain = Bytes("p.png"), shown = Pixels("p.png");
  for (const char* set : {"transfer.method=litsphere", "transfer.method=\"bruteforce\"", "transfer.scale=0.5",
                          "transfer.paper=#ffeedd", "transfer.blend_radius=3", "transfer.threshold=inf"}) {
    RunOk(With(transfer, {"--set", set}));
    EXPECT_FALSE(Pixels("p.png") == shown) << set;
  }
  RunOk(With(transfer, {"--set", "transfer.scale=0.5", "--set", "transfer.scale=1"}));
  EXPECT_EQ(Bytes("p.png"), plain);
  ExpectError(With(transfer, {"--set", "transfer.bogus=1"}), 2,
              {"--set", "unknown key transfer.bogus", "blend_radius"});
  ExpectError(With(transfer, {"--set", "bogus=1"}), 2, {"--set", "unknown key bogus"});
  ExpectError(With(transfer, {"--set", "transfer.blend_radius"}), 2, {"expected KEY=VALUE"});
  ExpectError(With(transfer, {"--set", "=3"}), 2, {"expected KEY=VALUE"});
  ExpectError(With(transfer, {"--set", "transfer.blend_radius=x"}), 2,
              {"transfer.blend_radius", "whole number, 0 to 64"});
  ExpectError(With(transfer, {"--set", "transfer.levels=17"}), 2, {"transfer.levels", "1 to 16"});
  ExpectError(With(transfer, {"--set", "transfer.threshold=nan"}), 2, {"transfer.threshold", "0 or more"});
  ExpectError(With(transfer, {"--set", "transfer.method=bogus"}), 2, {"litsphere", "styleblit", "bruteforce"});
  ExpectError(With(transfer, {"--set", "transfer.method=stylit"}), 5, {"stylit", "not built"});
  ExpectError(With(transfer, {"--set", "transfer.coherent=true"}), 3, {"pref"});
  ExpectError(With(transfer, {"--set", "transfer.paper=no.png"}), 3, {"transfer.paper", "no.png", "no such file"});
}

TEST_F(CliCompare, EqualAndDifferent) {
  WritePainted("a.png", 24, 16);
  fs::copy_file(At("a.png"), At("same.png"));
  Picture changed = Painted(24, 16);
  changed.At(5, 3)[1] ^= 0x4000;
  ASSERT_TRUE(WritePicture(At("b.png"), changed));
  EXPECT_TRUE(Contains(RunOk({"compare", "a.png", "same.png"}).out, "\nequal\n"));
  const CommandResult differs = Run({"compare", "a.png", "b.png"});
  EXPECT_EQ(differs.code, 1);
  EXPECT_TRUE(Contains(differs.out, "fail")) << differs.out;
  EXPECT_TRUE(Contains(differs.out, "(5, 3)")) << differs.out;
  EXPECT_EQ(differs.err, "");
}

// idiff's long options have one dash; those commands are pasted from other people's scripts.
TEST_F(CliCompare, ThresholdsInEitherSpelling) {
  WritePainted("a.png", 24, 16);
  Picture changed = Painted(24, 16);
  changed.At(5, 3)[1] = static_cast<std::uint16_t>(changed.At(5, 3)[1] + 13107);  // a fifth of the range
  ASSERT_TRUE(WritePicture(At("b.png"), changed));
  const auto code = [&](const Arguments& more) { return Run(With({"compare", "a.png", "b.png"}, more)).code; };
  for (const std::string dash : {"-", "--"}) {
    EXPECT_EQ(code({dash + "fail", "0.1"}), 1);
    EXPECT_EQ(code({dash + "fail", "0.3"}), 0);
    EXPECT_EQ(code({dash + "failrelative", "0.9"}), 0);
    EXPECT_EQ(code({dash + "failpercent", "1"}), 0);
    EXPECT_EQ(code({dash + "failpercent", "1", dash + "hardfail", "0.1"}), 1);
    EXPECT_EQ(code({dash + "allowfailures", "1"}), 0);
    EXPECT_EQ(code({dash + "fail", "0.3", dash + "warn", "0.1"}), 0);
  }
  EXPECT_TRUE(Contains(Run({"compare", "a.png", "b.png", "-fail", "0.3", "-warn", "0.1"}).out, "\nwarn"));
  ExpectError({"compare", "a.png", "b.png", "-fail", "x"}, 2, {"expected a number: --fail = x"});
  ExpectError({"compare", "a.png", "b.png", "-fail", "-1"}, 2, {"expected 0 or more"});
  ExpectError({"compare", "a.png", "b.png", "-failpercent", "101"}, 2, {"expected 0 to 100"});
  ExpectError({"compare", "a.png", "b.png", "-allowfailures", "-1"}, 2, {"-1 is negative"});
}

TEST_F(CliCompare, WhatCannotBeCompared) {
  WritePainted("a.png", 24, 16);
  WritePainted("wide.png", 25, 16);
  WriteGuideFile("g.exr", Ball(16));
  ExpectError({"compare", "a.png", "wide.png"}, 3, {"a.png is 24×16", "wide.png is 25×16", "one size"});
  ExpectError({"compare", "a.png", "missing.png"}, 3, {"missing.png", "no such file"});
  ExpectError({"compare", "a.png", "."}, 3, {".", "folder"});
  ExpectError({"compare", "a.png", "a.png", "--layer", "bogus"}, 3, {"'bogus'", "the first has color, A"});
  WriteText("text.png", "no picture");
  ExpectError({"compare", "a.png", "text.png"}, 3, {"text.png"});
  EXPECT_EQ(Run({"compare", "g.exr", "g.exr", "--layer", "normal"}).code, 0);
}

TEST_F(CliCompare, FlickerAlongTheMotion) {
  WritePainted("a.png", 24, 24);
  GuideSet guides = Ball(24);
  guides.Add(Layer::kMotion);
  for (float& x : guides.Plane(Layer::kMotion, 0)) x = 2.0f;
  WriteGuideFile("g.exr", guides);
  WriteGuideFile("next.exr", Ball(24));
  const Picture a = *ReadPicture(At("a.png"));
  Picture b = a;
  for (int y = 0; y < 24; ++y) std::copy(a.At(0, y), a.At(22, y), b.At(2, y));
  ASSERT_TRUE(WritePicture(At("b.png"), b));
  const CommandResult moved = RunOk({"compare", "a.png", "b.png", "--motion", "g.exr", "--json"});
  EXPECT_EQ(moved.Json()["flicker"], 0.0);
  EXPECT_EQ(moved.Json()["floor"], 0.0);
  EXPECT_GT(moved.Json()["pixels"], 100);
  const CommandResult still =
      RunOk({"compare", "a.png", "a.png", "--motion", "g.exr", "--motion-next", "next.exr", "--json"});
  EXPECT_GT(still.Json()["flicker"], 1.0);
  EXPECT_LT(still.Json()["pixels"], moved.Json()["pixels"]);  // beyond the sphere's edge there is background
  EXPECT_TRUE(Contains(RunOk({"compare", "a.png", "a.png", "--motion", "g.exr"}).out, "flicker "));
  RunOk({"compare", "a.png", "b.png", "--motion", "g.exr", "-o", "moved-map.png"});
  RunOk({"compare", "a.png", "a.png", "--motion", "g.exr", "-o", "still-map.png"});
  const Expected<Picture> moved_map = ReadPicture(At("moved-map.png")), still_map = ReadPicture(At("still-map.png"));
  ASSERT_TRUE(moved_map && still_map);
  EXPECT_EQ(moved_map->At(0, 0)[3], 0) << "not compared";
  EXPECT_EQ(moved_map->At(12, 12)[3], 65535);
  EXPECT_TRUE(moved_map->rgba != still_map->rgba);
  ExpectError({"compare", "a.png", "b.png", "--motion", "g.exr", "-o", "g.exr"}, 2, {"g.exr"});
  ExpectError({"compare", "a.png", "b.png", "--motion", "next.exr"}, 3, {"next.exr", "motion"});
  ExpectError({"compare", "a.png", "b.png", "--motion-next", "g.exr"}, 2, {"--motion-next", "--motion"});
  ExpectError({"compare", "a.png", "b.png", "--motion", "g.exr", "-fail", "1"}, 2, {"--motion", "--fail"});
  WritePainted("small.png", 20, 24);
  ExpectError({"compare", "a.png", "small.png", "--motion", "g.exr"}, 3, {"second picture is 20×24", "24×24"});
}

TEST_F(CliCompare, HeatMapAndJson) {
  WritePainted("a.png", 24, 16);
  Picture changed = Painted(24, 16);
  changed.At(5, 3)[1] ^= 0x4000;
  ASSERT_TRUE(WritePicture(At("b.png"), changed));
  const CommandResult result = Run({"compare", "a.png", "b.png", "-o", "heat.png", "--json"});
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(result.err, "heat.png: yellow is a difference of 0.251\n");
  EXPECT_EQ(result.Json()["verdict"], "fail");
  EXPECT_EQ(result.Json()["stats"]["worst"]["channel"], "G");
  EXPECT_EQ(result.Json()["stats"]["worst"]["x"], 5);
  const Expected<Picture> heat = ReadPicture(At("heat.png"));
  ASSERT_TRUE(heat);
  EXPECT_EQ(heat->width, 24);
  EXPECT_EQ(heat->height, 16);
  EXPECT_GT(heat->At(5, 3)[0], heat->At(4, 3)[0]);
  EXPECT_EQ(RunOk({"compare", "a.png", "a.png", "-o", "heat.png"}).err, "heat.png: nothing differs\n");
  GuideSet holed = Ball(16);
  holed.Plane(Layer::kDepth)[100] = std::numeric_limits<float>::quiet_NaN();
  WriteGuideFile("whole.exr", Ball(16));
  WriteGuideFile("holed.exr", holed);
  EXPECT_EQ(Run({"compare", "whole.exr", "holed.exr", "-o", "heat.png"}).err,
            "heat.png: magenta are pixels with NaN, or with infinity on one side: 1\n");
  ExpectError({"compare", "a.png", "b.png", "-o", "heat.gif"}, 2, {"heat.gif", ".png, .tif, .jpg, .exr"});
}

TEST_F(CliCompare, NanIsADifference) {
  GuideSet whole = Ball(16), holed = Ball(16);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  holed.Plane(Layer::kNormal, 1)[holed.Index(8, 8)] = nan;
  WriteGuideFile("whole.exr", whole);
  WriteGuideFile("holed.exr", holed);
  const CommandResult result = Run({"compare", "whole.exr", "holed.exr", "--json", "-o", "heat.png"});
  EXPECT_EQ(result.code, 1);
  ASSERT_TRUE(result.Json().is_object()) << result.out;
  EXPECT_EQ(result.Json()["stats"]["incomparable"], 1);
  EXPECT_EQ(result.Json()["stats"]["worst"]["b"], "nan");
  EXPECT_EQ(Run({"compare", "whole.exr", "holed.exr", "-fail", "1e30"}).code, 1);
  EXPECT_EQ(Run({"compare", "holed.exr", "holed.exr"}).code, 1);
  // Both backgrounds are infinitely deep; that is equal.
  EXPECT_EQ(Run({"compare", "whole.exr", "whole.exr", "--layer", "depth"}).code, 0);
}

}  // namespace
}  // namespace scumble
