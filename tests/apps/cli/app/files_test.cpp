// Files of a run: outputs that would replace inputs, files that --resume keeps, and messages about wrong files or
// options without effect.
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

class CliFiles : public CliTest {
 protected:
  static int Count(const std::string& text, const std::string& part) {
    int count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
    return count;
  }
  void WriteBalls(int frames) {
    for (int frame = 1; frame <= frames; ++frame) WriteGuideFile("g." + std::to_string(frame) + ".exr", Ball(32));
  }
  const Arguments transfer_ = {"transfer", "g.#.exr", "--style", "style"};
};

TEST_F(CliFiles, NoOutputTakesThePlaceOfAnInput) {
  WriteStyle("style");
  WriteBalls(2);
  WritePainted("over.png", 32, 32);
  fs::create_symlink("over.png", At("link.png"));
  fs::create_hard_link(At("over.png"), At("twin.png"));
  fs::create_directory(At("folder"));
  const std::string over = Bytes("over.png"), guides = Bytes("g.2.exr"), lit = Bytes("style/lit.png");
  const Arguments range = With(transfer_, {"--frames", "1-2"});
  ExpectError(With(range, {"-o", "g.#.exr"}), 2, {"-o g.1.exr", "overwrite the guides"});
  ExpectError(With(range, {"-o", "g.%d.exr"}), 2, {"-o g.1.exr"});
  ExpectError(With(transfer_, {"--frame", "2", "-o", "folder/../g.#.exr"}), 2,
              {"folder/../g.2.exr", "by the name g.2.exr"});
  // Another frame's input counts too.
  ExpectError({"transfer", "g.1.exr", "--style", "style", "--over", "g.2.exr", "--frames", "1-2", "-o", "g.#.exr"}, 2,
              {"g.1.exr"});
  const Arguments one = {"transfer", "g.1.exr", "--style", "style", "--over", "over.png"};
  for (const std::string name : {"over.png", "./over.png", "link.png", "twin.png"}) {
    ExpectError(With(one, {"-o", name}), 2, {"-o " + name, "overwrite the picture of --over"});
  }
  ExpectError(With(one, {"-o", "style/lit.png"}), 2, {"overwrite a file of the style test"});
  ExpectError({"compare", "over.png", "style/lit.png", "-o", "link.png"}, 2, {"-o link.png", "the first file"});
  EXPECT_EQ(Bytes("over.png"), over);
  EXPECT_EQ(Bytes("g.2.exr"), guides);
  EXPECT_EQ(Bytes("style/lit.png"), lit);
  RunOk(With(one, {"-o", "new.png"}));
  RunOk(With(one, {"-o", "new.png"}));
}

TEST_F(CliFiles, NorThatOfFilesThatASceneNames) {
  WriteStyle("style");
  WriteText("tri.obj", "mtllib\ttri.mtl lost.mtl\nusemtl m\n" + TriangleObj());
  WriteText("tri.mtl", "newmtl m\nKd 1 1 1\nmap_Kd -s 1 1 1 skin.png\nmap_Ks\tgloss.png\n");
  WritePainted("skin.png", 8, 8);
  WritePainted("gloss.png", 8, 8);
  WritePainted("paper.png", 8, 8);
  const Arguments stylize = {"stylize", "tri.obj", "--style", "style", "--size", "16"};
  for (const std::string picture : {"skin.png", "gloss.png"}) {
    ExpectError(With(stylize, {"-o", picture}), 2, {picture, "overwrite a file of the scene tri.obj"});
  }
  ExpectError(With(stylize, {"--set", "transfer.paper=paper.png", "-o", "paper.png"}), 2, {"paper.png", "overwrite"});
  WriteText("tri.gltf",
            TriangleGltf(false).insert(1, R"("images":[{"uri" : "the%20skin.png"},{"uri":".\/skin.png"}],)"));
  WritePainted("the skin.png", 8, 8);
  for (const std::string name : {"the skin.png", "skin.png"}) {
    ExpectError({"stylize", "tri.gltf", "--style", "style", "--size", "16", "-o", name}, 2, {"overwrite"});
  }
}

// A .glb may leave pictures and buffers beside it, though exporters put them into it.
TEST_F(CliFiles, NorThatOfFilesThatABinarySceneNames) {
  WriteStyle("style");
  std::string text = TriangleGltf(false).insert(1, R"("images":[{"uri":"the%20skin.png"},{"uri":"gr\u00fcn.png"}],)");
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto word = [](std::size_t value) {
    std::string bytes;
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i));
    return bytes;
  };
  WriteText("tri.glb", "glTF" + word(2) + word(20 + text.size()) + word(text.size()) + "JSON" + text);
  const Arguments stylize = {"stylize", "tri.glb", "--style", "style", "--size", "16"};
  for (const std::string name : {"the skin.png", "gr\xc3\xbcn.png"}) {
    WritePainted(name, 8, 8);
    ExpectError(With(stylize, {"-o", name}), 2, {name, "overwrite a file of the scene tri.glb"});
  }
  RunOk(With(stylize, {"-o", "new.png"}));
}

// They are those that the loader looks for, wherever that is.
TEST_F(CliFiles, NorThatOfFilesInOtherFolders) {
  WriteStyle("style");
  fs::create_directory(At("tex"));
  WriteText("tri.obj", "mtllib tex\\tri.mtl\nusemtl m\n" + TriangleObj());
  WriteText("tex/tri.mtl", "newmtl m\nmap_Kd near.png\nmap_Ke far.png\n");
  std::string cloud = TrianglePly();
  WriteText("tri.ply", cloud.insert(cloud.find("element"), "comment TextureFile tex\\cloud.png\n"));
  for (const std::string name : {"tex/near.png", "far.png", "tex/cloud.png"}) WritePainted(name, 8, 8);
  const Arguments tail = {"--style", "style", "--size", "16", "-o"};
  const auto expect_refused = [&](const std::string& scene, const std::string& output) {
    const std::string before = Bytes(output);
    ExpectError(With(With({"stylize", scene}, tail), {output}), 2, {output, "overwrite a file of the scene " + scene});
    EXPECT_EQ(Bytes(output), before);
  };
  expect_refused("tri.obj", "tex/near.png");
  expect_refused("tri.obj", "far.png");
  expect_refused("tri.ply", "tex/cloud.png");
  ExpectError({"guidegen", "tri.obj", "--frames", "1-2", "--size", "16", "-o", "tex/tri.mtl"}, 2, {"tex/tri.mtl"});
  RunOk(With(With({"stylize", "tri.obj"}, tail), {"tex/new.png"}));
}

TEST_F(CliFiles, OutputsAreTriedBeforeTheWork) {
  WriteStyle("style");
  WriteBalls(3);
  fs::create_directory(At("p3.png"));
  const Arguments range = With(transfer_, {"--frames", "1-3"});
  ExpectError(With(range, {"-o", "p#.png"}), 4, {"p3.png", "folder"});
  EXPECT_FALSE(Exists("p1.png"));
  ExpectError(With(range, {"-o", "lost/p#.png"}), 4, {"lost", "make it first"});
  // The scene is not there either: the output comes first, so nothing was loaded.
  ExpectError({"guidegen", "lost.glb", "--frames", "1-2", "-o", "lost/g#.exr"}, 4, {"no folder lost"});
  ExpectError(With(range, {"--fps", "fast", "-o", "q#.png"}), 2, {"--fps fast"});
  ExpectError(With(range, {"--exposure", "bright", "-o", "q#.png"}), 2, {"--exposure bright"});
}

TEST_F(CliFiles, ResumeKeepsOnlyWhatWouldBeMade) {
  WriteStyle("style");
  WriteBalls(2);
  const auto kept = [&](const Arguments& more, const std::string& output) {
    return RunOk(With(With(transfer_, {"--frames", "1-2", "--json", "--resume", "-o", output}), more)).Json()["kept"];
  };
  for (const std::string output : {"p#.png", "p#.exr"}) {
    EXPECT_EQ(kept({}, output), 0);
    EXPECT_EQ(kept({}, output), 2);
    EXPECT_EQ(kept({"--threads", "3"}, output), 2);
    EXPECT_EQ(kept({"--seed", "7"}, output), 0);
    EXPECT_EQ(kept({"--show", "chunks", "--seed", "7"}, output), 0);
    EXPECT_EQ(kept({"--set", "transfer.threshold=0.3"}, output), 0);
    EXPECT_EQ(kept({"--set", "transfer.threshold=[[1, 0.3], [2, 0.4]]"}, output), 1) << "frame 1 is the same";
    EXPECT_EQ(kept({}, output), 0);
    WritePainted("style/lit.png", 48, 48);
    EXPECT_EQ(kept({}, output), 0) << "another exemplar";
    WritePainted("style/lit.png", 64, 64);
  }
  EXPECT_EQ(kept({"--bits", "16"}, "p#.png"), 0);
  EXPECT_EQ(kept({"--bits", "16"}, "p#.png"), 2);
  EXPECT_EQ(kept({"--bits", "32"}, "p#.exr"), 0);
  // What holds no settings is compared by size alone.
  EXPECT_EQ(kept({}, "p#.jpg"), 0);
  EXPECT_EQ(kept({"--seed", "7"}, "p#.jpg"), 2);
  // The message gives the reason.
  fs::resize_file(At("p2.png"), Bytes("p2.png").size() / 2);
  const CommandResult cut = RunOk(With(transfer_, {"--frames", "1-2", "--bits", "16", "--resume", "-o", "p#.png"}));
  EXPECT_TRUE(Contains(cut.err, "p2.png: the PNG file ends before its picture does")) << cut.err;
  EXPECT_TRUE(Contains(cut.err, "made again")) << cut.err;
  EXPECT_EQ(Count(cut.err, "\n"), 1) << "a library talks: " << cut.err;
}

TEST_F(CliFiles, ResumeOfGuides) {
  WriteText("tri.obj", TriangleObj());
  const auto kept = [&](const Arguments& more) {
    return RunOk(With({"guidegen", "tri.obj", "--size", "16", "--layers", "albedo", "--frames", "1-2", "--json",
                       "--resume", "-q", "-o", "g#.exr"},
                      more))
        .Json()["kept"];
  };
  EXPECT_EQ(kept({}), 0);
  EXPECT_EQ(kept({}), 2);
  EXPECT_EQ(kept({"--half"}), 0);
  EXPECT_EQ(kept({"--half"}), 2);
  EXPECT_EQ(kept({"--half", "--view", "10,10"}), 0);
  EXPECT_EQ(kept({"--half", "--view", "10,10", "--aa", "2"}), 0);
  EXPECT_EQ(kept({"--half", "--view", "10,10", "--aa", "2"}), 2);
}

TEST_F(CliFiles, WhatFailsInEveryFrameEndsTheRunAtOnce) {
  WriteStyle("style");
  WriteBalls(3);
  WritePainted("wide.png", 33, 32);
  GuideSet flat = Ball(32);
  flat.Remove(Layer::kNormal);
  WriteGuideFile("flat.exr", flat);
  const auto once = [&](const Arguments& arguments, const std::string& words) {
    const CommandResult result = Run(With(arguments, {"--style", "style", "--frames", "1-3", "-o", "p#.png"}));
    EXPECT_EQ(result.code, 3) << result.err;
    EXPECT_EQ(Count(result.err, words), 1) << result.err;
    EXPECT_FALSE(Contains(result.err, "were not made")) << result.err;
  };
  once({"transfer", "g.#.exr", "--over", "wide.png"}, "wide.png is 33×32");
  once({"transfer", "g.#.exr", "--over", "gone.png"}, "gone.png");
  once({"transfer", "flat.exr"}, "flat.exr has no layer normal");
  once({"transfer", "gone.exr"}, "gone.exr");
  once({"stylize", Scene("suzanne.glb"), "--size", "32", "--over", "wide.png"}, "wide.png is 33×32");
  // A layer that all guides of a range lack is reported once, and the end names all frames.
  for (int frame = 1; frame <= 3; ++frame) WriteGuideFile("f." + std::to_string(frame) + ".exr", flat);
  const CommandResult all = Run({"transfer", "f.#.exr", "--style", "style", "--frames", "1-3", "-o", "p#.png"});
  EXPECT_EQ(Count(all.err, "warning"), 1) << all.err;
  EXPECT_TRUE(Contains(all.Error(), "3 of 3 frames were not made: 1-3")) << all.err;
}

TEST_F(CliFiles, LibrariesKeepSilent) {
  WriteStyle("style");
  WriteBalls(1);
  const CommandResult many = RunOk(
      {"stylize", Scene("suzanne.glb"), "--size", "32", "--style", "style", "--threads", "7", "-q", "-o", "p.png"});
  EXPECT_EQ(many.err, "");
  for (const int cut : {20, 200, 2000}) {
    WriteText("cut.png", Bytes("style/lit.png").substr(0, std::size_t(cut)));
    const CommandResult result =
        ExpectError({"transfer", "g.1.exr", "--style", "style", "--over", "cut.png", "-o", "q.png"}, 3, {"cut.png"});
    EXPECT_EQ(Count(result.err, "\n"), 1) << result.err;
  }
  std::string damaged = Bytes("style/lit.png");
  damaged[damaged.size() / 2] ^= 1;
  WriteText("damaged.png", damaged);
  const CommandResult result =
      ExpectError({"transfer", "g.1.exr", "--style", "style", "--over", "damaged.png", "-o", "q.png"}, 3,
                  {"damaged.png", "damaged"});
  EXPECT_EQ(Count(result.err, "\n"), 1) << result.err;
}

TEST_F(CliFiles, ErrorsSayHowToMend) {
  WriteStyle("style");
  WriteBalls(2);
  const std::string whole = Bytes("g.2.exr");
  WriteText("g.2.exr", whole.substr(0, whole.size() * 2 / 3));
  const CommandResult cut = Run(With(transfer_, {"--frames", "1-2", "-o", "p#.png"}));
  EXPECT_EQ(cut.code, 3);
  EXPECT_EQ(Count(cut.Warning(), "g.2.exr"), 1) << cut.err;
  EXPECT_TRUE(Contains(cut.Warning(), "guidegen --resume")) << cut.err;
  ExpectError({"transfer", Scene("suzanne.glb"), "--style", "style", "-o", "p.png"}, 3,
              {"is a scene", "scumble stylize"});
  ExpectError({"transfer", "g.1.exr", "--style", Scene("suzanne.glb"), "-o", "p.png"}, 3, {"is a scene", "stylize"});
  WriteText("README.md", "text");
  ExpectError({"stylize", "README.md", "--style", "style", "-o", "p.png"}, 3, {"'.md'", ".ply or .blend"});
  fs::create_directory(At("folder"));
  ExpectError({"stylize", "folder", "--style", "style", "-o", "p.png"}, 3, {"folder is a folder"});
  ExpectError({"stylize", "bare", "--style", "style", "-o", "p.png"}, 3, {"no ending"});
  ExpectError({"stylize", "sim.####.glb", "--style", "style", "--frames", "1-2", "-o", "p#.png"}, 2,
              {"sim.####.glb", "--frame N"});
  const CommandResult plan = RunOk({"stylize", Scene("suzanne.glb"), "--style", "style", "--explain"});
  EXPECT_TRUE(Contains(plan.out, "normal")) << plan.out;
  EXPECT_TRUE(
      RunOk({"stylize", Scene("suzanne.glb"), "--style", "style", "--explain", "--json"}).Json()["plan"].is_array());
  ExpectError({"stylize", Scene("suzanne.glb"), "--style", "style"}, 2, {"-o FILE is required"});
}

TEST_F(CliFiles, OptionsThatDoNothingAreSaid) {
  WriteStyle("style");
  WriteBalls(3);
  ExpectError(With(transfer_, {"--frame", "1", "--bits", "16", "-o", "p.jpg"}), 2, {"p.jpg", "JPEG has 8"});
  const auto warned = [&](const Arguments& more, const std::string& words) {
    const CommandResult result = RunOk(With(With(transfer_, {"--frames", "1-3", "-o", "p#.png"}), more));
    EXPECT_TRUE(Contains(result.Warning(), words)) << result.err;
    EXPECT_EQ(Count(result.err, "warning"), words.empty() ? 0 : 1) << result.err;
  };
  warned({}, "");
  warned({"--exposure", "2"}, "--exposure 2 changes nothing");
  WriteGuideFile("g.2.exr", Ball(48));
  WriteGuideFile("g.3.exr", Ball(48));
  warned({}, "g.2.exr is 48×48, the frames before it are 32×32");
  for (const int frame : {1, 2, 3}) {
    GuideSet guides = Ball(32);
    guides.Add(Layer::kShadow);
    WriteGuideFile("g." + std::to_string(frame) + ".exr", guides);
  }
  warned({"--set", "transfer.shadow=paint"}, "no object catches shadows");
}

// The rate of the film goes with the guides, where --fps does not say another one.
TEST_F(CliFiles, GuidesTellTheirRate) {
  WriteStyle("style");
  GuideSet guides = Ball(48);
  WriteGuideFile("plain.exr", guides);
  guides.attributes["scumble:generator"] = "guidegen";
  guides.attributes["scumble:fps"] = "48";
  WriteGuideFile("fast.exr", guides);
  const auto shown = [&](const Arguments& more) {
    RunOk(With({"transfer"},
               With(more, {"--style", "style", "--set", "transfer.jitter_fps=12", "--frame", "3", "-o", "p.png"})));
    return Bytes("p.png");
  };
  EXPECT_EQ(shown({"fast.exr"}), shown({"plain.exr", "--fps", "48"}));
  EXPECT_EQ(shown({"fast.exr", "--fps", "24"}), shown({"plain.exr"}));
  EXPECT_NE(shown({"fast.exr"}), shown({"plain.exr"}));
}

}  // namespace
}  // namespace scumble
