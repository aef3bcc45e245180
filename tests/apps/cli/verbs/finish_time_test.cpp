// Finishing effects over time: sequences, what is resumed, keys that move, lines that are redrawn.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/apps/cli/verbs/finish_harness.h"
#include "tests/support/cli_harness.h"
#include "tests/support/gltf_builder.h"

namespace scumble {
namespace {

class CliFinishInTime : public CliFinish {};

TEST_F(CliFinishInTime, SequencesAreOfOneMeasureAndResume) {
  WriteStyle("plain");
  RunOk(
      {"stylize", kToys, "--frames", "1-3", "--size", "64x48", "--style", "plain", "-o", "p.####.png", "--bits", "16"});
  RunOk({"guidegen", kToys, "--frames", "1-3", "--size", "64x48", "--layers", "luminance,shadow", "-o", "g.####.exr"});
  RunOk({"finish", "p.####.png", "g.####.exr", "--frames", "1-3", "--finish", "storybook", "-o", "f.####.png"});
  RunOk({"finish", "p.0002.png", "g.0002.exr", "--finish", "storybook", "-o", "one.png"});
  EXPECT_NE(Read("one.png").rgba, Read("f.0002.png").rgba) << "alone it is measured on itself";
  const auto before = Read("f.0003.png").rgba;
  std::filesystem::remove(At("f.0003.png"));
  RunOk({"finish", "p.####.png", "--frames", "1-3", "--finish", "shadows", "--set", "finish.shadows.strength=0", "-o",
         "same.####.png", "--bits", "16"});
  EXPECT_EQ(Read("same.0003.png").rgba, Read("p.0003.png").rgba) << "what changes nothing reads nothing";
  const CommandResult again = RunOk({"finish", "p.####.png", "g.####.exr", "--frames", "1-3", "--finish", "storybook",
                                     "-o", "f.####.png", "--resume", "--json"});
  EXPECT_TRUE(Contains(again.out, "\"kept\": 2")) << again.out;
  EXPECT_EQ(Read("f.0003.png").rgba, before);
  const CommandResult other = RunOk({"finish", "p.####.png", "g.####.exr", "--frames", "1-3", "--finish", "storybook",
                                     "--set", "finish.ink.width=5", "-o", "f.####.png", "--resume", "--json"});
  EXPECT_TRUE(Contains(other.out, "\"kept\": 0")) << other.out;
}

// What was measured can be given, so that frames of several runs agree.
TEST_F(CliFinishInTime, MeasuresCanBeGiven) {
  WriteStyle("plain");
  const auto paint = [&](const Arguments& more) {
    Arguments arguments{"stylize", kToys,      "--size",    "64x48", "--style",
                        "plain",   "--finish", "storybook", "-o",    "m.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunOk(arguments);
  };
  const std::string told = paint({"--frame", "1"}).err;
  const std::string option = "--finish-measures ";
  const std::size_t at = told.find(option);
  ASSERT_NE(at, std::string::npos) << told;
  const std::size_t begin = at + option.size();
  const std::string measures = told.substr(begin, told.find(' ', begin) - begin);
  const auto first = Read("m.png").rgba;
  EXPECT_FALSE(Contains(paint({"--frame", "1", "--finish-measures", measures}).err, option));
  EXPECT_EQ(Read("m.png").rgba, first);
  paint({"--frame", "1", "--finish-measures", "1,2,30,1,1"});
  EXPECT_NE(Read("m.png").rgba, first);
  ExpectError({"stylize", kToys, "--style", "plain", "--finish-measures", "1,2", "-o", "x.png"}, 2,
              {"--finish-measures"});
}

// A wall before the camera from frame 4 on, behind it before.
class CliFinishLateWall : public CliFinishInTime {
 protected:
  void SetUp() override {
    GltfBuilder b;
    const int position = b.Floats({-2, -2, 2, 2, -2, 2, 2, 2, -2, -2, 2, -2}, 3);
    const int mesh = b.Mesh({{{"attributes", {{"POSITION", position}}}, {"indices", b.Indices({0, 1, 2, 0, 2, 3})}}});
    const int wall = b.Root({{"name", "Wall"}, {"mesh", mesh}});
    b.Append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
    b.Root({{"camera", 0}, {"translation", {0, 0, 8}}});
    b.Animate(wall, "translation", {3, 4}, {0, 0, 60, 0, 0, 0});
    const std::vector<unsigned char> glb = b.Glb();
    WriteText("late.glb", std::string(glb.begin(), glb.end()));
    // Light and its exposure matter.
    WriteStyle("lit", "luminance = 0.8\n[[exemplar]]\nimage = \"lit.png\"\nfills = true\nluminance = 0.1\n");
  }
  static std::string Behind(const std::string& text, const std::string& option) {
    const std::size_t at = text.find(option + " ");
    if (at == std::string::npos) return "";
    const std::size_t begin = at + option.size() + 1;
    return text.substr(begin, text.find_first_of(" \n", begin) - begin);
  }
  const Arguments finish_ = {"--finish", "toon", "--finish", "depth"};
  const Arguments stylize_ =
      With({"stylize", "late.glb", "--fps", "1", "--size", "48x32", "--style", "lit", "-o", "p.#.png"}, finish_);
};

TEST_F(CliFinishLateWall, TheFirstFrameThatShowsSomethingIsMeasured) {
  const CommandResult late = RunOk(With(stylize_, {"--frames", "4-5"}));
  const std::string measures = Behind(late.err, "--finish-measures"), stops = Behind(late.err, "give each --exposure");
  EXPECT_NE(measures, "");
  EXPECT_NE(stops, "0.00") << "the test could not fail";
  const auto whole = Read("p.5.png").rgba;
  const CommandResult all = RunOk(With(stylize_, {"--frames", "2-5"}));
  EXPECT_TRUE(Contains(all.err, "--finish-measures " + measures + " repeats what was measured on frame 4")) << all.err;
  EXPECT_TRUE(Contains(all.err, "give it to each run")) << all.err;
  EXPECT_TRUE(Contains(all.err, "measured on frame 4")) << all.err;
  EXPECT_TRUE(Contains(all.err, "--exposure " + stops)) << all.err;
  EXPECT_EQ(Read("p.5.png").rgba, whole);
  // What is printed repeats it: then nothing is measured.
  const CommandResult piece =
      RunOk(With(stylize_, {"--frames", "3-5", "--finish-measures", measures, "--exposure", stops}));
  EXPECT_FALSE(Contains(piece.err, "measure")) << piece.err;
  EXPECT_EQ(Read("p.5.png").rgba, whole);
  // Of files, too.
  RunOk({"guidegen", "late.glb", "--fps", "1", "--size", "48x32", "--layers", "luminance,shadow,albedo", "--frames",
         "3-5", "-o", "g.#.exr"});
  const CommandResult transfer =
      RunOk(With({"transfer", "g.#.exr", "--style", "lit", "--frames", "3-5", "-o", "t.#.png"}, finish_));
  EXPECT_EQ(Behind(transfer.err, "--finish-measures"), measures);
  EXPECT_EQ(Read("t.5.png").rgba, whole);
  const CommandResult after =
      RunOk(With({"finish", "t.#.png", "g.#.exr", "--frames", "3-5", "-o", "f.#.png"}, finish_));
  EXPECT_TRUE(Contains(after.err, "--finish-measures " + measures + " repeats what was measured on frame 4"))
      << after.err;
}

TEST_F(CliFinishLateWall, PalettesAreMeasuredOnce) {
  const Arguments palette = {"--finish", "palette", "--set", "finish.palette.like=#203050 #f0e0c0", "--bits", "16"};
  const auto measured = [](const std::string& text) {
    const std::size_t begin = text.find("finish.palette.from=measured");
    return begin == std::string::npos ? "" : text.substr(begin, text.find('\'', begin) - begin);
  };
  const CommandResult all = RunOk(With(With(stylize_, palette), {"--frames", "3-5"}));
  const std::string set = measured(all.err);
  ASSERT_NE(set, "") << all.err;
  EXPECT_TRUE(Contains(all.err, "on frame 4: give it to each run")) << all.err;
  const auto fifth = Read("p.5.png").rgba;
  const std::string measures = Behind(all.err, "--finish-measures"), stops = Behind(all.err, "give each --exposure");
  const Arguments rest = {"--frames", "5-6", "--finish-measures", measures, "--exposure", stops};
  const CommandResult piece = RunOk(With(With(With(stylize_, palette), rest), {"--set", set}));
  EXPECT_FALSE(Contains(piece.err, "measured")) << piece.err;
  EXPECT_EQ(Read("p.5.png").rgba, fifth);
  // Of files: without guides the first frame is measured, even if it is kept.
  RunOk({"stylize", kToys, "--frames", "1-3", "--size", "48x32", "--style", "lit", "-o", "in.#.png"});
  const Arguments finish = With({"finish", "in.#.png", "--frames", "1-3", "-o", "f.#.png"}, palette);
  const CommandResult files = RunOk(finish);
  EXPECT_TRUE(Contains(files.err, "on frame 1: give it")) << files.err;
  const auto third = Read("f.3.png").rgba;
  std::filesystem::remove(At("f.3.png"));
  EXPECT_EQ(measured(RunOk(With(finish, {"--resume"})).err), measured(files.err));
  EXPECT_EQ(Read("f.3.png").rgba, third);
  const CommandResult other = RunOk(With(finish, {"--resume", "--json", "--set", set}));
  EXPECT_TRUE(Contains(other.out, "\"kept\": 0")) << other.out;
  ExpectError(With(finish, {"--set", "finish.palette.from=measured 1 2"}), 3, {"nine numbers", "measured 1 2"});
}

TEST_F(CliFinishLateWall, NothingToMeasureIsWarnedOf) {
  const CommandResult run = RunOk(With(stylize_, {"--frames", "1-3"}));
  const std::string both = "give --exposure and --finish-measures of a frame that shows one";
  EXPECT_TRUE(Contains(run.err, "no surface shows in frames 1-3")) << run.err;
  EXPECT_TRUE(Contains(run.err, both)) << run.err;
  const std::string nothing = "the camera sees nothing";
  std::size_t count = 0;
  for (std::size_t at = 0; (at = run.err.find(nothing, at)) != std::string::npos; ++at) ++count;
  EXPECT_EQ(count, 3u) << "once for each frame\n" << run.err;
  EXPECT_FALSE(Contains(run.err, "repeats")) << run.err;
  const CommandResult one = RunOk(With(stylize_, {"--frame", "2"}));
  EXPECT_TRUE(Contains(one.err, "shows no surface")) << one.err;
  EXPECT_TRUE(Contains(one.err, "give --finish-measures")) << one.err;
  EXPECT_TRUE(Contains(one.err, "give --exposure")) << one.err;
  EXPECT_FALSE(Contains(one.err, "repeats")) << one.err;
  RunOk({"guidegen", "late.glb", "--fps", "1", "--size", "48x32", "--layers", "luminance,shadow,albedo", "--frames",
         "1-2", "-o", "g.#.exr"});
  const CommandResult after =
      RunOk(With({"finish", "p.#.png", "g.#.exr", "--frames", "1-2", "-o", "f.#.png"}, finish_));
  EXPECT_TRUE(Contains(after.err, "no surface shows in frames 1-2")) << after.err;
  EXPECT_TRUE(Contains(after.err, "give --finish-measures of a frame")) << after.err;
}

// The object in focus leaves the view: the first frame says so at once, the end of the run has them all.
TEST_F(CliFinishLateWall, FramesWithoutTheObjectInFocusAreNamed) {
  const Arguments focus = {"--finish", "depth", "--set", "finish.depth.focus_on=Wall", "--frames", "5-1", "--json"};
  const std::string lost = "finish depth: no object in the picture has the name Wall, so the focus is near";
  const std::string fix = "finish.depth.focus=[[FRAME, METRES], ...]";
  const CommandResult run =
      RunOk(With({"stylize", "late.glb", "--fps", "1", "--size", "48x32", "--style", "lit", "-o", "p.#.png"}, focus));
  EXPECT_TRUE(Contains(run.err, "warning: frame 3: " + lost)) << run.err;
  EXPECT_FALSE(Contains(run.err, "warning: frame 2: " + lost)) << run.err;
  EXPECT_TRUE(Contains(run.err, "warning: frames 1-3: " + lost)) << run.err;
  EXPECT_TRUE(Contains(run.err, fix)) << run.err;
  EXPECT_TRUE(Contains(run.Json()["warnings"].back().get<std::string>(), "frames 1-3: " + lost)) << run.out;
  RunOk({"guidegen", "late.glb", "--fps", "1", "--size", "48x32", "--frames", "1-5", "-o", "g.#.exr"});
  const CommandResult after = RunOk(With({"finish", "p.#.png", "g.#.exr", "-o", "f.#.png"}, focus));
  EXPECT_TRUE(Contains(after.err, "warning: g.3.exr: " + lost)) << after.err;
  EXPECT_TRUE(Contains(after.err, "warning: frames 1-3: " + lost)) << after.err;
  const Arguments keyed = With(focus, {"--set", "finish.depth.focus=[[4, 8], [5, 9]]"});
  EXPECT_FALSE(Contains(RunOk(With({"finish", "p.#.png", "g.#.exr", "-o", "f.#.png"}, keyed)).err, "focus is near"));
}

// A frame is kept by what it was measured with, whether that was given or not.
TEST_F(CliFinishInTime, ResumeKnowsTheMeasures) {
  WriteStyle("plain");
  RunOk({"guidegen", kToys, "--frames", "1-2", "--size", "64x48", "--layers", "luminance,shadow", "-o", "g.####.exr"});
  const Arguments paint{"transfer", "g.####.exr", "--style",   "plain", "--frames",
                        "1-2",      "--finish",   "storybook", "-o",    "p.####.png"};
  const auto kept = [&](Arguments arguments, const std::string& measures) {
    arguments.insert(arguments.end(), {"--resume", "--json"});
    if (!measures.empty()) arguments.insert(arguments.end(), {"--finish-measures", measures});
    return RunOk(arguments).Json()["kept"].get<int>();
  };
  const auto told = [&](const Arguments& arguments) {
    const std::string text = RunOk(arguments).err, option = "--finish-measures ";
    const std::size_t begin = text.find(option) + option.size();
    return text.substr(begin, text.find(' ', begin) - begin);
  };
  const std::string measures = told(paint);
  RunOk({"transfer", "g.####.exr", "--style", "plain", "--frames", "1-2", "-o", "q.####.png"});
  const Arguments finish{"finish",   "q.####.png", "g.####.exr", "--frames",  "1-2",
                         "--finish", "storybook",  "-o",         "f.####.png"};
  EXPECT_EQ(told(finish), measures);
  for (const Arguments& run : {paint, finish}) {
    EXPECT_EQ(kept(run, ""), 2) << run[0];
    EXPECT_EQ(kept(run, measures), 2) << run[0];
    EXPECT_EQ(kept(run, "1,2,30,1,1"), 0) << run[0];
    EXPECT_EQ(kept(run, "1,2,30,1,1"), 2) << run[0];
    std::filesystem::remove(At(run.back() == "p.####.png" ? "p.0002.png" : "f.0002.png"));
    EXPECT_EQ(kept(run, ""), 0) << run[0] << ": frames of other measures are not mixed";
  }
}

// Frames that are made later look as those that were made at once.
TEST_F(CliFinishInTime, ResumedTransfersGoOnAsTheyBegan) {
  WriteStyle("plain");
  const Arguments run{"stylize", kToys,      "--frames",  "1-3", "--size",     "64x48",   "--style",
                      "plain",   "--finish", "storybook", "-o",  "f.####.png", "--resume"};
  RunOk(run);
  const auto before = Read("f.0003.png").rgba;
  std::filesystem::remove(At("f.0003.png"));
  RunOk(run);
  EXPECT_EQ(Read("f.0003.png").rgba, before);
  std::filesystem::remove(At("f.0003.png"));
  RunOk({"stylize", kToys, "--frame", "3", "--size", "64x48", "--style", "plain", "--finish", "storybook", "-o",
         "f.0003.png"});
  EXPECT_NE(Read("f.0003.png").rgba, before) << "alone it is measured on itself";
}

TEST_F(CliFinishInTime, KeysMoveInSequences) {
  WriteStyle("moving", "[[finish]]\neffect = \"outline\"\nwidth = [[1, 0], [3, 6]]\n");
  WriteStyle("plain");
  RunOk({"stylize", kBall, "--frames", "1-3", "--size", "64", "--style", "moving", "-o", "m.####.png"});
  RunOk({"stylize", kBall, "--frame", "1", "--size", "64", "--style", "plain", "-o", "p.png"});
  RunOk({"stylize", kBall, "--frame", "2", "--size", "64", "--style", "plain", "--finish", "outline", "--set",
         "finish.outline.width=3", "-o", "w.png"});
  EXPECT_EQ(Read("m.0001.png").rgba, Read("p.png").rgba);
  EXPECT_EQ(Read("m.0002.png").rgba, Read("w.png").rgba);
  EXPECT_NE(Read("m.0003.png").rgba, Read("m.0002.png").rgba);
}

// After a transfer and with it, at the rate that is given or that the guides have.
TEST_F(CliFinishInTime, LinesAreDrawnAnewSoManyTimesASecond) {
  WriteStyle("plain");
  const Arguments boil{
      "--finish", "outline", "--set", "finish.outline.wobble=4", "--set", "finish.outline.jitter_fps=12"};
  const auto with = [&](Arguments arguments) {
    arguments.insert(arguments.end(), boil.begin(), boil.end());
    RunOk(arguments);
  };
  const auto scene = [](const std::string& frame, const std::string& output) {
    return Arguments{"stylize", kBall,    "--size", "64",      "--aa", "2",  "--style",
                     "plain",   "--bits", "16",     "--frame", frame,  "-o", output};
  };
  with(scene("0", "0.png")), with(scene("1", "1.png")), with(scene("2", "2.png"));
  EXPECT_EQ(Read("1.png").rgba, Read("0.png").rgba);
  EXPECT_NE(Read("2.png").rgba, Read("0.png").rgba);
  RunOk(scene("2", "plain.png"));
  RunOk({"guidegen", kBall, "--size", "64", "--aa", "2", "-o", "g.exr"});
  RunOk({"guidegen", kBall, "--size", "64", "--aa", "2", "--fps", "48", "-o", "g48.exr"});
  with({"finish", "plain.png", "g.exr", "--bits", "16", "--frame", "2", "-o", "after.png"});
  EXPECT_EQ(Read("after.png").rgba, Read("2.png").rgba);
  with({"finish", "plain.png", "g.exr", "--bits", "16", "--frame", "2", "--fps", "48", "-o", "slow.png"});
  EXPECT_EQ(Read("slow.png").rgba, Read("0.png").rgba);
  with({"finish", "plain.png", "g48.exr", "--bits", "16", "--frame", "2", "-o", "told.png"});
  EXPECT_EQ(Read("told.png").rgba, Read("0.png").rgba);
  const Arguments hatch{"finish",
                        "plain.png",
                        "g48.exr",
                        "--bits",
                        "16",
                        "--finish",
                        "hatch",
                        "--set",
                        "finish.hatch.tone=paint",
                        "--set",
                        "finish.hatch.along=fixed",
                        "--set",
                        "finish.hatch.jitter_fps=12",
                        "--set",
                        "finish.hatch.bare=1",
                        "--set",
                        "finish.hatch.spacing=100"};
  const auto hatched = [&](const Arguments& more) {
    Arguments arguments = hatch;
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunOk(arguments);
  };
  hatched({"--frame", "0", "-o", "h0.png"}), hatched({"--frame", "2", "-o", "h2.png"});
  EXPECT_EQ(Read("h2.png").rgba, Read("h0.png").rgba) << "it reads no layer, and yet the guides' rate";
  hatched({"--frame", "4", "-o", "h4.png"});
  EXPECT_NE(Read("h4.png").rgba, Read("h0.png").rgba);
}

TEST_F(CliFinishInTime, ResumeKeepsFramesOfTheSameRate) {
  WriteStyle("plain");
  RunOk({"stylize", kBall, "--frames", "1-2", "--size", "48", "--style", "plain", "-o", "p.####.png"});
  RunOk({"guidegen", kBall, "--frames", "1-2", "--size", "48", "-o", "g.####.exr"});
  const auto kept = [&](const Arguments& more) {
    Arguments arguments{"finish",
                        "p.####.png",
                        "g.####.exr",
                        "--frames",
                        "1-2",
                        "--finish",
                        "outline",
                        "--resume",
                        "--json",
                        "-o",
                        "f.####.png",
                        "--set",
                        "finish.outline.wobble=4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Contains(RunOk(arguments).out, "\"kept\": 2");
  };
  EXPECT_FALSE(kept({}));
  EXPECT_TRUE(kept({"--fps", "30"})) << "no pass looks at the rate";
  const Arguments boil{"--set", "finish.outline.jitter_fps=12"};
  EXPECT_FALSE(kept(boil));
  EXPECT_TRUE(kept(boil));
  RunOk({"guidegen", kBall, "--frames", "1-2", "--size", "48", "--fps", "48", "-o", "g.####.exr"});
  EXPECT_FALSE(kept(boil)) << "the guides' rate is another";
  for (const char* const rate : {"fast", "0", "0.0004"}) {
    const CommandResult wrong = Run({"finish", "p.####.png", "g.####.exr", "--frames", "1-2", "--finish", "outline",
                                     "--fps", rate, "-o", "f.####.png"});
    EXPECT_EQ(wrong.code, 2) << rate;
    EXPECT_TRUE(Contains(wrong.err, "--fps " + std::string(rate))) << wrong.err;
  }
}

// Key frames of a preset and of --set, with a transfer and after one: each frame is the single run with its values.
TEST_F(CliFinishInTime, KeysOfPresetsMoveInSequences) {
  WriteStyle("plain");
  WriteText("look.toml",
            "[[finish]]\neffect = \"shadows\"\nstrength = [[1, 0], [3, 1]]\n[[finish]]\neffect = \"outline\"\n"
            "ink = [[2, \"#000000\"], [3, \"#ff0000\"]]\n");
  const Arguments width{"--set", "finish.outline.width=[[1, 2], [3, 6]]"};
  const auto with = [](Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const Arguments scene{"stylize", kBall, "--size", "64", "--style", "plain", "--bits", "16"};
  RunOk(with(scene, {"--frames", "1-3", "-o", "p.####.png"}));
  RunOk({"guidegen", kBall, "--frames", "1-3", "--size", "64", "--layers", "luminance,shadow", "-o", "g.####.exr"});
  const Arguments moving = with({"--frames", "1-3", "--finish", "look.toml"}, width);
  RunOk(with(with(scene, moving), {"-o", "s.####.png"}));
  RunOk(with({"transfer", "g.####.exr", "--style", "plain", "--bits", "16", "-o", "t.####.png"}, moving));
  RunOk(with({"finish", "p.####.png", "g.####.exr", "--bits", "16", "-o", "f.####.png"}, moving));
  const char* const widths[] = {"2", "4", "6"};
  const char* const strengths[] = {"0", "0.5", "1"};
  const char* const inks[] = {"#000000", "#000000", "#ff0000"};
  // Depths and light are measured on the first frame.
  for (int frame = 1; frame <= 3; ++frame) {
    const std::string number = std::to_string(frame), name = ".000" + number + ".png";
    const auto i = std::size_t(frame - 1);
    RunOk(with(scene,
               {"--frame", number, "--finish", "shadows", "--finish", "outline", "--set",
                std::string("finish.outline.width=") + widths[i], "--set", std::string("finish.outline.ink=") + inks[i],
                "--set", std::string("finish.shadows.strength=") + strengths[i], "-o", "one.png"}));
    const auto one = Read("one.png").rgba;
    EXPECT_EQ(Read("s" + name).rgba, one) << name;
    EXPECT_EQ(Read("t" + name).rgba, one) << name;
    EXPECT_EQ(Read("f" + name).rgba, one) << name;
  }
  EXPECT_NE(Read("s.0003.png").rgba, Read("s.0002.png").rgba);
  // A frame is remade where its own values have changed.
  const CommandResult again = RunOk(
      with({"finish", "p.####.png", "g.####.exr", "--bits", "16", "-o", "f.####.png", "--frames", "1-3", "--finish",
            "look.toml", "--resume", "--json", "--set", "finish.outline.width=[[1, 2], [2, 4], [3, 7]]"},
           {}));
  EXPECT_TRUE(Contains(again.out, "\"kept\": 2")) << again.out;
  RunOk({"finish", "p.0002.png", "g.0002.exr", "--bits", "16", "--frame", "2", "--finish", "look.toml", "--set",
         "finish.outline.width=[[1, 2], [3, 6]]", "-o", "alone.png"});
  EXPECT_EQ(Read("alone.png").rgba, Read("s.0002.png").rgba);
  EXPECT_TRUE(
      Contains(RunOk({"finish", "--list", "--finish", "look.toml"}).out, "finish.shadows.strength=[[1, 0], [3, 1]]"));
  EXPECT_TRUE(Contains(RunOk({"stylize", kBall, "--style", "plain", "--finish", "look.toml", "--explain"}).out,
                       "read by finish shadows"))
      << "of a later frame";
  ExpectError({"finish", "p.0001.png", "--finish", "look.toml", "-o", "x.png"}, 3, {"finish shadows needs"});
}

}  // namespace
}  // namespace scumble
