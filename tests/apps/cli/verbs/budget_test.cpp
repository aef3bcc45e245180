// --budget-ms from the command line. The tests check only properties that hold for any clock.
#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

class CliBudget : public CliTest {
 protected:
  CliBudget() {
    WriteStyle("style");
    WriteGuideFile("ball.exr", Ball(48));
  }

  static Arguments Options(const nlohmann::json& budget) { return budget.at("options").get<Arguments>(); }

  Arguments Stylize() const { return {"stylize", Scene("suzanne.glb"), "--style", "style", "--size", "128x72"}; }
  Arguments Transfer() const { return {"transfer", "ball.exr", "--style", "style"}; }

  nlohmann::json Budget(const Arguments& command, const std::string& ms, const Arguments& more = {}) {
    const nlohmann::json report =
        RunOk(With(With(command, {"--budget-ms", ms, "--json", "-o", "picked.png"}), more)).Json();
    return report.value("budget", nlohmann::json());
  }
  std::vector<std::filesystem::path> Kept() const {
    std::vector<std::filesystem::path> files;
    const std::filesystem::path folder = Cache() / "scumble" / "times";
    if (!std::filesystem::exists(folder)) return files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
    return files;
  }
};

// An hour is enough for anything: the style itself.
TEST_F(CliBudget, AnHourIsEnoughForTheStyleAsItIs) {
  for (const Arguments& command : {Stylize(), Transfer()}) {
    const nlohmann::json budget = Budget(command, "3600000");
    EXPECT_EQ(budget.at("ms"), 3600000.0);
    EXPECT_EQ(budget.at("picked"), "the style");
    EXPECT_EQ(budget.at("fits"), true);
    EXPECT_GT(budget.at("predicted_ms").get<double>(), 0.0);
    EXPECT_GT(budget.at("measured_runs").get<int>(), 0);
    EXPECT_EQ(Options(budget), Arguments());
    RunOk(With(command, {"-o", "plain.png"}));
    EXPECT_EQ(Bytes("picked.png"), Bytes("plain.png"));
  }
}

// What calibrating takes stands by itself in --timing, and is no part of reading or casting.
TEST_F(CliBudget, CalibrationIsAStageOfItsOwn) {
  for (const Arguments& command : {Stylize(), Transfer()}) {
    const nlohmann::json report =
        RunOk(With(command, {"--budget-ms", "3600000", "--timing", "--json", "-o", "picked.png"})).Json();
    int found = 0;
    for (const auto& stage : report.at("timing")) found += stage.at("stage") == "calibration";
    EXPECT_EQ(found, 1);
  }
}

// A plan alone shows the chosen variant, whichever the clock decides on.
TEST_F(CliBudget, APlanIsOfWhatIsPicked) {
  struct Plan {
    int smaller = 1;  // factor by which the guides are smaller than the picture
    double guides = 0.0;
  };
  const auto plan_of = [&](const Arguments& command, const Arguments& more) {
    const CommandResult run = RunOk(With(With(command, {"--explain", "--json"}), more));
    Plan plan;
    const std::string option = "--upsample ";
    const std::size_t at = run.err.find(option);
    if (at != std::string::npos) plan.smaller = std::stoi(run.err.substr(at + option.size()));
    plan.guides = run.Json().at("memory").at("parts").at("guides").get<double>();
    return plan;
  };
  const Plan whole = plan_of(Stylize(), {});
  EXPECT_GT(whole.guides, 0.0);
  const Plan draft = plan_of(Stylize(), {"--quality", "draft"});
  EXPECT_EQ(draft.smaller, 2);
  EXPECT_EQ(draft.guides * 4, whole.guides);
  const Plan picked = plan_of(Stylize(), {"--budget-ms", "1e-6"});
  EXPECT_EQ(picked.guides * picked.smaller * picked.smaller, whole.guides);

  const Arguments lit = {"stylize", Scene("suzanne.glb"), "--style", "chiaroscuro", "--size", "128x72"};
  const Plan preview = plan_of(lit, {"--quality", "preview"});
  EXPECT_EQ(preview.smaller, 2);
  EXPECT_EQ(preview.guides * 4, plan_of(lit, {}).guides);
}

// Memory is checked before anything is painted on trial.
TEST_F(CliBudget, TrialsKeepToTheMemoryThatThereIs) {
  const CommandResult run = Run(With(Stylize(), {"--budget-ms", "60", "--max-memory", "1M", "-o", "p.png"}));
  EXPECT_EQ(run.code, 2) << run.err;
  EXPECT_NE(run.err.find("--max-memory allows 1.0 MiB"), std::string::npos) << run.err;
  EXPECT_TRUE(Kept().empty()) << "something was measured";
  EXPECT_FALSE(Exists("p.png"));
}

// A nanosecond is never enough: the fastest variant is taken, with a warning that gives its time, and no failure.
TEST_F(CliBudget, WhereNothingFitsTheQuickestIsTakenWithAWarning) {
  for (const Arguments& command : {Stylize(), Transfer()}) {
    const CommandResult result = RunOk(With(command, {"--budget-ms", "0.000001", "--json", "-o", "picked.png"}));
    const nlohmann::json budget = result.Json().at("budget");
    EXPECT_EQ(budget.at("fits"), false);
    EXPECT_NE(result.Warning().find("nothing fits"), std::string::npos) << result.err;
    EXPECT_NE(result.Warning().find("needs about"), std::string::npos) << result.err;
    RunOk(With(With(command, Options(budget)), {"-o", "again.png"}));
    EXPECT_EQ(Bytes("again.png"), Bytes("picked.png"));
  }
}

// The third run takes times that were kept. They may be those of a busy machine.
TEST_F(CliBudget, WhereNothingFitsByTimesThatWereKeptTheWarningNamesTheRemedy) {
  const auto warning = [&] { return RunOk(With(Transfer(), {"--budget-ms", "0.000001", "-o", "p.png"})).Warning(); };
  for (int run = 0; run < 2; ++run) EXPECT_FALSE(Contains(warning(), "--recalibrate")) << "measured now";
  EXPECT_TRUE(Contains(warning(), "--recalibrate measures them again"));
}

TEST_F(CliBudget, WhateverIsPickedIsRepeatedByTheOptionsThatAreNamed) {
  for (const Arguments& command : {Stylize(), Transfer()}) {
    for (const char* const ms : {"1", "4", "16", "64"}) {
      const nlohmann::json budget = Budget(command, ms);
      RunOk(With(With(command, Options(budget)), {"-o", "again.png"}));
      EXPECT_EQ(Bytes("again.png"), Bytes("picked.png")) << budget;
      EXPECT_LE(budget.at("predicted_ms").get<double>(), budget.at("fits") == true ? std::stod(ms) : 1e9);
    }
  }
}

// The light of ball.glb has extent, so it takes samples. suzanne's suns and points need none, and then no variant has
// fewer.
TEST_F(CliBudget, FewerSamplesWhereLightTakesThem) {
  const auto stylize = [&](const char* scene) {
    return Arguments{"stylize", Scene(scene), "--style", "chiaroscuro", "--size", "64x36"};
  };
  const auto variants_of = [&](const Arguments& command) {
    const std::string told = RunOk(With(command, {"--budget-ms", "3600000", "--recalibrate", "-o", "p.png"})).err;
    const std::string words = "measuring up to ";
    const std::size_t at = told.find(words);
    return at == std::string::npos ? 0 : std::stoi(told.substr(at + words.size()));
  };
  const int variants = variants_of(stylize("suzanne.glb"));
  EXPECT_GT(variants, 2);
  EXPECT_EQ(variants_of(stylize("ball.glb")), variants + 1) << "4 samples: pixels choose fewer than 16 already";
  EXPECT_EQ(variants_of(With(stylize("ball.glb"), {"--samples", "64"})), variants) << "the user has said how many";
  EXPECT_GT(Budget(stylize("ball.glb"), "3600000").at("measured_runs"), 0) << "--json has times of its own";
  EXPECT_EQ(Budget(stylize("ball.glb"), "3600000").at("measured_runs"), 0) << "the same variants as before";
  for (const char* const ms : {"0.000001", "8", "3600000"}) {
    const nlohmann::json picked = Budget(stylize("ball.glb"), ms);
    RunOk(With(With(stylize("ball.glb"), Options(picked)), {"-o", "again.png"}));
    EXPECT_EQ(Bytes("again.png"), Bytes("picked.png")) << picked;
  }
}

TEST_F(CliBudget, TimesAreKeptUntilTheyAreMeasuredAnew) {
  for (const Arguments& command : {Stylize(), Transfer()}) {
    const nlohmann::json first = Budget(command, "3600000");
    const std::size_t kept = Kept().size();
    EXPECT_GT(kept, 0u);
    const nlohmann::json second = Budget(command, "3600000");
    EXPECT_EQ(second.at("measured_runs"), 0);
    EXPECT_EQ(second.at("predicted_ms"), first.at("predicted_ms"));
    EXPECT_GT(Budget(command, "3600000", {"--recalibrate"}).at("measured_runs").get<int>(), 0);
    EXPECT_GT(Budget(command, "3600000", {"--set", "transfer.threshold=0.3"}).at("measured_runs").get<int>(), 0)
        << "another style has other times";
    EXPECT_EQ(Kept().size(), kept + 1);
  }
}

// Styles that the guides name are painted, too: when one of them changes, what was measured holds no longer.
TEST_F(CliBudget, StylesThatGuidesNameCount) {
  GuideSet guides = Ball(48);
  guides.object_names[1] = "Ball";
  guides.object_styles[1] = "other";
  WriteGuideFile("ball.exr", guides);
  WriteStyle("other");
  EXPECT_GT(Budget(Transfer(), "3600000").at("measured_runs").get<int>(), 0);
  EXPECT_EQ(Budget(Transfer(), "3600000").at("measured_runs"), 0);
  WriteText("other/style.toml", "[transfer]\nblend_radius = 9\n[[exemplar]]\nimage = \"lit.png\"\n");
  EXPECT_GT(Budget(Transfer(), "3600000").at("measured_runs").get<int>(), 0);
}

// Nor does it hold without the scene's styles, or for a scene of which a file was replaced.
TEST_F(CliBudget, WhatElseTheSceneIsMadeOfCounts) {
  WriteText("tri.obj", "mtllib tri.mtl\nusemtl m\n" + TriangleObj());
  WriteText("tri.mtl", "newmtl m\nKd 1 1 1\n");
  const Arguments stylize = {"stylize", "tri.obj", "--style", "style", "--size", "16"};
  EXPECT_GT(Budget(stylize, "3600000").at("measured_runs").get<int>(), 0);
  EXPECT_EQ(Budget(stylize, "3600000").at("measured_runs"), 0);
  EXPECT_GT(Budget(stylize, "3600000", {"--no-scene-styles"}).at("measured_runs").get<int>(), 0);
  WriteText("tri.mtl", "newmtl m\nKd 0.5 1 1\n");
  EXPECT_GT(Budget(stylize, "3600000").at("measured_runs").get<int>(), 0);
}

// A radius of 32 takes longer than none: a frame's times are those of its own values, and an edited key is another
// style.
TEST_F(CliBudget, KeysThatChangeOverTimeCount) {
  const auto write = [&](const std::string& radius) {
    WriteText("style/style.toml",
              "[transfer]\nblend_radius = [[0, 0], [100, " + radius + "]]\n[[exemplar]]\nimage = \"lit.png\"\n");
  };
  write("8");
  for (const char* const frame : {"0", "100"}) {
    EXPECT_GT(Budget(Transfer(), "3600000", {"--frame", frame}).at("measured_runs").get<int>(), 0) << frame;
    EXPECT_EQ(Budget(Transfer(), "3600000", {"--frame", frame}).at("measured_runs"), 0) << frame;
  }
  write("9");
  EXPECT_GT(Budget(Transfer(), "3600000", {"--frame", "0"}).at("measured_runs").get<int>(), 0);
}

TEST_F(CliBudget, MeasuringIsSaidOnce) {
  const std::string told = RunOk(With(Stylize(), {"--budget-ms", "3600000", "-o", "p.png"})).err;
  const std::size_t first = told.find("measuring up to");
  EXPECT_NE(first, std::string::npos) << told;
  EXPECT_EQ(told.find("measuring up to", first + 1), std::string::npos) << told;
}

// What lies underneath is part of the work, so trials read it: of a sequence the first frame's.
TEST_F(CliBudget, TrialsPaintOverWhatLiesUnderneath) {
  WritePainted("under.0007.png", 48, 48);
  for (const char* const name : {"ball.0007.exr", "ball.0008.exr"}) WriteGuideFile(name, Ball(48));
  const Arguments range = {"transfer",    "ball.####.exr", "--style", "style",          "--frames", "7-8",
                           "--budget-ms", "3600000",       "--over",  "under.####.png", "-o",       "p.####.png"};
  const CommandResult missing = Run(range);
  EXPECT_EQ(missing.code, 3);
  EXPECT_NE(missing.err.find("under.0008.png"), std::string::npos) << missing.err;
  EXPECT_TRUE(Exists("p.0007.png")) << "the first was found and painted over";
  ExpectError(
      {"transfer", "ball.exr", "--style", "style", "--budget-ms", "3600000", "--over", "none.png", "-o", "q.png"}, 3,
      {"none.png"});
  RunOk({"transfer", "ball.exr", "--style", "style", "--budget-ms", "3600000", "--over", "under.0007.png", "-o",
         "q.png"});
  RunOk({"transfer", "ball.exr", "--style", "style", "--over", "under.0007.png", "-o", "r.png"});
  EXPECT_EQ(Bytes("q.png"), Bytes("r.png"));
}

TEST_F(CliBudget, ABrokenCacheIsMeasuredAgain) {
  Budget(Transfer(), "3600000");
  ASSERT_EQ(Kept().size(), 1u);
  std::ofstream(Kept().front(), std::ios::binary) << "scumble table 1\nnot at all";
  EXPECT_GT(Budget(Transfer(), "3600000").at("measured_runs").get<int>(), 0);
  EXPECT_EQ(Budget(Transfer(), "3600000").at("measured_runs"), 0) << "and is whole again";
}

TEST_F(CliBudget, ACacheThatCannotBeWrittenDoesNoHarm) {
  WriteText("file", "in the way");
  ::setenv("XDG_CACHE_HOME", At("file").c_str(), 1);
  for (int run = 0; run < 2; ++run) {
    EXPECT_GT(Budget(Transfer(), "3600000").at("measured_runs").get<int>(), 0);
    EXPECT_EQ(Bytes("file"), "in the way");
  }
}

TEST_F(CliBudget, TwoAtOnceAreBothServed) {
  CommandSettings other;
  other.stdout_file = At("other.json").string();
  const pid_t one = Start(With(Stylize(), {"--budget-ms", "50", "--json", "-o", "one.png"}), other);
  const nlohmann::json budget = Budget(Stylize(), "50");
  EXPECT_EQ(Finish(one, other).code, 0);
  EXPECT_FALSE(budget.is_null());
  EXPECT_FALSE(nlohmann::json::parse(Bytes("other.json"), nullptr, false).is_discarded());
}

// All frames use the variant that suits the first, also those that are made later.
TEST_F(CliBudget, ASequenceHasOneWay) {
  const Arguments stylize = With(Stylize(), {"--frames", "1-3"});
  const CommandResult result = RunOk(With(stylize, {"--budget-ms", "0.000001", "--json", "-o", "p.#.png"}));
  const nlohmann::json budget = result.Json().at("budget");
  RunOk(With(With(stylize, Options(budget)), {"-o", "o.#.png"}));
  for (const char* const frame : {"1", "2", "3"}) {
    EXPECT_EQ(Bytes(std::string("p.") + frame + ".png"), Bytes(std::string("o.") + frame + ".png"));
  }
  std::filesystem::remove(At("p.2.png"));
  const auto made = std::filesystem::last_write_time(At("p.1.png"));
  RunOk(With(With(stylize, Options(budget)), {"--resume", "-o", "p.#.png"}));
  EXPECT_EQ(std::filesystem::last_write_time(At("p.1.png")), made);
  EXPECT_EQ(Bytes("p.2.png"), Bytes("o.2.png"));
  for (const char* const frame : {"g.1.exr", "g.2.exr"}) WriteGuideFile(frame, Ball(32));
  const nlohmann::json of_files = RunOk({"transfer", "g.#.exr", "--style", "style", "--frames", "1-2", "--budget-ms",
                                         "3600000", "--json", "-o", "t.#.png"})
                                      .Json()
                                      .at("budget");
  EXPECT_EQ(of_files.at("picked"), "the style");
}

// A scene that moves, whose camera frames it as it stands at time 0: measured at its first frame, painted as without a
// budget.
TEST_F(CliBudget, AMovingSceneIsPaintedAsWithoutABudget) {
  const Arguments stylize = {"stylize", Scene("toys.glb"), "--style", "style",    "--size",
                             "96x54",   "--view",          "20,30",   "--frames", "30-31"};
  const CommandResult within = RunOk(With(stylize, {"--budget-ms", "3600000", "--json", "-o", "p.#.png"}));
  EXPECT_EQ(within.Json().at("budget").at("picked"), "the style");
  RunOk(With(stylize, {"-o", "o.#.png"}));
  for (const char* const frame : {"30", "31"}) {
    EXPECT_EQ(Bytes(std::string("p.") + frame + ".png"), Bytes(std::string("o.") + frame + ".png"));
  }
}

TEST_F(CliBudget, GuidesThatCannotBeReadAreToldOfAsEver) {
  ExpectError({"transfer", "no.exr", "--style", "style", "--budget-ms", "50", "-o", "out.png"}, 3, {"no.exr"});
  ExpectError({"stylize", "no.glb", "--style", "style", "--budget-ms", "50", "-o", "out.png"}, 3, {"no.glb"});
  EXPECT_FALSE(Exists("out.png"));
}

}  // namespace
}  // namespace scumble
