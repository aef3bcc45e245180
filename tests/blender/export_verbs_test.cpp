// The commands that run Blender's export themselves, on the scenes of tests/blender/make_cases.py.
#include <gmock/gmock.h>

#include "guidegen/load_scene.h"
#include "tests/blender/blender_cases.h"
#include "tests/support/cli_harness.h"
#include "tests/support/scoped_variable.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

// The program beside its scripts, wherever it was built.
class BlenderVerbs : public CliTest {
 protected:
  BlenderVerbs() : settings_(CopyProgram("home/bin")) {
    fs::create_directory_symlink(BlenderCases::Source("blender_scripts"), At("home/blender_scripts"));
    fs::create_directory_symlink(BlenderCases::Source("exemplars"), At("home/exemplars"));
  }
  CommandResult RunHere(const Arguments& arguments) { return Run(arguments, settings_); }
  void ExpectErrorHere(const Arguments& arguments, int code, const std::vector<std::string>& parts) {
    ExpectError(arguments, code, parts, settings_);
  }
  void WriteProgram(const std::string& name, const std::string& body) {
    WriteText(name, "#!/bin/sh\n" + body + "\n");
    fs::permissions(At(name), fs::perms::owner_all);
  }
  static std::string Blend(const std::string& name) { return BlenderCases::File(name + ".blend").string(); }

 private:
  CommandSettings settings_;
};

TEST_F(BlenderVerbs, GuidegenExportsByItself) {
  const Arguments tail = {"--size", "96x54", "--view", "20,30", "-o"};
  fs::create_directory(At("tmp"));
  const ScopedVariable temporary("TMPDIR", At("tmp").string());
  const CommandResult run = RunHere(With(With({"guidegen", Blend("objects"), "--frame", "6"}, tail), {"blend.exr"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, AllOf(HasSubstr("objects.blend: blender exports it at frame 6"), HasSubstr("'Smoke'")));
  RunOk(With(With({"guidegen", BlenderCases::File("objects6.glb").string()}, tail), {"glb.exr"}));
  const CommandResult compared = Run({"compare", "blend.exr", "glb.exr"});
  EXPECT_EQ(compared.code, 0) << compared.out;
  EXPECT_TRUE(fs::is_empty(At("tmp"))) << "a temporary export is left behind";
}

// Without a camera, a still is framed as it stands at the frame that it was saved at, and a frame that is named as its
// range is.
TEST_F(BlenderVerbs, AStillIsFramedAsItStands) {
  const Arguments tail = {"--size", "96x54", "-o"};
  RunOk(With(With({"guidegen", BlenderCases::File("old.glb").string()}, tail), {"glb.exr"}));
  ASSERT_EQ(RunHere(With(With({"guidegen", Blend("old")}, tail), {"still.exr"})).code, 0);
  EXPECT_EQ(Run({"compare", "still.exr", "glb.exr"}).code, 0);
  const CommandResult named = RunHere(With(With({"guidegen", Blend("old"), "--frame", "9"}, tail), {"9.exr"}));
  ASSERT_EQ(named.code, 0);
  EXPECT_THAT(named.err, HasSubstr("the camera sees nothing")) << "it left the view of the range's start";
}

TEST_F(BlenderVerbs, StylizeToo) {
  WriteStyle("style");
  const CommandResult run = RunHere({"stylize", Blend("cameras"), "--style", "style", "--size", "64", "-o", "p.png"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(Exists("p.png"));
}

// Frames that show nothing are looked through first, and then made from the first one on.
TEST_F(BlenderVerbs, TheFirstFrameThatShowsSomethingIsMeasured) {
  WriteStyle("style");
  const Arguments stylize = {"stylize", Blend("old"), "--size", "48x27", "--style", "style", "--finish", "depth"};
  const CommandResult run = RunHere(With(stylize, {"--frames", "9,1", "-o", "p#.png", "--explain"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("repeats what was measured on frame 1"));
  const std::size_t note = run.err.find("blender exports frames 9,1");
  EXPECT_EQ(run.err.find("blender exports", note + 1), std::string::npos) << "it is noted once\n" << run.err;
  EXPECT_THAT(run.out + run.err, HasSubstr("read by finish depth")) << "the plan";
  const std::string first = Pixels("p1.png");
  ASSERT_EQ(RunHere(With(stylize, {"--frame", "1", "-o", "p1.png"})).code, 0);
  EXPECT_TRUE(Pixels("p1.png") == first);
}

// A .blend is measured in the frame and view in which it is painted.
TEST_F(BlenderVerbs, TradeoffAndBudgetTakeAFrame) {
  WriteStyle("style");
  const Arguments seen = {"--style", "style", "--size", "64x36", "--view", "20,30", "--frame", "6"};
  const Arguments stylize = With({"stylize", Blend("objects")}, seen);
  ASSERT_EQ(RunHere(With(stylize, {"-o", "plain.png"})).code, 0);
  const CommandResult within = RunHere(With(stylize, {"--budget-ms", "3600000", "--json", "-o", "picked.png"}));
  ASSERT_EQ(within.code, 0) << within.err;
  EXPECT_EQ(within.Json().at("budget").at("picked"), "the style");
  EXPECT_EQ(Bytes("picked.png"), Bytes("plain.png"));
  const CommandResult trade = RunHere(
      With(With({"tradeoff", Blend("objects")}, seen), {"--only", "method", "--repeat", "1", "--json", "-o", "out"}));
  ASSERT_EQ(trade.code, 0) << trade.err;
  const nlohmann::json variants = trade.Json().at("variants");
  ASSERT_EQ(variants.size(), 3u);
  std::istringstream options(variants[0].at("options").get<std::string>());
  const Arguments words{std::istream_iterator<std::string>(options), {}};
  ASSERT_EQ(RunHere(With(With({"stylize", Blend("objects")}, words), {"-o", "again.png"})).code, 0);
  EXPECT_TRUE(Pixels("out/pictures/01-the-style.png") == Pixels("again.png")) << options.str();
  for (const auto& variant : variants)
    EXPECT_TRUE(variant.at("memory_bytes").is_null()) << "Blender would run for each";
}

// One Blender for the range; more frames than it may be ahead, backwards and with a stop in between.
TEST_F(BlenderVerbs, ARangeIsItsFramesByteForByte) {
  const Arguments guidegen = {"guidegen", Blend("objects"), "--size", "64x36", "--view", "20,30"};
  const CommandResult range = RunHere(With(guidegen, {"--frames", "6-1,-2", "-o", "range.##.exr"}));
  ASSERT_EQ(range.code, 0) << range.err;
  EXPECT_THAT(range.err, HasSubstr("objects.blend: blender exports frames 6-1,-2"));
  EXPECT_EQ(range.err.find("'Smoke'"), range.err.rfind("'Smoke'")) << "a warning is given once\n" << range.err;
  for (const std::string frame : {"6", "2", "-2"}) {
    const CommandResult one = RunHere(With(guidegen, {"--frame", frame, "-o", "one.exr"}));
    ASSERT_EQ(one.code, 0) << one.err;
    const std::string name = frame == "-2" ? "range.-02.exr" : "range.0" + frame + ".exr";
    EXPECT_EQ(Bytes(name), Bytes("one.exr")) << frame;
  }
  EXPECT_NE(Bytes("range.06.exr"), Bytes("range.02.exr")) << "nothing moves";
  // With nothing to make there is no Blender to miss.
  const Arguments again =
      With(guidegen, {"--frames", "1-6", "-o", "range.##.exr", "--resume", "--blender", "no/blender"});
  const CommandResult kept = RunHere(again);
  EXPECT_EQ(kept.code, 0) << kept.err;
  EXPECT_THAT(kept.out, HasSubstr("0 made, 6 kept"));

  WriteStyle("style");
  const Arguments stylize = {"stylize", Blend("objects"), "--size", "64x36", "--view", "20,30", "--style", "style"};
  ASSERT_EQ(RunHere(With(stylize, {"--frames", "5-6", "-o", "p#.png"})).code, 0);
  RunOk({"transfer", "range.##.exr", "--style", "style", "--frame", "6", "-o", "two.png"});
  EXPECT_EQ(Bytes("p6.png"), Bytes("two.png"));

  WriteProgram("stops", "echo 'scumble: error: the export stopped' >&2; exit 3");
  const CommandResult stopped = RunHere(With(guidegen, {"--frames", "1-3", "-o", "s#.exr", "--blender", "./stops"}));
  EXPECT_EQ(stopped.code, 3);
  EXPECT_THAT(stopped.Error(), AllOf(HasSubstr("3 of 3 frames were not made: 1-3"), HasSubstr("the export stopped")));
  ExpectErrorHere(With(guidegen, {"--frames", "1-3", "-o", "s#.exr", "--blender", "no/blender"}), 5, {"no/blender"});
}

TEST_F(BlenderVerbs, MotionTakesTheNextFrameToo) {
  const Arguments guidegen = {"guidegen", Blend("objects"), "--size", "64x36", "--view", "20,30", "--layers", "motion"};
  const CommandResult range = RunHere(With(guidegen, {"--frames", "5-1x-2,2", "-o", "m#.exr"}));
  ASSERT_EQ(range.code, 0) << range.err;
  EXPECT_THAT(range.err, HasSubstr("exports frames 5-6,3-4,1-2"));
  ASSERT_EQ(RunHere(With(guidegen, {"--frame", "3", "-o", "one.exr"})).code, 0);
  EXPECT_EQ(Bytes("one.exr"), Bytes("m3.exr"));
  GuideReadOptions read;
  read.required = AlwaysWritten().Add(Layer::kMotion);
  const auto guides = ReadGuides(At("m2.exr"), read);
  ASSERT_TRUE(guides) << guides.error().message;
  const auto motion = guides->Plane(Layer::kMotion, 0);
  EXPECT_TRUE(std::any_of(motion.begin(), motion.end(), [](float x) { return x != 0.0f; })) << "nothing moves";
}

// In objects.blend the object One wants oil, and the material Grey to be left as rendered.
TEST_F(BlenderVerbs, StylesOfTheFileAreHeeded) {
  WriteStyle("style");
  const Arguments stylize = {"stylize", Blend("objects"), "--size", "64x36", "--view", "20,30", "--style", "style"};
  const auto picture = [&](const Arguments& more) {
    const CommandResult run = RunHere(With(With(stylize, more), {"-o", "p.png"}));
    EXPECT_EQ(run.code, 0) << run.err;
    return Pixels("p.png");
  };
  const std::string heeded = picture({}), plain = picture({"--no-scene-styles"});
  EXPECT_FALSE(heeded == plain);
  EXPECT_TRUE(picture({"--no-scene-styles", "--assign", "Grey=rendered", "--assign", "One=oil"}) == heeded);
  EXPECT_TRUE(picture({"--assign", "*=style"}) == plain);
  ASSERT_EQ(RunHere(With(stylize, {"--frames", "1-2", "-o", "r#.png"})).code, 0);
  ASSERT_EQ(RunHere(With(stylize, {"--frame", "2", "-o", "p.png"})).code, 0);
  EXPECT_EQ(Bytes("r2.png"), Bytes("p.png"));
}

TEST_F(BlenderVerbs, AShadowCatcherIsOneHereToo) {
  const CommandResult run = RunHere({"info", Blend("layers"), "--scene", "Other", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.Json().at("styles"), nlohmann::json({{"Alone", "catcher-or-rendered"}}));
  EXPECT_THAT(run.Json().at("warnings").dump(),
              HasSubstr("object 'Alone': is a shadow catcher: pictures leave it out"));
}

TEST_F(BlenderVerbs, NoOtherCameraTakesThePlaceOfTheActiveOne) {
  const Arguments guidegen = {"guidegen", Blend("panorama"), "--size", "32x18", "-o", "g.exr"};
  ExpectErrorHere(guidegen, 3, {"active camera 'Round' is panoramic: give --camera NAME, of 'Side', or --view"});
  EXPECT_EQ(RunHere(With(guidegen, {"--camera", "Side"})).code, 0);
  EXPECT_EQ(RunHere(With(guidegen, {"--view", "20,30"})).code, 0);
}

TEST_F(BlenderVerbs, ScenesAndViewLayersAreChosenByName) {
  const auto objects = [&](const Arguments& more, const std::vector<std::string>& notes) {
    const CommandResult run = RunHere(With({"info", Blend("layers"), "--json"}, more));
    EXPECT_EQ(run.code, 0) << run.err;
    for (const std::string& note : notes) EXPECT_THAT(run.err, HasSubstr(note));
    EXPECT_EQ(run.err.find("takes another") == std::string::npos, notes.empty()) << run.err;
    return run.Json();
  };
  const auto names = [](std::vector<std::string> list) { return nlohmann::json(list); };
  EXPECT_EQ(
      objects({}, {"scene 'Shot', which was open when the file was saved, of 'Bare', 'Other', 'Shot': --scene takes",
                   "view layer 'Fore', the first of those that are rendered, 'Fore', 'Rear': --view-layer takes"})
          .at("objects"),
      names({"Near"}));
  EXPECT_EQ(objects({"--scene", "Shot", "--view-layer", "Rear"}, {}).at("objects"), names({"Far", "Farther"}));
  EXPECT_EQ(objects({"--scene", "Other"}, {}).at("objects"), names({"Alone"}));
  const auto empty = [&](const Arguments& which, const std::string& why) {
    const auto warnings = objects(which, {}).at("warnings").get<std::vector<std::string>>();
    EXPECT_THAT(warnings, ::testing::Contains("nothing is left to draw: " + why));
  };
  empty({"--scene", "Shot", "--view-layer", "Spare"},
        "3 meshes are hidden from render in collection 'Car', 2 meshes are in collection 'Back', which view layer "
        "'Spare' "
        "excludes, 1 mesh is hidden from render, 1 mesh is in collection 'Front', which view layer 'Spare' excludes");
  empty({"--scene", "Bare"}, "scene 'Bare' has no mesh; 'Other', 'Shot' of this file has: choose it with --scene");
  const Arguments tail = {"--size", "32", "-o", "g.exr"};
  ExpectErrorHere(With({"guidegen", Blend("layers"), "--scene", "Nope"}, tail), 3,
                  {"there is no scene 'Nope'; there are: 'Bare', 'Other', 'Shot'"});
  ExpectErrorHere(With({"guidegen", Blend("layers"), "--view-layer=-nope"}, tail), 3,
                  {"scene 'Shot' has no view layer '-nope'; there are: 'Spare', 'Fore', 'Rear'"});
}

// The crop's guides are the picture that Blender renders, and a sequence takes the same names.
TEST_F(BlenderVerbs, BordersAndNamesReachGuidesAndSequences) {
  const Arguments guidegen = {"guidegen", Blend("bordered"), "--scene", "Cropped", "--size", "141x115"};
  const CommandResult run = RunHere(With(guidegen, {"-o", "one.exr"}));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("to which it is cropped: 141x115 pixels in the file"));
  ASSERT_EQ(RunHere(With(guidegen, {"--frames", "1-2", "-o", "r#.exr"})).code, 0);
  EXPECT_EQ(Layers("r1.exr"), Layers("one.exr"));
  const Arguments other = {"guidegen", Blend("bordered"), "--size", "141x115", "--frames", "1-2", "-o", "r#.exr"};
  const CommandResult again = RunHere(With(other, {"--resume"}));
  EXPECT_THAT(again.out, HasSubstr("2 made, 0 kept")) << "another scene is another setting";
  EXPECT_THAT(again.err, HasSubstr("the rest is background"));
}

TEST_F(BlenderVerbs, FailuresAreReadable) {
  const Arguments tail = {"--size", "32", "-o", "g.exr"};
  WriteText("bad.blend", "no scene at all");
  ExpectErrorHere(With({"guidegen", "bad.blend"}, tail), 3, {"bad.blend", "File format is not supported"});
  WriteText("newer.blend", "BLENDER-v999RENDH");
  ExpectErrorHere(With({"guidegen", "newer.blend"}, tail), 3,
                  {"newer.blend", "saved by Blender 9.99", "the older Blender"});
  ExpectErrorHere(With({"guidegen", "lost.blend"}, tail), 3, {"lost.blend", "no such file"});
  ExpectErrorHere(With({"guidegen", "bad.blend", "--blender", "no/blender"}, tail), 5,
                  {"no/blender", "with --blender"});
  WriteProgram("newer", "echo 'scumble: error: this is Blender 9.9.9; versions from 3.4' >&2; exit 5");
  ExpectErrorHere(With({"guidegen", "bad.blend", "--blender", "./newer"}, tail), 5, {"Blender 9.9.9"});
  WriteProgram("silent", "exit 0");
  ExpectErrorHere(With({"guidegen", "bad.blend", "--blender", "./silent"}, tail), 3, {"./silent", "says nothing"});
  WriteProgram("crashing", "kill -SEGV $$");
  ExpectErrorHere(With({"guidegen", "bad.blend", "--blender", "./crashing"}, tail), 3, {"./crashing crashed"});
  // Blender may well crash on what a newer one has saved.
  WriteProgram("older", "echo 'Blender 3.4.1'; kill -SEGV $$");
  WriteText("newer.blend", "BLENDER-v403RENDH");
  ExpectErrorHere(With({"guidegen", "newer.blend", "--blender", "./older"}, tail), 3,
                  {"./older crashed", "saved by Blender 4.3", "the older Blender 3.4.1"});
  WriteText("newest.blend", "BLENDER17-01v0500");
  WriteProgram("confused", "echo 'Blender 4.3.2'; echo 'scumble: error: what is this'; exit 3");
  ExpectErrorHere(With({"guidegen", "newest.blend", "--blender", "./confused"}, tail), 3,
                  {"what is this", "saved by Blender 5.0", "the older Blender 4.3.2"});
  EXPECT_FALSE(Exists("g.exr"));
}

TEST_F(BlenderVerbs, OptionsForBlenderNeedABlendFile) {
  WriteText("s.gltf", TriangleGltf(false));
  ExpectErrorHere({"guidegen", "s.gltf", "--blender", "blender", "-o", "g.exr"}, 2, {"--blender", "s.gltf"});
  for (const std::string option : {"--scene", "--view-layer"}) {
    for (const std::string verb : {"guidegen", "stylize", "tradeoff", "info", "crosscheck"}) {
      Arguments arguments = {verb, "s.gltf", option, "Shot"};
      if (verb == "stylize" || verb == "tradeoff") arguments = With(arguments, {"--style", "oil"});
      if (verb == "stylize" || verb == "guidegen") arguments = With(arguments, {"-o", "g.exr"});
      ExpectErrorHere(arguments, 2, {option + " is for .blend scenes; s.gltf"});
      arguments[3] = "";
      ExpectErrorHere(arguments, 2, {option});
    }
  }
}

TEST_F(BlenderVerbs, WithoutTheScriptTheyAreNotBuiltIn) {
  fs::remove(At("home/blender_scripts"));
  ExpectErrorHere({"guidegen", Blend("lamps"), "-o", "g.exr"}, 5, {"lamps.blend", "export_scene.py is not found"});
}

}  // namespace
}  // namespace scumble
