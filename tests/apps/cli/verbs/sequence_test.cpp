// Sequences on the command line: ranges with any cuts, names, gaps, and resuming a stopped run.
#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/io/existing_output.h"
#include "tests/support/cli_harness.h"
#include "tests/support/guide_files.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

class CliSequence : public CliTest {
 protected:
  // Everything in it moves: the pattern from frame to frame, the threshold as keyed (nothing is prepared anew), the
  // scale too (everything is).
  void WriteMovingStyle(const std::string& folder) {
    WritePainted(folder + "/lit.png", 64, 64);
    WriteText(folder + "/style.toml",
              "[transfer]\nreference_height = 0\nlevels = 4\njitter_fps = -1\nthreshold = [[1, 0.05], [6, 0.4]]\n"
              "scale = [[3, 1.0], [5, 0.7]]\n[[exemplar]]\nimage = \"lit.png\"\n");
  }
  // Two exemplars, so that light and its exposure matter.
  void WriteLitStyle(const std::string& folder) {
    WritePainted(folder + "/lit.png", 64, 64);
    WriteText(folder + "/style.toml",
              "[transfer]\nreference_height = 0\nlevels = 4\n[[exemplar]]\nimage = \"lit.png\"\nluminance = 0.8\n"
              "[[exemplar]]\nimage = \"lit.png\"\nluminance = 0.1\n");
  }
  // The sphere, brighter in later frames.
  void WriteLitBall(const std::string& name, float light) {
    GuideSet guides = Ball(32);
    guides.Add(Layer::kLuminance);
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      guides.Plane(Layer::kLuminance)[i] = light * std::max(0.0f, guides.Plane(Layer::kNormal, 0)[i]);
    }
    WriteGuideFile(name, guides);
  }
  std::vector<std::string> AllBytes(const std::string& start, int first, int last) {
    std::vector<std::string> all;
    for (int frame = first; frame <= last; ++frame) {
      const std::string number = std::to_string(frame);
      all.push_back(Bytes(start + std::string(4 - number.size(), '0') + number + ".png"));
      EXPECT_NE(all.back(), "") << start << frame;
    }
    return all;
  }
  static std::string Frame(const std::string& start, int frame) {
    return start + "000" + std::to_string(frame) + ".png";
  }
};

TEST_F(CliSequence, TheSameBytesHoweverARangeIsCut) {
  WriteMovingStyle("style");
  const Arguments stylize = {"stylize", Scene("stilllife.glb"), "--style", "style", "--size", "96x54"};
  RunOk(With(stylize, {"--frames", "1-6", "-o", "once.####.png"}));
  const auto once = AllBytes("once.", 1, 6);
  for (std::size_t i = 1; i < once.size(); ++i) EXPECT_NE(once[i], once[i - 1]) << "frame " << i + 1 << " stands still";

  RunOk(With(stylize, {"--frames", "1-3", "-o", "cut.####.png", "--threads", "1"}));
  RunOk(With(stylize, {"--frames", "4-6", "-o", "cut.%04d.png", "--threads", "3"}));
  EXPECT_EQ(AllBytes("cut.", 1, 6), once);
  RunOk(With(stylize, {"--frames", "6-1", "-o", "back.####.png"}));
  EXPECT_EQ(AllBytes("back.", 1, 6), once);
  RunOk(With(stylize, {"--frames", "5,1-6x2,2-6x2", "-o", "mixed.####.png"}));
  EXPECT_EQ(AllBytes("mixed.", 1, 6), once);
  for (int frame = 1; frame <= 6; ++frame) {
    RunOk(With(stylize, {"--frame", std::to_string(frame), "-o", "one.####.png"}));
  }
  EXPECT_EQ(AllBytes("one.", 1, 6), once);

  RunOk({"guidegen", Scene("stilllife.glb"), "--style", "style", "--size", "96x54", "--frames", "1-6", "-o",
         "g.####.exr"});
  const Arguments transfer = {"transfer", "g.####.exr", "--style", "style"};
  RunOk(With(transfer, {"--frames", "1-6", "-o", "two.####.png"}));
  EXPECT_EQ(AllBytes("two.", 1, 6), once);
  RunOk(With(transfer, {"--frame", "4", "-o", "single.png"}));
  EXPECT_EQ(Bytes("single.png"), once[3]);
  RunOk({"transfer", "g.0001.exr", "--style", "style", "--frames", "1-6", "-o", "still.####.png"});
  EXPECT_EQ(AllBytes("still.", 1, 6), once) << "one guide file for all frames";
}

TEST_F(CliSequence, TwelveRenewalsASecondAtTwentyFourFrames) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(64));
  RunOk({"transfer", "g.exr", "--style", "style", "--set", "transfer.jitter_fps=12", "--fps", "24", "--frames", "-2-5",
         "-o", "p.%d.png"});
  for (int frame = -2; frame < 5; ++frame) {
    const std::string here = Bytes("p." + std::to_string(frame) + ".png");
    const std::string next = Bytes("p." + std::to_string(frame + 1) + ".png");
    ASSERT_NE(here, "");
    EXPECT_EQ(here == next, frame % 2 == 0) << frame;
  }
}

TEST_F(CliSequence, ResumeRepairsAndLeavesTheRest) {
  WriteMovingStyle("style");
  const Arguments stylize = {
      "stylize", Scene("stilllife.glb"), "--style", "style", "--size", "96x54", "--frames", "1-6", "-o", "p.####.png"};
  RunOk(stylize);
  const auto whole = AllBytes("p.", 1, 6);
  WriteText(Frame("p.", 2), "");                                                   // a placeholder of a killed job
  fs::resize_file(At(Frame("p.", 3)), fs::file_size(At(Frame("p.", 3))) * 2 / 3);  // a full disk
  fs::remove(At(Frame("p.", 4)));
  WritePainted(Frame("p.", 5), 96, 55);
  std::map<int, fs::file_time_type> written;
  for (const int frame : {1, 2, 3, 5, 6}) {
    fs::last_write_time(At(Frame("p.", frame)), fs::file_time_type::clock::now() - std::chrono::hours(1));
    written[frame] = fs::last_write_time(At(Frame("p.", frame)));
  }
  const CommandResult again = RunOk(With(stylize, {"--resume"}));
  EXPECT_TRUE(Contains(again.out, "6 frames: 4 made, 2 kept;")) << again.out;
  EXPECT_TRUE(Contains(again.out, "p.0001.png  kept")) << again.out;
  EXPECT_EQ(AllBytes("p.", 1, 6), whole);
  for (const auto& [frame, time] : written) {
    const bool kept = frame == 1 || frame == 6;
    EXPECT_EQ(fs::last_write_time(At(Frame("p.", frame))) == time, kept) << frame;
  }
  const CommandResult nothing = RunOk(With(stylize, {"--resume", "--json"}));
  EXPECT_EQ(nothing.Json()["made"], 0);
  EXPECT_EQ(nothing.Json()["kept"], 6);
  EXPECT_EQ(nothing.Json()["frames"][2]["state"], "kept");
  // Without --resume all are made.
  EXPECT_TRUE(Contains(RunOk(stylize).out, "6 frames: 6 made;"));
}

// Frames of another exposure are other pictures, whichever of the two was measured; stops that were printed go on with
// it.
TEST_F(CliSequence, ResumeComparesTheExposure) {
  WriteLitStyle("style");
  for (const char* const name : {"g.1.exr", "g.2.exr"}) WriteLitBall(name, 0.2f);
  double stops = 0.0;
  const auto kept = [&](const std::string& exposure) {
    const nlohmann::json report = RunOk({"transfer", "g.#.exr", "--style", "style", "--frames", "1-2", "-o", "p#.png",
                                         "--exposure", exposure, "--json", "--resume"})
                                      .Json();
    if (report["frames"][0].contains("exposure")) stops = report["frames"][0]["exposure"];
    return report["kept"];
  };
  EXPECT_EQ(kept("auto"), 0);
  EXPECT_EQ(kept("auto"), 2);
  char measured[32];
  std::snprintf(measured, sizeof measured, "%.2f", stops);
  EXPECT_EQ(kept(measured), 2);
  EXPECT_EQ(kept("5"), 0);
  EXPECT_EQ(kept("5"), 2);
  EXPECT_EQ(kept("auto"), 0) << "measured it would be another";
  EXPECT_EQ(kept("auto"), 2);
}

// A picture of guides that are seen, lit or cast otherwise is another picture.
TEST_F(CliSequence, ResumeComparesHowTheGuidesWereMade) {
  WriteStyle("style");
  const Arguments size = {"--size", "32", "--frames", "1-2"};
  const Arguments stylize = With({"stylize", Scene("stilllife.glb"), "--style", "style", "-o", "p#.png"}, size);
  const auto kept = [&](const Arguments& run, const Arguments& more) {
    return RunOk(With(With(run, {"--resume", "--json"}), more)).Json()["kept"].get<int>();
  };
  EXPECT_EQ(kept(stylize, {}), 0);
  EXPECT_EQ(kept(stylize, {}), 2);
  for (const Arguments& other : {Arguments{"--view", "80,5"},
                                 {"--light", "90,0"},
                                 {"--aa", "2"},
                                 {"--raw-normals"},
                                 {"--normal-frame", "eye"},
                                 {"--no-robust"},
                                 {"--max-bounces", "1"}}) {
    EXPECT_EQ(kept(stylize, other), 0) << other[0];
    EXPECT_EQ(kept(stylize, other), 2) << other[0];
  }
  const Arguments guidegen = With({"guidegen", Scene("stilllife.glb"), "--style", "style", "-o", "g#.exr"}, size);
  const Arguments transfer = {"transfer", "g#.exr", "--style", "style", "--frames", "1-2", "-o", "t#.png"};
  RunOk(guidegen);
  EXPECT_EQ(kept(transfer, {}), 0);
  RunOk(With(guidegen, {"--seed", "3", "--samples", "4"}));
  EXPECT_EQ(kept(transfer, {}), 2) << "the style does not look at light";
  RunOk(With(guidegen, {"--view", "80,5"}));
  EXPECT_EQ(kept(transfer, {}), 0);
  RunOk(With(stylize, {"--view", "80,5"}));
  EXPECT_EQ(Bytes("p2.png"), Bytes("t2.png"));
  EXPECT_EQ(kept({"transfer", "g#.exr", "--style", "style", "--frames", "1-2", "-o", "p#.png"}, {}), 2)
      << "stylize and transfer go on with each other's frames";
  for (const char* const name : {"g1.exr", "g2.exr"}) fs::remove(At(name));
  EXPECT_EQ(kept(transfer, {}), 2) << "what is gone is not compared";
}

TEST_F(CliSequence, ResumeComparesTheViewLayer) {
  WriteStyle("style");
  WriteViewLayers(At("g.exr"), Ball(24), {"Front", "Back"});
  const auto kept = [&](const std::string& view_layer) {
    return RunOk({"transfer", "g.exr", "--style", "style", "--frames", "1-2", "-o", "p#.png", "--resume", "--json",
                  "--view-layer", view_layer})
        .Json()["kept"]
        .get<int>();
  };
  EXPECT_EQ(kept("Front"), 0);
  EXPECT_EQ(kept("Front"), 2);
  EXPECT_EQ(kept("Back"), 0);
  EXPECT_EQ(kept("Back"), 2);
}

TEST_F(CliSequence, ResumeFinishesARepaintedPictureAgain) {
  for (const char* const name : {"p1.png", "p2.png"}) WritePainted(name, 32, 32);
  const Arguments finish = {"finish", "p#.png", "--finish", "grade",    "--frames",
                            "1-2",    "-o",     "f#.png",   "--resume", "--json"};
  EXPECT_EQ(RunOk(finish).Json()["kept"], 0);
  EXPECT_EQ(RunOk(finish).Json()["kept"], 2);
  ASSERT_TRUE(WritePicture(At("p2.png"), Picture(32, 32)));
  const nlohmann::json report = RunOk(finish).Json();
  EXPECT_EQ(report["kept"], 1);
  EXPECT_EQ(report["frames"][1]["state"], "made");
  EXPECT_EQ(RunOk(finish).Json()["kept"], 2);
}

// Pictures of older versions lack some settings. Settings with a known old value count as that value, unknown ones
// agree with any, and all others that one side lacks count as a difference.
TEST_F(CliSequence, ResumeTakesForGrantedWhatOlderPicturesDoNotTell) {
  const auto agrees = [&](const std::string& found, const std::string& wanted) {
    PictureWriteOptions options;
    options.settings = "scumble 0.1; " + found;
    EXPECT_TRUE(WritePicture(At("p.png"), Painted(8, 8), options));
    return CheckWholePicture(At("p.png"), {8, 8, 4, 8, "scumble 0.1; " + wanted}).ok();
  };
  for (const std::string made : {"seed 0", "seed 0; upsample 1", "seed 0; fps 24; measured 1"}) {
    for (const std::string wanted : {"seed 0", "seed 0; upsample 1; fps 24; measured 1"})
      EXPECT_TRUE(agrees(made, wanted)) << made;
    EXPECT_FALSE(agrees(made, "seed 0; upsample 2")) << made;
    EXPECT_FALSE(agrees(made, "seed 1; upsample 1")) << made;
    EXPECT_FALSE(agrees(made, "seed 0; show chunks")) << made;
  }
  EXPECT_TRUE(agrees("seed 0; upsample 2", "seed 0; upsample 2; measured 0"));
  EXPECT_FALSE(agrees("seed 0; upsample 2", "seed 0"));
  EXPECT_FALSE(agrees("seed 0; fps 12", "seed 0; fps 24"));
  EXPECT_FALSE(agrees("seed 0; show chunks", "seed 0"));
  EXPECT_TRUE(agrees("seed 0", "seed ?"));
}

TEST_F(CliSequence, ResumeKnowsEveryKindOfOutput) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(48));
  for (const std::string ending : {".png", ".tif", ".exr", ".jpg"}) {
    const Arguments transfer = {"transfer", "g.exr", "--style", "style", "--frames", "1-2", "-o", "p#" + ending};
    RunOk(transfer);
    EXPECT_TRUE(Contains(RunOk(With(transfer, {"--resume"})).out, "0 made, 2 kept;")) << ending;
    const std::string whole = Bytes("p2" + ending);
    fs::resize_file(At("p2" + ending), whole.size() * 3 / 4);
    EXPECT_TRUE(Contains(RunOk(With(transfer, {"--resume"})).out, "1 made, 1 kept;")) << ending;
    EXPECT_EQ(Bytes("p2" + ending), whole) << ending;
  }
  WritePicture(At("opaque.jpg"), Painted(48, 48)).ok();
  fs::copy_file(At("p1.jpg"), At("p1.png"), fs::copy_options::overwrite_existing);
  const Arguments pngs = {"transfer", "g.exr", "--style", "style", "--frames", "1-2", "-o", "p#.png", "--resume"};
  EXPECT_TRUE(Contains(RunOk(pngs).out, "1 made, 1 kept;")) << "three channels are not four";

  const Arguments guidegen = {"guidegen", Scene("stilllife.glb"), "--size", "32", "--frames", "1-3", "-o", "g#.exr"};
  RunOk(guidegen);
  const std::string whole = Bytes("g2.exr");
  fs::resize_file(At("g2.exr"), whole.size() / 2);
  EXPECT_TRUE(Contains(RunOk(With(guidegen, {"--resume"})).out, "1 made, 2 kept;"));
  EXPECT_EQ(Bytes("g2.exr"), whole);
  for (const Arguments& other :
       {Arguments{"--samples", "4"}, {"--max-bounces", "1"}, {"--raw-normals"}, {"--no-robust"}, {"--cryptomatte"}}) {
    EXPECT_TRUE(Contains(RunOk(With(With(guidegen, {"--resume"}), other)).out, "3 made, 0 kept;")) << other[0];
    EXPECT_TRUE(Contains(RunOk(With(With(guidegen, {"--resume"}), other)).out, "0 made, 3 kept;")) << other[0];
  }
  EXPECT_TRUE(Contains(RunOk(With(guidegen, {"--resume", "--layers", "position"})).out, "3 made, 0 kept;"))
      << "other layers are asked for now";
}

TEST_F(CliSequence, HolesAreNamedAndTheOthersMade) {
  WriteStyle("style");
  for (const int frame : {1, 2, 4, 6}) WriteGuideFile("g.000" + std::to_string(frame) + ".exr", Ball(32));
  WriteText("g.0006.exr", "no picture");
  const Arguments transfer = {"transfer", "g.####.exr", "--style", "style", "--frames", "1-7", "-o", "p.####.png"};
  const CommandResult result = Run(transfer);
  EXPECT_EQ(result.code, 3) << result.err;
  for (const char* words : {"4 of 7 frames were not made: 3,5-7", "g.0003.exr"}) {
    EXPECT_TRUE(Contains(result.Error(), words)) << result.Error();
  }
  EXPECT_TRUE(Contains(result.err, "frame 6: ")) << result.err;
  EXPECT_TRUE(Contains(result.out, "7 frames: 3 made, 4 not made;")) << result.out;
  for (int frame = 1; frame <= 7; ++frame) {
    EXPECT_EQ(Exists(Frame("p.", frame)), frame == 1 || frame == 2 || frame == 4) << frame;
  }
  const CommandResult json = Run(With(transfer, {"--json", "--resume"}));
  EXPECT_EQ(json.code, 3);
  EXPECT_EQ(json.Json()["kept"], 3);
  EXPECT_EQ(json.Json()["failed"], 4);
  ASSERT_EQ(json.Json()["frames"].size(), 7u);
  EXPECT_EQ(json.Json()["frames"][0]["frame"].is_number(), true);
  int failed = 0;
  const nlohmann::json report = json.Json();
  for (const auto& frame : report["frames"]) {
    if (frame["state"] != "failed") continue;
    ++failed;
    EXPECT_TRUE(Contains(frame["error"], "g.000" + std::to_string(frame["frame"].get<int>()))) << frame;
  }
  EXPECT_EQ(failed, 4);
}

// Whoever started it sees which frames there are, and at which one it ended.
TEST_F(CliSequence, AFaultThatEndsItTellsOfTheFramesUntilThen) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(32));
  std::filesystem::create_symlink("/dev/full", At("p2.png"));
  const CommandResult ended =
      Run({"transfer", "g.exr", "--style", "style", "--frames", "1-3", "-o", "p#.png", "--json"});
  EXPECT_EQ(ended.code, 4) << ended.err;
  const nlohmann::json report = ended.Json();
  EXPECT_EQ(report["made"], 1);
  EXPECT_EQ(report["failed"], 1);
  ASSERT_EQ(report["frames"].size(), 2u);
  EXPECT_EQ(report["frames"][0]["output"], "p1.png");
  EXPECT_EQ(report["frames"][1]["state"], "failed");
  EXPECT_TRUE(Contains(report["frames"][1]["error"], "p2.png")) << report;
}

TEST_F(CliSequence, AnErrorThatWouldComeAgainEndsIt) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(32));
  fs::create_symlink("/dev/full", At("p2.png"));
  const CommandResult result = Run({"transfer", "g.exr", "--style", "style", "--frames", "1-3", "-o", "p#.png"});
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_TRUE(Contains(result.Error(), "frame 2: ")) << result.err;
  EXPECT_TRUE(Exists("p1.png"));
  EXPECT_FALSE(Exists("p3.png"));
  ExpectError({"stylize", "lost.glb", "--style", "style", "--frames", "1-3", "-o", "q#.png"}, 3, {"lost.glb"});
}

TEST_F(CliSequence, NamesAndOptionsThatMakeNoSense) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(32));
  const Arguments transfer = {"transfer", "g.exr", "--style", "style"};
  ExpectError(With(transfer, {"--frames", "1-3", "-o", "p.png"}), 2, {"p.png is one file for 3 frames", "p.####.png"});
  ExpectError(With(transfer, {"--frames", "1-3x0", "-o", "p#.png"}), 2, {"--frames 1-3x0", "step of 0"});
  ExpectError(With(transfer, {"--frames", "1-3", "--frame", "2", "-o", "p#.png"}), 2, {"--frame and --frames"});
  ExpectError(With(transfer, {"--resume", "-o", "p.png"}), 2, {"--resume goes with --frames"});
  ExpectError(With(transfer, {"-o", "p.####.png"}), 2, {"p.####.png", "--frames 1-24", "--frame 7"});
  ExpectError(With(transfer, {"-o", "p.%04d.png"}), 2, {"p.%04d.png", "--frames 1-24"});
  ExpectError(With(transfer, {"--frames", "1", "-o", "p.####.%d.png"}), 2, {"two places"});
  ExpectError({"transfer", "g.####.exr", "--style", "style", "-o", "p.png"}, 2, {"g.####.exr", "--frames"});
  ExpectError({"guidegen", Scene("stilllife.glb"), "--frames", "1-2", "-o", "g.exr"}, 2, {"g.####.exr"});
  RunOk(With(transfer, {"-o", "take#2.png"}));
  EXPECT_TRUE(Exists("take#2.png")) << "one # may be a plain name";
  RunOk(With(transfer, {"--frames", "7", "-o", "p.png"}));
  EXPECT_TRUE(Exists("p.png"));
  RunOk(With(transfer, {"--frames", "-5--4", "-o", "n.####.png"}));
  EXPECT_TRUE(Exists("n.-0005.png"));
  EXPECT_TRUE(Exists("n.-0004.png"));
}

TEST_F(CliSequence, PicturesUnderneathMayBeASequenceToo) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(32));
  WritePainted("under.1.png", 32, 32);
  ASSERT_TRUE(WritePicture(At("under.2.png"), Picture(32, 32)));
  const Arguments transfer = {"transfer", "g.exr", "--style", "style"};
  RunOk(With(transfer, {"--over", "under.#.png", "--frames", "1-2", "-o", "p#.png"}));
  for (const std::string frame : {"1", "2"}) {
    RunOk(With(transfer, {"--over", "under." + frame + ".png", "--frame", frame, "-o", "one.png"}));
    EXPECT_EQ(Bytes("one.png"), Bytes("p" + frame + ".png"));
  }
  EXPECT_FALSE(Pixels("p1.png") == Pixels("p2.png"));
}

TEST_F(CliSequence, OneExposureForAllFrames) {
  WriteLitStyle("style");
  for (int frame = 1; frame <= 3; ++frame) WriteLitBall("g.000" + std::to_string(frame) + ".exr", 0.1f * frame);
  const Arguments transfer = {"transfer", "g.####.exr", "--style", "style", "-o", "p.####.png"};
  const CommandResult all = RunOk(With(transfer, {"--frames", "1-3", "--json"}));
  const auto whole = AllBytes("p.", 1, 3);
  const std::string third = Pixels("p.0003.png");
  const double stops = all.Json()["frames"][0]["exposure"];
  EXPECT_EQ(all.Json()["frames"][2]["exposure"], stops);
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", stops);
  EXPECT_TRUE(Contains(all.Warning(), "measured on frame 1")) << all.err;
  EXPECT_TRUE(Contains(all.Warning(), std::string("--exposure ") + text)) << all.err;
  // The printed stops reproduce it, for any range. The file records that they were given.
  const std::string second = Pixels("p.0002.png");
  const CommandResult part = RunOk(With(transfer, {"--frames", "2-3", "--exposure", text}));
  EXPECT_EQ(part.Warning(), "");
  EXPECT_TRUE(Pixels("p.0002.png") == second && Pixels("p.0003.png") == third);
  const std::string given = Bytes("p.0003.png");
  RunOk(With(transfer, {"--frame", "3", "--exposure", text}));
  EXPECT_TRUE(Bytes("p.0003.png") == given);
  // A frame that is kept is still the one to measure on.
  fs::remove(At("p.0003.png"));
  RunOk(With(transfer, {"--frames", "1-3", "--resume"}));
  EXPECT_EQ(AllBytes("p.", 1, 3), whole);
  // Measured by itself it would be another picture: the test above could fail.
  RunOk(With(transfer, {"--frame", "3"}));
  EXPECT_FALSE(Pixels("p.0003.png") == third);
  fs::remove(At("g.0001.exr"));
  ExpectError(With(transfer, {"--frames", "1-3"}), 3, {"g.0001.exr", "frame 1", "--exposure STOPS"});
  const CommandResult failed = Run(With(transfer, {"--frames", "1-3", "--json"}));
  EXPECT_EQ(failed.code, 3);
  EXPECT_EQ(failed.Json()["failed"], 1);
  ASSERT_EQ(failed.Json()["frames"].size(), 1u) << failed.out;
  EXPECT_EQ(failed.Json()["frames"][0]["frame"], 1);
  EXPECT_EQ(failed.Json()["frames"][0]["state"], "failed");
  EXPECT_TRUE(Contains(failed.Json()["frames"][0]["error"], "all frames are painted by what frame 1 shows"));
  // A frame that is kept has not failed.
  fs::remove(At("p.0003.png"));
  const nlohmann::json resumed = Run(With(transfer, {"--frames", "1,3", "--resume", "--json"})).Json();
  ASSERT_EQ(resumed["frames"].size(), 2u) << resumed;
  EXPECT_EQ(resumed["frames"][0]["state"], "kept");
  EXPECT_EQ(resumed["frames"][1]["frame"], 3);
  EXPECT_EQ(resumed["frames"][1]["state"], "failed");
  EXPECT_TRUE(Contains(resumed["frames"][1]["error"], "g.0001.exr"));
  // Stops are no remedy for guides without the layer, nor for a limit of memory.
  WriteGuideFile("g.0001.exr", Ball(32));
  const CommandResult lacks = ExpectError(With(transfer, {"--frames", "1-3"}), 3, {"has no layer luminance"});
  EXPECT_FALSE(Contains(lacks.err, "STOPS")) << lacks.err;
  WriteLitBall("g.0001.exr", 0.1f);
  const CommandResult large = ExpectError(With(transfer, {"--frames", "1-3", "--max-memory", "1M"}), 2, {"of memory"});
  EXPECT_FALSE(Contains(large.err, "STOPS") || Contains(large.err, "all frames are painted")) << large.err;
  // In memory it is the same.
  const Arguments stylize = {"stylize", Scene("stilllife.glb"), "--style", "style", "--size", "48", "--frames", "1-2"};
  const CommandResult memory = RunOk(With(stylize, {"-o", "s#.png"}));
  EXPECT_TRUE(Contains(memory.Warning(), "measured on frame 1")) << memory.err;
  EXPECT_EQ(RunOk({"stylize", Scene("stilllife.glb"), "--style", "style", "--size", "48", "-o", "s.png"}).Warning(),
            "");
}

TEST_F(CliSequence, EachFrameIsReported) {
  WriteStyle("style");
  const Arguments stylize = {
      "stylize", Scene("stilllife.glb"), "--style", "style", "--size", "32", "--frames", "8,3-4", "-o", "p.##.png"};
  const CommandResult text = RunOk(stylize);
  const std::size_t eight = text.out.find("p.08.png"), three = text.out.find("p.03.png"),
                    four = text.out.find("p.04.png");
  EXPECT_LT(eight, three);
  EXPECT_LT(three, four);
  EXPECT_TRUE(Contains(text.out.substr(four), "\n3 frames: 3 made;")) << text.out;
  const nlohmann::json json = RunOk(With(stylize, {"--json", "--explain"})).Json();
  ASSERT_EQ(json["frames"].size(), 3u);
  EXPECT_EQ(json["frames"][0]["frame"], 8);
  EXPECT_EQ(json["frames"][0]["output"], "p.08.png");
  EXPECT_EQ(json["frames"][0]["state"], "made");
  EXPECT_TRUE(json["frames"][0].contains("plan")) << "the plan is told once";
  EXPECT_FALSE(json["frames"][1].contains("plan"));
  EXPECT_TRUE(json["frames"][0]["ms"].contains("load"));
  EXPECT_FALSE(json["frames"][1]["ms"].contains("load")) << "the scene is loaded once";
  EXPECT_TRUE(json["frames"][2]["ms"].contains("match"));
  EXPECT_EQ(json["made"], 3);
  EXPECT_GT(json["total_ms"], 0.0);
  const nlohmann::json guides =
      RunOk({"guidegen", Scene("stilllife.glb"), "--size", "32", "--frames", "1-2", "-o", "g#.exr", "--json"}).Json();
  EXPECT_EQ(guides["frames"][1]["output"], "g2.exr");
  EXPECT_EQ(guides["frames"][1]["width"], 32);
  EXPECT_EQ(Bytes("g1.exr"), Bytes("g2.exr")) << "a scene that stands still";
}

}  // namespace
}  // namespace scumble
