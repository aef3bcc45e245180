// Scenes with animations on the command line: frames that depend only on their number, cameras and lights that are
// chosen once, the layer motion, several animations in one file, broken ones.
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"
#include "tests/support/gltf_builder.h"

namespace scumble {
namespace {

class CliMoving : public CliTest {
 protected:
  static std::string Toys() { return Scene("toys.glb"); }

  void WriteGlb(const std::string& name, const GltfBuilder& builder) {
    const std::vector<unsigned char> glb = builder.Glb();
    WriteText(name, std::string(glb.begin(), glb.end()));
  }

  // A wall 4 m wide and high before an orthographic camera that sees 10 m × 10 m: 1 m is a tenth of the picture. It
  // moves 2 m to the right within the second from 1 to 2.
  static GltfBuilder Wall(bool camera = true) {
    GltfBuilder b;
    const int position = b.Floats({-2, -2, 0, 2, -2, 0, 2, 2, 0, -2, 2, 0}, 3);
    const int mesh = b.Mesh({{{"attributes", {{"POSITION", position}}}, {"indices", b.Indices({0, 1, 2, 0, 2, 3})}}});
    const int wall = b.Root({{"name", "Wall"}, {"mesh", mesh}});
    if (camera) {
      b.Append("cameras",
               {{"type", "orthographic"}, {"orthographic", {{"xmag", 5}, {"ymag", 5}, {"znear", 0.1}, {"zfar", 100}}}});
      b.Root({{"name", "Eye"}, {"camera", 0}, {"translation", {0, 0, 10}}});
    }
    b.Animate(wall, "translation", {1, 2}, {0, 0, 0, 2, 0, 0});
    return b;
  }

  GuideSet Read(const std::string& name, const LayerSet& layers = AlwaysWritten()) {
    GuideReadOptions options;
    options.required = layers;
    Expected<GuideSet> guides = ReadGuides(At(name), options);
    EXPECT_TRUE(guides.ok()) << name;
    return guides ? std::move(*guides) : GuideSet();
  }
  // The first covered column of the middle row; the width where there is none.
  int LeftEdge(const std::string& name) {
    const GuideSet guides = Read(name);
    int x = 0;
    while (x < guides.width() && guides.Plane(Layer::kCoverage)[guides.Index(x, guides.height() / 2)] == 0.0f) ++x;
    return x;
  }
  static std::string Numbered(const std::string& start, int frame, const std::string& ending) {
    const std::string number = std::to_string(frame);
    return start + std::string(4 - number.size(), '0') + number + ending;
  }
};

TEST_F(CliMoving, AFrameIsTheSameHoweverTheRangeIsCut) {
  const Arguments guidegen = {"guidegen", Toys(), "--size", "96x54", "--layers", "motion,pref,luminance"};
  RunOk(With(guidegen, {"--frames", "1-24", "-o", "g.####.exr", "--threads", "4"}));
  for (int frame = 2; frame <= 24; ++frame) {
    EXPECT_FALSE(Layers(Numbered("g.", frame, ".exr")) == Layers(Numbered("g.", frame - 1, ".exr"))) << "stands still";
  }
  RunOk(With(guidegen, {"--frame", "7", "-o", "one.exr", "--threads", "1"}));
  EXPECT_EQ(Bytes("one.exr"), Bytes("g.0007.exr"));
  RunOk(With(guidegen, {"--frames", "24-1x-5,7", "-o", "b.####.exr", "--threads", "1"}));
  for (const int frame : {24, 19, 14, 9, 4, 7}) {
    EXPECT_EQ(Bytes(Numbered("b.", frame, ".exr")), Bytes(Numbered("g.", frame, ".exr"))) << frame;
  }
  std::filesystem::remove(At("g.0003.exr"));
  WriteText("g.0005.exr", "");
  const CommandResult resumed = RunOk(With(guidegen, {"--frames", "1-6", "--resume", "-o", "g.####.exr", "--json"}));
  const nlohmann::json report = resumed.Json();
  EXPECT_EQ(report["kept"], 4);
  for (const auto& frame : report["frames"]) {
    const bool made = frame["frame"] == 3 || frame["frame"] == 5;
    EXPECT_EQ(frame["state"], made ? "made" : "kept");
    if (!made) continue;
    EXPECT_TRUE(frame["ms"].contains("move"));
    EXPECT_EQ(frame["ms"].contains("load"), frame["frame"] == 3) << "the file is read once";
  }
  RunOk(With(guidegen, {"--frame", "5", "-o", "one.exr"}));
  EXPECT_EQ(Bytes("one.exr"), Bytes("g.0005.exr"));

  WriteStyle("style");
  const Arguments stylize = {"stylize", Toys(), "--style", "style", "--size", "96x54"};
  RunOk(With(stylize, {"--frames", "6-8", "-o", "p.####.png", "--threads", "4"}));
  RunOk(With(stylize, {"--frame", "7", "-o", "one.png", "--threads", "1"}));
  EXPECT_EQ(Bytes("one.png"), Bytes("p.0007.png"));
  EXPECT_FALSE(Pixels("p.0006.png") == Pixels("p.0007.png"));
  RunOk({"transfer", "g.####.exr", "--style", "style", "--frame", "7", "-o", "two.png"});
  EXPECT_EQ(Bytes("two.png"), Bytes("p.0007.png")) << "through a guide file";
}

TEST_F(CliMoving, FrameNIsAtNOverFps) {
  WriteGlb("wall.glb", Wall());
  const auto edge = [&](const std::string& frame, const std::string& fps) {
    RunOk({"guidegen", "wall.glb", "--size", "100", "--frame", frame, "--fps", fps, "-o", "g.exr"});
    return LeftEdge("g.exr");
  };
  // At rest the wall covers columns 30 to 69; a metre is ten of them. Still before its first key and after its last.
  const std::map<std::pair<std::string, std::string>, int> expected = {
      {{"0", "24"}, 30},   {{"-48", "24"}, 30}, {{"24", "24"}, 30}, {{"36", "24"}, 40},           {{"48", "24"}, 50},
      {{"480", "24"}, 50}, {{"36", "48"}, 30},  {{"15", "10"}, 40}, {{"48000", "24000/1001"}, 50}};
  for (const auto& [frame, column] : expected) EXPECT_EQ(edge(frame.first, frame.second), column) << frame.first;
  // Without a frame's number the scene is at rest, with a message.
  const CommandResult rest = RunOk({"guidegen", "wall.glb", "--size", "100", "-o", "g.exr"});
  EXPECT_NE(rest.Warning().find("animations are not played without a frame's number"), std::string::npos) << rest.err;
  EXPECT_EQ(RunOk({"guidegen", "wall.glb", "--size", "9", "--frame", "1", "-o", "g.exr"}).Warning(), "");
}

// Files keep the times of keys as floats, of which 7/24 and others are larger than the quotient.
TEST_F(CliMoving, AJumpAtAFramesKeyIsInThatFrame) {
  std::vector<float> times, places;
  for (int frame = 1; frame <= 24; ++frame) {
    times.push_back(static_cast<float>(frame / 24.0));
    for (const float at : {0.1f * frame, 0.0f, 0.0f}) places.push_back(at);
  }
  GltfBuilder b = Wall();
  b.json.erase("animations");
  b.Animate(0, "translation", times, places, "STEP");
  WriteGlb("steps.glb", b);
  RunOk({"guidegen", "steps.glb", "--size", "100", "--frames", "1-24", "-o", "s.####.exr"});
  for (int frame = 1; frame <= 24; ++frame) EXPECT_EQ(LeftEdge(Numbered("s.", frame, ".exr")), 30 + frame) << frame;
}

TEST_F(CliMoving, MotionIsInPixelsToTheNextFrame) {
  WriteGlb("wall.glb", Wall());
  const Arguments guidegen = {"guidegen", "wall.glb", "--size", "100", "--layers", "motion"};
  // 2 m in 10 frames: two pixels each, whatever the step of the range.
  RunOk(With(guidegen, {"--fps", "10", "--frames", "9-21x2", "-o", "g.####.exr"}));
  for (int frame = 9; frame <= 21; frame += 2) {
    const GuideSet guides = Read(Numbered("g.", frame, ".exr"), AlwaysWritten().Add(Layer::kMotion));
    const bool moves = frame >= 10 && frame < 20;
    const std::size_t middle = guides.Index(60, 50);
    EXPECT_NEAR(guides.Plane(Layer::kMotion, 0)[middle], moves ? 2.0 : 0.0, 1e-4) << frame;
    EXPECT_EQ(guides.Plane(Layer::kMotion, 1)[middle], 0.0f);
    EXPECT_EQ(guides.Plane(Layer::kMotion, 0)[guides.Index(2, 2)], 0.0f) << "background";
  }
  RunOk(With(guidegen, {"--fps", "10", "--frame", "13", "-o", "one.exr"}));
  EXPECT_EQ(Bytes("one.exr"), Bytes("g.0013.exr"));
  // What stands still moves by nothing at all.
  GltfBuilder still = Wall();
  still.json.erase("animations");
  WriteGlb("still.glb", still);
  RunOk({"guidegen", "still.glb", "--size", "20", "--layers", "motion", "--frames", "1-2", "-o", "q#.exr"});
  EXPECT_EQ(Bytes("q1.exr"), Bytes("q2.exr"));
  const GuideSet none = Read("q1.exr", AlwaysWritten().Add(Layer::kMotion));
  for (const float value : none.Plane(Layer::kMotion, 0)) ASSERT_EQ(value, 0.0f);
  ExpectError({"guidegen", "wall.glb", "--layers", "motion", "-o", "x.exr"}, 2, {"motion", "--frame N", "--frames"});
}

TEST_F(CliMoving, CameraAndKeyLightAreDecidedAtTimeZero) {
  GltfBuilder b = Wall(false);
  WriteGlb("bare.glb", b);
  const Arguments guidegen = {"guidegen", "bare.glb", "--size", "64", "--fps", "10", "--layers", "luminance,position"};
  const CommandResult range = RunOk(With(guidegen, {"--frames", "5-20x15", "-o", "g.####.exr"}));
  EXPECT_NE(range.err.find("has no camera"), std::string::npos) << range.err;
  EXPECT_EQ(range.err.find("has no light"), range.err.rfind("has no light")) << "said once";
  RunOk(With(guidegen, {"--frame", "20", "-o", "one.exr"}));
  EXPECT_EQ(Bytes("one.exr"), Bytes("g.0020.exr"));
  const GuideSet early = Read("g.0005.exr"), late = Read("g.0020.exr");
  EXPECT_EQ(early.camera->view_from_world, late.camera->view_from_world) << "the camera does not follow";
  EXPECT_GT(LeftEdge("g.0020.exr"), LeftEdge("g.0005.exr")) << "but the wall moves";
  // Frames before the first key are the scene at time 0, framed as it always is.
  b.json.erase("animations");
  WriteGlb("bare.glb", b);
  RunOk(With(guidegen, {"-o", "still.exr"}));
  EXPECT_TRUE(Layers("still.exr") == Layers("g.0005.exr"));

  // A camera of the file goes where the file sends it, by name as well.
  GltfBuilder eye = Wall();
  eye.json.erase("animations");
  eye.Animate(1, "translation", {1, 2}, {0, 0, 10, 2, 0, 10});
  WriteGlb("eye.glb", eye);
  for (const Arguments& more : {Arguments{}, Arguments{"--camera", "Eye"}}) {
    RunOk(With({"guidegen", "eye.glb", "--size", "100", "--fps", "10", "--frame", "15", "-o", "e.exr"}, more));
    EXPECT_EQ(LeftEdge("e.exr"), 20);
  }
}

TEST_F(CliMoving, SeveralAnimationsInOneFile) {
  GltfBuilder b = Wall();
  b.Animate(0, "translation", {1, 2}, {0, 0, 0, 0, 1, 0});
  nlohmann::json& first = b.json["animations"][0];
  b.json["animations"].push_back({{"name", "Rise"},
                                  {"channels", {{{"sampler", 0}, {"target", first["channels"][1]["target"]}}}},
                                  {"samplers", {first["samplers"][1]}}});
  b.json["animations"][0]["channels"].erase(1);
  b.json["animations"][0]["name"] = "Slide";
  WriteGlb("two.glb", b);
  const Arguments guidegen = {"guidegen", "two.glb", "--size", "100", "--frame", "48", "-o", "g.exr"};
  const CommandResult plain = RunOk(guidegen);
  EXPECT_EQ(LeftEdge("g.exr"), 50);
  for (const char* words : {"only the first of the 2 animations", "'Slide'"}) {
    EXPECT_NE(plain.Warning().find(words), std::string::npos) << plain.err;
  }
  EXPECT_EQ(RunOk(With(guidegen, {"--animation", "Slide"})).Warning(), "");
  EXPECT_EQ(LeftEdge("g.exr"), 50);
  RunOk(With(guidegen, {"--animation", "Rise"}));
  EXPECT_EQ(LeftEdge("g.exr"), 30);
  ExpectError(With(guidegen, {"--animation", "Fall"}), 2, {"two.glb", "\"Fall\"", "\"Slide\", \"Rise\"", "\"*\""});
  ExpectError({"guidegen", "two.glb", "--animation", "Rise", "-o", "g.exr"}, 2, {"--animation", "--frame N"});
  WriteText("none.gltf", TriangleGltf(false));
  ExpectError({"guidegen", "none.gltf", "--animation", "Rise", "--frame", "1", "-o", "g.exr"}, 2, {"none at all"});
  ExpectError({"guidegen", "shot.blend", "--animation", "Rise", "--frame", "1", "-o", "g.exr"}, 2, {"shot.blend"});
  const nlohmann::json info = RunOk({"info", "two.glb", "--json"}).Json();
  EXPECT_EQ(info["animations"], nlohmann::json({"Slide", "Rise"}));
  EXPECT_EQ(info["seconds"], 2.0);
}

TEST_F(CliMoving, BrokenAnimationsAreNamed) {
  WriteStyle("style");
  const auto refuse = [&](const GltfBuilder& b, const std::vector<std::string>& words) {
    WriteGlb("bad.glb", b);
    for (const Arguments& verb :
         {Arguments{"guidegen", "bad.glb"}, Arguments{"stylize", "bad.glb", "--style", "style"}}) {
      const std::string output = verb[0] == "guidegen" ? "#.exr" : "#.png";
      ExpectError(With(verb, {"--size", "16", "--frames", "1-3", "-o", output}), 3, words);
      ExpectError(With(verb, {"--size", "16", "--frame", "2", "-o", output}), 3, words);
    }
    // At rest it can be cast and inspected.
    RunOk({"guidegen", "bad.glb", "--size", "16", "-o", "rest.exr"});
    EXPECT_NE(RunOk({"info", "bad.glb"}).out.find(words.back()), std::string::npos);
  };
  GltfBuilder nan = Wall();
  nan.json.erase("animations");
  nan.Animate(0, "translation", {1, 2}, {0, 0, 0, NAN, 0, 0});
  refuse(nan, {"bad.glb", "channel 0", "NaN", "export it again"});
  GltfBuilder lost = Wall();
  lost.json["animations"][0]["samplers"][0]["output"] = 99;
  refuse(lost, {"bad.glb", "accessor 99"});
  // A camera that an animation flattens fails in those frames alone.
  GltfBuilder flat = Wall();
  flat.Animate(1, "scale", {0, 1, 2}, {1, 1, 1, 1, 1, 1, 0, 0, 0}, "STEP");
  WriteGlb("flat.glb", flat);
  const CommandResult some =
      Run({"guidegen", "flat.glb", "--size", "16", "--fps", "1", "--frames", "1-3", "-o", "f#.exr"});
  EXPECT_EQ(some.code, 3);
  EXPECT_NE(some.Error().find("2 of 3 frames were not made: 2-3"), std::string::npos) << some.err;
  EXPECT_NE(some.Error().find("fix the animation"), std::string::npos) << some.err;
  EXPECT_TRUE(Exists("f1.exr"));
}

TEST_F(CliMoving, AStillSceneIsCastOnce) {
  const nlohmann::json still =
      RunOk({"guidegen", Scene("stilllife.glb"), "--size", "32", "--frames", "1-3", "-o", "s#.exr", "--json"}).Json();
  EXPECT_TRUE(still["frames"][0]["ms"].contains("rays"));
  EXPECT_FALSE(still["frames"][1]["ms"].contains("rays"));
  EXPECT_EQ(Bytes("s1.exr"), Bytes("s3.exr"));
  WriteText("s.gltf", TriangleGltf(false));
  RunOk({"guidegen", "s.gltf", "--size", "16", "--frame", "3", "-o", "at.exr"});
  RunOk({"guidegen", "s.gltf", "--size", "16", "-o", "rest.exr"});
  EXPECT_EQ(Bytes("at.exr"), Bytes("rest.exr"));
}

}  // namespace
}  // namespace scumble
