// Bad inputs: files that are missing, truncated or damaged, full disks, scenes without geometry. Each has its exit code
// and a message that names the file.
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

class CliBadFiles : public CliTest {
 protected:
  // `whole` is a file that the command takes; IN stands for its name. Missing, empty, cut short and damaged ones of the
  // same ending must each fail with exit code 3 and the file's name, and write nothing.
  void ExpectOnlyWholeFilesTaken(const std::string& whole, Arguments command) {
    const std::string ending = fs::path(whole).extension(), bytes = Bytes(whole);
    ASSERT_EQ(RunOn(command, whole).code, 0) << whole;
    fs::remove(At("out.png"));
    std::string damaged = bytes;
    for (std::size_t i = 8; i < bytes.size(); i += 5) damaged[i] = static_cast<char>(damaged[i] ^ 0x5a);
    WriteText("empty" + ending, "");
    WriteText("cut" + ending, bytes.substr(0, bytes.size() * 2 / 3));
    WriteText("damaged" + ending, damaged);
    WriteText("noise" + ending, Noise(600));
    for (const char* stem : {"missing", "empty", "cut", "damaged", "noise"}) ExpectRefused(command, stem + ending);
  }

  void ExpectRefused(Arguments command, const std::string& name) {
    const CommandResult result = RunOn(command, name);
    EXPECT_EQ(result.code, 3) << name << "\n" << result.err;
    EXPECT_TRUE(Contains(result.Error(), name)) << name << "\n" << result.err;
    EXPECT_EQ(result.out, "") << name;
    EXPECT_FALSE(fs::remove(At("out.png"))) << name;
  }

  static std::string Noise(std::size_t count) {
    std::string noise;
    for (std::size_t i = 0; i < count; ++i) noise += static_cast<char>(Hash(i) >> 56);
    return noise;
  }

 private:
  CommandResult RunOn(Arguments command, const std::string& name) {
    for (std::string& argument : command) {
      if (argument == "IN") argument = name;
    }
    return Run(command);
  }
};

TEST_F(CliBadFiles, Scenes) {
  WriteStyle("style");
  const Arguments stylize = {"stylize", "IN", "--size", "16", "--style", "style", "-o", "out.png"};
  fs::copy_file(Scene("suzanne.glb"), At("whole.glb"));
  ExpectOnlyWholeFilesTaken("whole.glb", stylize);
  WriteText("whole.gltf", TriangleGltf(false));
  ExpectOnlyWholeFilesTaken("whole.gltf", stylize);
  WriteText("whole.ply", TrianglePly());
  ExpectOnlyWholeFilesTaken("whole.ply", stylize);
  // Any part of an OBJ file is an OBJ file; what gives a broken one away are faces without their vertices.
  WriteText("short.obj", TriangleObj().substr(TriangleObj().find('\n') + 1));
  WriteText("empty.obj", "");
  for (const char* name : {"short.obj", "empty.obj", "missing.obj"}) ExpectRefused(stylize, name);
}

TEST_F(CliBadFiles, ScenesThatAreNone) {
  WritePainted("picture.png", 8, 8);
  ExpectError({"stylize", "picture.png", "--style", "picture.png", "-o", "out.png"}, 3,
              {"picture.png has the ending '.png'", ".glb, .gltf, .obj, .ply or .blend"});
  WriteText("scene.blend", "BLENDER-v304");
  ExpectError({"stylize", "scene.blend", "--blender", "no/blender", "--style", "picture.png", "-o", "out.png"}, 5,
              {"scene.blend", "export", ".glb"});
  WriteText("lost.gltf", TriangleGltf(false).replace(TriangleGltf(false).find("data:"), 40, "lost.bin\"}]} "));
  ExpectError({"info", "lost.gltf"}, 3, {"lost.gltf"});
}

TEST_F(CliBadFiles, Exemplars) {
  WriteGuideFile("g.exr", Ball(16));
  const Arguments transfer = {"transfer", "g.exr", "--style", "IN", "-o", "out.png"};
  for (const char* name : {"whole.png", "whole.jpg", "whole.tif", "whole.exr"}) {
    WritePainted(name, 64, 64);
    ExpectOnlyWholeFilesTaken(name, transfer);
  }
  WritePainted("lit.png", 64, 64);
  WriteText("whole.toml", "name = \"whole\"\n[[exemplar]]\nimage = \"lit.png\"\n");
  ExpectOnlyWholeFilesTaken("whole.toml", transfer);
}

TEST_F(CliBadFiles, Guides) {
  WriteStyle("style");
  WriteGuideFile("whole.exr", Ball(32));
  ExpectOnlyWholeFilesTaken("whole.exr", {"transfer", "IN", "--style", "style", "-o", "out.png"});
  for (const char* name : {"missing.exr", "empty.exr", "noise.exr"}) ExpectRefused({"info", "IN"}, name);
}

// The attribute's pixels and values are behind everything that makes the file whole.
TEST_F(CliBadFiles, FragmentsOfGuides) {
  WriteStyle("style");
  RunOk({"guidegen", Scene("toys.glb"), "--size", "48x32", "--aa", "4", "--compression", "none", "-o", "whole.exr"});
  const std::string whole = Bytes("whole.exr"), type("scumbleFragments", 17);  // with its end
  const std::size_t header = whole.find(type) + type.size() + 4,
                    names = whole.find(std::string("A\0normal.X", 10), header);
  ASSERT_LT(names, whole.size());
  const auto expect_refused = [&](std::size_t at, char bits, bool by_info, const std::string& what) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ bits);
    WriteText("damaged.exr", damaged);
    ExpectError({"transfer", "damaged.exr", "--style", "style", "-o", "out.png"}, 3,
                {"damaged.exr", what, "make the guides again with scumble guidegen"});
    if (by_info) ExpectError({"info", "damaged.exr"}, 3, {"damaged.exr", what});
  };
  expect_refused(header, 0x40, true, "has version 65");
  expect_refused(header + 4, 0x40, true, "of a picture of 112×32");
  expect_refused(header + 12, 0x01, true, "fragments of");
  expect_refused(whole.find(std::string("cells\0", 6), header) + 6 + 3, 0x40, false, "outside the picture");
  RunOk({"transfer", "whole.exr", "--style", "style", "-o", "out.png"});
}

TEST_F(CliBadFiles, PicturesUnderneathAndPaper) {
  WriteStyle("style");
  WriteGuideFile("g.exr", Ball(16));
  WritePainted("whole.png", 16, 16);
  ExpectOnlyWholeFilesTaken("whole.png", {"transfer", "g.exr", "--style", "style", "--over", "IN", "-o", "out.png"});
  WritePainted("wide.png", 17, 16);
  ExpectError({"transfer", "g.exr", "--style", "style", "--over", "wide.png", "-o", "out.png"}, 3,
              {"wide.png is 17×16", "g.exr is 16×16", "one size"});
  WriteText("tri.obj", TriangleObj());
  ExpectError({"stylize", "tri.obj", "--size", "20x10", "--style", "style", "--over", "wide.png", "-o", "out.png"}, 3,
              {"wide.png is 17×16", "tri.obj is 20×10"});
}

class CliBadContent : public CliTest {
 protected:
  Arguments Transfer(const std::string& guides, const std::string& style) {
    return {"transfer", guides, "--style", style, "-o", "out.png"};
  }
};

TEST_F(CliBadContent, ExemplarSizes) {
  WriteGuideFile("g.exr", Ball(16));
  WriteText("zero.ppm", "P6\n0 0\n255\n");
  ExpectError(Transfer("g.exr", "zero.ppm"), 3, {"zero.ppm"});
  WriteText("huge.ppm", "P6\n100000 100000\n255\n");
  ExpectError(Transfer("g.exr", "huge.ppm"), 3, {"huge.ppm", "100000"});
  WritePainted("wide.png", 32, 16);
  ExpectError(Transfer("g.exr", "wide.png"), 3, {"wide.png is 32×16", "square", "crop"});
  WritePainted("dot.png", 1, 1);
  RunOk(Transfer("g.exr", "dot.png"));
  const Expected<Picture> picture = ReadPicture(At("out.png"));
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->width, 16);
  EXPECT_EQ(picture->At(8, 8)[3], 65535);
}

// A picture painted over another template than its guides belong to.
TEST_F(CliBadContent, ExemplarThatDoesNotFitItsGuides) {
  RunOk({"sphere", "--size", "32", "-q", "-o", "kit"});
  WritePainted("kit/lit.png", 50, 50);
  ExpectError({"styles", "check", "kit"}, 3, {"lit.png is 50×50", "guides.exr are 32×32", "40×40"});
}

TEST_F(CliBadContent, MissingLayers) {
  WriteStyle("style");
  GuideSet guides = Ball(16);
  guides.Remove(Layer::kDepth);
  WriteGuideFile("flat.exr", guides);
  ExpectError(Transfer("flat.exr", "style"), 3, {"flat.exr has no layer depth", "It has A, normal, object"});
  // A style that does not look at edges needs no depth.
  RunOk(With(Transfer("flat.exr", "style"), {"--set", "transfer.edge_aware=false"}));
  WritePainted("picture.png", 16, 16);
  ExpectError(Transfer("picture.png", "style"), 3, {"picture.png has no layer normal, depth, object"});
  ExpectError(Transfer(Scene("suzanne.glb"), "style"), 3, {"suzanne.glb"});
  WriteGuideFile("ball.exr", Ball(16));
  ExpectError(With(Transfer("ball.exr", "style"), {"--view-layer", "bogus"}), 3,
              {"ball.exr has no view layer 'bogus'"});
}

TEST_F(CliBadContent, GuidesThatAreNoNumbers) {
  WriteStyle("style");
  struct Case {
    const char* name;
    Layer layer;
    float value;
    const char* says;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Case& bad :
       {Case{"nan.exr", Layer::kNormal, nan, "layer normal"}, Case{"zero.exr", Layer::kNormal, 0.0f, "layer normal"},
        Case{"far.exr", Layer::kDepth, nan, "layer depth"}, Case{"alpha.exr", Layer::kCoverage, 2.0f, "layer A"}}) {
    GuideSet guides = Ball(16);
    for (int c = 0; c < ChannelCount(bad.layer); ++c) {
      guides.Plane(bad.layer, c)[guides.Index(7, 9)] = guides.Plane(bad.layer, c)[guides.Index(8, 9)] = bad.value;
    }
    WriteGuideFile(bad.name, guides);
    ExpectError(Transfer(bad.name, "style"), 3, {bad.name, bad.says, "2 pixels, first at (7, 9)"});
  }
  EXPECT_FALSE(Exists("out.png"));
}

TEST_F(CliBadContent, UnknownStyles) {
  WriteGuideFile("g.exr", Ball(16));
  ExpectError(Transfer("g.exr", "bogus"), 3, {"there is no style 'bogus'", "bundled"});
  ExpectError(Transfer("g.exr", std::string(300, 'a')), 3, {"there is no style"});
  ExpectError({"info", "bogus"}, 3, {"there is no style 'bogus'"});
  ExpectError({"info", "toom"}, 3, {"did you mean toon?"});
  fs::create_directory(At("hollow"));
  ExpectError(Transfer("g.exr", "hollow"), 3, {"hollow", "style.toml"});
  WriteText("bad/style.toml", "[transfer]\nbogus = 1\n");
  ExpectError(Transfer("g.exr", "bad"), 3, {"bad/style.toml:2", "unknown key transfer.bogus", "blend_radius"});
  WriteText("syntax/style.toml", "name = \"x\"\nlicence\n");
  ExpectError(Transfer("g.exr", "syntax"), 3, {"syntax/style.toml:2", "not valid TOML"});
  WriteText("open/style.toml", "name = \"x\nlicence = \"y\"\n");
  ExpectError(Transfer("g.exr", "open"), 3, {"open/style.toml:1", "not closed"});
  ExpectError(With(Transfer("g.exr", "oil"), {"--set", "transfer.paper=white"}), 3,
              {"transfer.paper", "no such file", "#f4efe6"});
  WriteText("later/style.toml", "[transfer]\nmethod = \"stylit\"\n");
  ExpectError(Transfer("g.exr", "later"), 5, {"later/style.toml:2", "transfer.method", "not built"});
}

TEST_F(CliBadContent, ScenesThatShowNothing) {
  WriteStyle("style");
  WriteText("bare.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"name":"none","nodes":[]}]})");
  WriteText("away.gltf", TriangleGltf(true));
  for (const char* scene : {"bare.gltf", "away.gltf"}) {
    const CommandResult result =
        RunOk({"stylize", scene, "--size", "20x10", "--style", "style", "-q", "-o", "out.png"});
    EXPECT_TRUE(Contains(result.Warning(), scene)) << result.err;
    EXPECT_TRUE(Contains(result.Warning(), "picture is empty")) << result.err;
    EXPECT_EQ(result.err.find("warning"), result.err.rfind("warning")) << "said twice: " << result.err;
    const Expected<Picture> picture = ReadPicture(At("out.png"));
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->width, 20);
    for (std::size_t i = 3; i < picture->rgba.size(); i += 4) ASSERT_EQ(picture->rgba[i], 0);
    RunOk({"guidegen", scene, "--size", "20x10", "-q", "-o", "g.exr"});
    RunOk(Transfer("g.exr", "style"));
  }
  // From inside a body its walls are seen; from within a flat sheet, nothing or next to it.
  const CommandResult inside = Run({"stylize", Scene("suzanne.glb"), "--size", "20x10", "--style", "style", "--view",
                                    "0,0,0.001", "-o", "inside.png"});
  EXPECT_EQ(inside.code, 0) << inside.err;
  EXPECT_TRUE(Exists("inside.png"));
}

class CliBadOutput : public CliTest {
 protected:
  CliBadOutput() {
    WriteStyle("style");
    WriteGuideFile("g.exr", Ball(64));
    WriteText("tri.obj", TriangleObj());
    WriteText("file", "a regular file");
    WriteText("old.png", "old picture");
    WriteText("old.exr", "old guides");
    fs::create_directory(At("folder.png"));
    fs::create_symlink("/dev/full", At("full.png"));
    fs::create_symlink("/dev/full", At("full.exr"));
  }
  Arguments Transfer(const std::string& output) { return {"transfer", "g.exr", "--style", "style", "-o", output}; }
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(Work())) names.push_back(entry.path().filename());
    return names;
  }
};

TEST_F(CliBadOutput, NamesThatCannotBe) {
  ExpectError(Transfer("file/p.png"), 4, {"file", "Not a directory"});
  ExpectError(Transfer("folder.png"), 4, {"folder.png", "it is a folder"});
  ExpectError(Transfer("p.gif"), 2, {"p.gif", ".png, .tif, .jpg, .exr"});
  ExpectError(Transfer("p"), 2, {"cannot write p:", ".png, .tif, .jpg, .exr"});
  ExpectError(With(Transfer("p.png"), {"--bits", "32"}), 2, {"p.png", "only .exr takes 32"});
  ExpectError({"guidegen", "tri.obj", "--size", "8", "-q", "-o", "g.png"}, 2, {"g.png", "name it .exr"});
  ExpectError({"guidegen", "tri.obj", "--size", "8", "-q", "-o", "file/g.exr"}, 4, {"file", "Not a directory"});
  ExpectError({"sphere", "--size", "16", "-o", "file"}, 4, {"file", "Not a directory"});
  ExpectError({"compare", "style/lit.png", "style/lit.png", "-o", "folder.png"}, 4, {"folder.png", "it is a folder"});
  EXPECT_EQ(Bytes("file"), "a regular file");
}

TEST_F(CliBadOutput, AMissingFolderIsNotMade) {
  ExpectError(Transfer("new/p.png"), 4, {"new/p.png", "no folder", "make it first"});
  EXPECT_FALSE(fs::exists(At("new")));
}

TEST_F(CliBadOutput, FullDisks) {
  ExpectError(Transfer("full.png"), 4, {"full.png", "No space left on device"});
  ExpectError({"guidegen", "tri.obj", "--size", "8", "-q", "-o", "full.exr"}, 4, {"full.exr", "No space left"});
  ExpectError({"compare", "style/lit.png", "style/lit.png", "-q", "-o", "full.png"}, 4, {"full.png", "No space left"});
  EXPECT_TRUE(fs::is_symlink(At("full.png")));
  // A disk that fills up in the middle of a file: the old one stays, and no half of a new one.
  CommandSettings small_disk;
  small_disk.file_size_limit = 1000;
  const std::vector<std::string> before = Names();
  ExpectError(Transfer("old.png"), 4, {"old.png", "File too large"}, small_disk);
  ExpectError({"guidegen", "tri.obj", "--size", "64", "-q", "-o", "old.exr", "--compression", "none"}, 4,
              {"old.exr", "File too large"}, small_disk);
  EXPECT_EQ(Bytes("old.png"), "old picture");
  EXPECT_EQ(Bytes("old.exr"), "old guides");
  EXPECT_EQ(Names(), before);
}

TEST_F(CliBadOutput, StandardOutputThatTakesNothing) {
  const std::vector<Arguments> commands = {{"--help"},
                                           {"--version"},
                                           {"help"},
                                           {"styles", "--keys"},
                                           {"styles", "check", "style"},
                                           {"info", "g.exr"},
                                           {"compare", "g.exr", "g.exr"},
                                           {"sphere", "--size", "16", "-q", "-o", "kit"},
                                           {"guidegen", "tri.obj", "--size", "8", "-q", "-o", "new.exr"},
                                           Transfer("new.png")};
  CommandSettings full, closed;
  full.stdout_file = "/dev/full";
  closed.close_stdout = true;
  for (const Arguments& command : commands) {
    ExpectError(command, 4, {"cannot write to standard output"}, full);
  }
  for (const Arguments& command : {commands.front(), commands.at(8), commands.back()}) {
    ExpectError(command, 4, {"cannot write to standard output"}, closed);
  }
  // No printed text has been written to a file instead.
  EXPECT_TRUE(ReadPicture(At("new.png")));
  EXPECT_TRUE(ReadGuides(At("new.exr")));
}

// Of several mistakes, those in the arguments are reported before any file is opened.
TEST_F(CliBadContent, ArgumentsAreCheckedBeforeFiles) {
  const Arguments guidegen = {"guidegen", Scene("ball.glb"), "--style", "no-such-style"};
  ExpectError(guidegen, 2, {"-o FILE is required"});
  ExpectError(With(guidegen, {"-o", "g.exr", "--frames", "1-2"}), 2, {"is one file for 2 frames"});
  ExpectError(With(guidegen, {"-o", "g.exr", "--layers", "motion"}), 2, {"the layer motion", "--frame N"});
  ExpectError(With(guidegen, {"-o", "g.exr"}), 3, {"no-such-style"});
  ExpectError({"stylize", Scene("toys.glb"), "--style", "no-such-style", "--animation", "*", "-o", "p.png"}, 2,
              {"--animation plays with the frames' numbers"});
}

TEST_F(CliBadContent, CrosscheckNeedsWhatBlenderReads) {
  WriteText("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ExpectError({"crosscheck", "tri.obj"}, 3, {"tri.obj", ".glb"});
  const CommandResult gone = Run({"crosscheck", "gone.glb"});
  EXPECT_EQ(gone.code, 3);
  EXPECT_NE(gone.Error().find("gone.glb"), std::string::npos) << gone.err;
  EXPECT_NE(gone.Error().find("no such file"), std::string::npos) << gone.err;
  EXPECT_NE(gone.out.find("verdict: could not be compared"), std::string::npos) << gone.out;
  ExpectError({"crosscheck"}, 2, {"scenes"});
  ExpectError({"crosscheck", Scene("snail.glb"), "--size", "32x18", "--blender", "/no/blender", "-q"}, 5,
              {"/no/blender", "install Blender"});
}

}  // namespace
}  // namespace scumble
