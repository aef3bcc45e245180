// --quality: fixed steps of the ladder, the same on any machine.
#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

class CliQuality : public CliTest {
 protected:
  // The options that a report names, as arguments.
  static Arguments Options(const nlohmann::json& chosen) { return chosen.at("options").get<Arguments>(); }

  Arguments Stylize(const std::string& style) const {
    return {"stylize", Scene("suzanne.glb"), "--style", style, "--size", "128x72"};
  }
};

TEST_F(CliQuality, EachPointIsRepeatedByTheOptionsThatItNames) {
  WriteStyle("style");
  for (const std::string quality : {"draft", "preview", "final"}) {
    const std::string picture = quality + ".png";
    const CommandResult result = RunOk(With(Stylize("style"), {"--quality", quality, "--json", "-o", picture}));
    const nlohmann::json chosen = result.Json().at("quality");
    EXPECT_EQ(chosen.at("name"), quality);
    EXPECT_NE(result.err.find("quality " + quality), std::string::npos) << result.err;
    RunOk(With(With(Stylize("style"), Options(chosen)), {"-o", "again.png"}));
    EXPECT_EQ(Bytes("again.png"), Bytes(picture)) << quality << " " << chosen;
    RunOk(With(Stylize("style"), {"--quality", quality, "--threads", "1", "--quiet", "-o", "one.png"}));
    EXPECT_EQ(Bytes("one.png"), Bytes(picture)) << "no clock, no threads in it";
  }
  RunOk(With(Stylize("style"), {"-o", "plain.png"}));
  EXPECT_EQ(Bytes("final.png"), Bytes("plain.png")) << "final is the style as it is";
  EXPECT_NE(Bytes("draft.png"), Bytes("preview.png"));
  EXPECT_EQ(Bytes("preview.png"), Bytes("final.png")) << "of normals alone nothing is dear";
  for (const char* quality : {"preview", "final"}) {
    RunOk(With(Stylize("chiaroscuro"), {"--quality", quality, "-o", quality + std::string(".png")}));
  }
  EXPECT_NE(Bytes("preview.png"), Bytes("final.png")) << "light is";
}

TEST_F(CliQuality, SetAndUpsampleWin) {
  WriteStyle("style");
  const nlohmann::json chosen =
      RunOk(With(Stylize("style"), {"--quality", "draft", "--set", "transfer.method=styleblit", "--set",
                                    "transfer.blend_radius=1", "--upsample", "2", "--json", "-o", "draft.png"}))
          .Json()
          .at("quality");
  EXPECT_EQ(Options(chosen), Arguments());
  RunOk(With(Stylize("style"), {"--upsample", "2", "-o", "plain.png"}));
  EXPECT_EQ(Bytes("draft.png"), Bytes("plain.png"));
  // Reported even if it equals the default.
  const nlohmann::json one =
      RunOk(With(Stylize("style"), {"--quality", "draft", "--upsample", "1", "--json", "-o", "one.png"})).Json();
  EXPECT_EQ(one.at("upsample"), 1);
}

TEST_F(CliQuality, GuidesThatAreThereKeepTheirSize) {
  WriteStyle("style");
  WriteGuideFile("ball.exr", Ball(48));
  const Arguments transfer{"transfer", "ball.exr", "--style", "style"};
  const nlohmann::json report = RunOk(With(transfer, {"--quality", "draft", "--json", "-o", "draft.png"})).Json();
  const Arguments options{"--set", "transfer.blend_radius=0"};
  EXPECT_EQ(Options(report.at("quality")), options);
  EXPECT_EQ(report.at("width"), 48);
  RunOk(With(With(transfer, options), {"-o", "again.png"}));
  EXPECT_EQ(Bytes("again.png"), Bytes("draft.png"));
}

// 121 is divided by none of the factors, so the guides are as large as the picture.
TEST_F(CliQuality, SizesThatHaveNoFactorAreCastWhole) {
  WriteStyle("style");
  const nlohmann::json report = RunOk({"stylize", Scene("suzanne.glb"), "--style", "style", "--size", "121x72",
                                       "--quality", "draft", "--json", "-o", "draft.png"})
                                    .Json();
  EXPECT_EQ(report.at("upsample"), 1);
  EXPECT_EQ(report.at("width"), 121);
}

// The preset step's value holds in all frames, as that of --set does, whatever values the style has; and it is part of
// what
// --resume compares.
TEST_F(CliQuality, SequencesArePaintedByOneWayAndResumed) {
  WritePainted("style/lit.png", 64, 64);
  WriteText("style/style.toml",
            "[transfer]\nreference_height = 0\nlevels = 4\nmethod = [[1, \"styleblit\"], [3, \"litsphere\"]]\n"
            "[[exemplar]]\nimage = \"lit.png\"\n");
  const Arguments stylize = With(Stylize("style"), {"--frames", "1-3"});
  const CommandResult result = RunOk(With(stylize, {"--quality", "draft", "--json", "-o", "d.#.png"}));
  const Arguments options = Options(result.Json().at("quality"));
  RunOk(With(With(stylize, options), {"-o", "o.#.png"}));
  for (const char* const frame : {"1", "2", "3"}) {
    EXPECT_EQ(Bytes(std::string("d.") + frame + ".png"), Bytes(std::string("o.") + frame + ".png"));
  }
  const auto made = std::filesystem::last_write_time(At("d.1.png"));
  RunOk(With(stylize, {"--quality", "draft", "--resume", "-o", "d.#.png"}));
  EXPECT_EQ(std::filesystem::last_write_time(At("d.1.png")), made) << "the same settings: kept";
  const std::string draft = Bytes("d.1.png");
  RunOk(With(stylize, {"--quality", "preview", "--resume", "-o", "d.#.png"}));
  EXPECT_NE(Bytes("d.1.png"), draft) << "another quality: made again";
}

// Of a style that looks at light a preview is the style as it is on smaller guides.
TEST_F(CliQuality, APreviewIsNotTakenForTheFinalPicture) {
  const auto kept = [&](const std::string& quality) {
    return RunOk(With(Stylize("chiaroscuro"),
                      {"--frames", "1-2", "--quality", quality, "--resume", "--json", "-o", "q.#.png"}))
        .Json()["kept"];
  };
  EXPECT_EQ(kept("preview"), 0);
  EXPECT_EQ(kept("preview"), 2);
  EXPECT_EQ(kept("final"), 0);
  EXPECT_EQ(kept("final"), 2);
  EXPECT_EQ(kept("preview"), 0);
}

// Nor is a noisy one, in either command: samples are reported if a style needs light, and only then.
TEST_F(CliQuality, FewerSamplesAreNotTakenForMore) {
  WriteStyle("style");
  for (const bool lit : {true, false}) {
    const std::string style = lit ? "chiaroscuro" : "style", name = lit ? "lit" : "unlit";
    const auto kept = [&](const char* samples) {
      const Arguments stylize = {"stylize", Scene("ball.glb"), "--style", style,      "--size", "32", "--samples",
                                 samples,   "--frames",        "1-2",     "--resume", "--json", "-o", name + ".#.png"};
      return RunOk(stylize).Json().at("kept").get<int>();
    };
    EXPECT_EQ(kept("2"), 0);
    EXPECT_EQ(kept("2"), 2);
    EXPECT_EQ(kept("3"), lit ? 0 : 2);
    EXPECT_EQ(kept("3"), 2);
  }
  RunOk({"guidegen", Scene("ball.glb"), "--style", "chiaroscuro", "--size", "32", "--samples", "3", "-o", "g.1.exr"});
  const Arguments transfer = {"transfer", "g.#.exr",  "--style", "chiaroscuro", "--frames",
                              "1-1",      "--resume", "--json",  "-o",          "lit.#.png"};
  EXPECT_EQ(RunOk(transfer).Json().at("kept"), 1) << "guides tell how many samples they have";
  RunOk({"guidegen", Scene("ball.glb"), "--style", "chiaroscuro", "--size", "32", "--samples", "2", "-o", "g.1.exr"});
  EXPECT_EQ(RunOk(transfer).Json().at("kept"), 0);
}

TEST_F(CliQuality, WhatMakesNoSenseIsRefused) {
  WriteStyle("style");
  const Arguments stylize = With(Stylize("style"), {"-o", "out.png"});
  ExpectError(With(stylize, {"--quality", "best"}), 2, {"--quality", "best"});
  ExpectError(With(stylize, {"--quality", "draft", "--budget-ms", "20"}), 2, {"--quality draft", "--budget-ms"});
  ExpectError(With(stylize, {"--recalibrate"}), 2, {"--recalibrate", "--budget-ms"});
  ExpectError(With(stylize, {"--quality", "draft", "--recalibrate"}), 2, {"--recalibrate", "--budget-ms"});
  for (const char* const budget : {"0", "-5", "soon", "nan", "inf", "1e400", "40ms", ""}) {
    ExpectError(With(stylize, {"--budget-ms", budget}), 2,
                {"--budget-ms: '" + std::string(budget) + "' is no number above 0: expected milliseconds, as 40"});
  }
  EXPECT_FALSE(Exists("out.png"));
}

}  // namespace
}  // namespace scumble
