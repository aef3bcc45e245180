// Only required work, from the command line: counts in --json and --explain. Unused pictures of a model are neither
// read nor missed, nor is the library that would read them.
#include <filesystem>
#include <string>

#include "tests/support/cli_harness.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

class CliRequired : public CliTest {
 protected:
  static constexpr std::size_t kSide = 24, kPixels = kSide * kSide;

  // The triangle of TriangleGltf with texture coordinates and the picture for its colour, under a sun that faces it.
  void WriteTextured(const std::string& picture) {
    nlohmann::json json = nlohmann::json::parse(TriangleGltf(false));
    json["images"] = {{{"uri", picture}}};
    json["textures"] = {{{"source", 0}}};
    json["materials"] = {{{"doubleSided", true}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    json["accessors"].push_back({{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC2"}});
    json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 1;
    json["meshes"][0]["primitives"][0]["material"] = 0;
    json["extensionsUsed"] = {"KHR_lights_punctual"};
    json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}, {"intensity", 683.0}}};
    json["nodes"].push_back({{"name", "Sun"}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    json["scenes"][0]["nodes"].push_back(2);
    WriteText("scene.gltf", json.dump());
  }
  void WriteStyles() {
    WriteStyle("plain");
    WritePainted("lit/light.png", 64, 64), WritePainted("lit/dark.png", 64, 64);
    WriteText("lit/style.toml",
              "[transfer]\nreference_height = 0\nlevels = 4\n[[exemplar]]\nimage = \"light.png\"\nluminance = 0.8\n"
              "[[exemplar]]\nimage = \"dark.png\"\nluminance = 0.1\n");
  }
  static Arguments Stylize(const std::string& style, const Arguments& more = {}, const std::string& output = "p.png") {
    return With({"stylize", "scene.gltf", "--style", style, "--size", std::to_string(kSide), "-o", output, "--json"},
                more);
  }
  std::size_t FileSize(const std::string& name) const { return fs::file_size(At(name)); }
};

TEST_F(CliRequired, EachStylePaysForItsOwn) {
  WritePainted("paint.png", 4, 4);
  WriteTextured("paint.png");
  WriteStyles();
  const auto plain = RunOk(Stylize("plain")).Json();
  const std::size_t covered = plain["covered_pixels"];
  ASSERT_GT(covered, 0u);
  constexpr std::size_t kAlways = 7;  // channels of A, normal, depth, object and material
  const auto expect = [&](const nlohmann::json& json, std::size_t channels, std::size_t shadow, std::size_t materials) {
    EXPECT_EQ(json["rays"]["primary"], kPixels);
    EXPECT_EQ(json["rays"]["coverage"], 0u);
    EXPECT_EQ(json["rays"]["shadow"], shadow);
    EXPECT_EQ(json["rays"]["bounce"], 0u);
    EXPECT_EQ(json["work"]["light_samples"], shadow);
    EXPECT_EQ(json["work"]["materials"], materials);
    EXPECT_EQ(json["work"]["texture_lookups"], materials);
    EXPECT_EQ(json["work"]["texels"], 4 * materials);
    EXPECT_EQ(json["work"]["textures_decoded"], materials ? 1 : 0);
    EXPECT_EQ(json["work"]["texture_bytes"], materials ? 4 * 4 * 8 : 0);
    EXPECT_EQ(json["work"]["plane_bytes"], channels * kPixels * sizeof(float));
    EXPECT_EQ(json["work"]["openimageio"], false);
    EXPECT_EQ(json["work"]["bytes_written"], FileSize("p.png"));
  };
  expect(plain, kAlways, 0, 0);
  expect(RunOk(Stylize("plain", {"--set", "transfer.colorize=0.5"})).Json(), kAlways + 3, 0, covered);
  expect(RunOk(Stylize("lit")).Json(), kAlways + 1, covered, 0);
  expect(RunOk(Stylize("lit", {"--set", "transfer.colorize=1"})).Json(), kAlways + 4, covered, covered);
}

TEST_F(CliRequired, LayersInTheFileAreThoseAskedFor) {
  WritePainted("paint.png", 4, 4);
  WriteTextured("paint.png");
  WriteStyles();
  const Arguments guidegen = {"guidegen", "scene.gltf", "--size", std::to_string(kSide), "-o", "g.exr", "--json"};
  const auto layers = [&](const Arguments& more) {
    const auto json = RunOk(With(guidegen, more)).Json();
    EXPECT_EQ(json["work"]["bytes_written"], FileSize("g.exr"));
    EXPECT_EQ(json["layers"], RunOk({"info", "g.exr", "--json"}).Json()["layers"]);
    return json["layers"].get<std::string>();
  };
  const std::string always = AlwaysWritten().ToString();
  EXPECT_EQ(layers({}), always);
  EXPECT_EQ(layers({"--style", "plain"}), always);
  EXPECT_EQ(layers({"--style", "lit"}), LayerSet(AlwaysWritten()).Add(Layer::kLuminance).ToString());
  EXPECT_EQ(layers({"--style", "plain", "--set", "transfer.colorize=1"}),
            LayerSet(AlwaysWritten()).Add(Layer::kAlbedo).ToString());
  // A scene of one flat sheet has no path LDDE of any length, nor a light seen in its own mirror.
  const auto paths = RunOk(With(guidegen, {"--layers", "lpe.LDE", "--samples", "3"})).Json();
  EXPECT_EQ(paths["rays"]["bounce"], 0u);
}

TEST_F(CliRequired, PicturesThatNoStyleAsksForAreNotMissed) {
  WriteTextured("lost.png");
  WriteStyles();
  for (const char* style : {"plain", "lit"}) {
    const CommandResult run = RunOk(Stylize(style));
    EXPECT_EQ(run.err.find("lost.png"), std::string::npos) << run.err;
  }
  ExpectError(Stylize("plain", {"--set", "transfer.colorize=1"}), 3,
              {"scene.gltf", "lost.png", "put it beside the scene"});
  ExpectError({"guidegen", "scene.gltf", "--size", "8", "--layers", "albedo", "-o", "g.exr"}, 3, {"lost.png"});
  EXPECT_FALSE(Exists("g.exr"));
  ExpectError({"info", "scene.gltf"}, 3, {"lost.png"});
  // A range of frames ends as a single one does.
  ExpectError(Stylize("plain", {"--set", "transfer.colorize=1", "--frames", "1-2"}, "q#.png"), 3, {"lost.png"});
}

// Only OpenImageIO reads JPEG. Without that library, styles of normals and of light still work.
TEST_F(CliRequired, TheLibraryOfPicturesIsOpenedWhereItIsNeeded) {
  WriteText("photo.jpg", "\xFF\xD8\xFF\xE0 the rest is never read");
  WriteTextured("photo.jpg");
  WriteStyles();
  const CommandSettings settings = CopyProgram("home/bin");
  fs::remove(At("home/bin") / "libscumble_formats.so");
  for (const char* style : {"plain", "lit"}) {
    const CommandResult run = Run(Stylize(style), settings);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.Json()["work"]["openimageio"], false);
  }
  ExpectError(Stylize("plain", {"--set", "transfer.colorize=1"}), 5, {"libscumble_formats.so"}, settings);
}

TEST_F(CliRequired, OfASequenceOnlyTheFrameThatCastsPays) {
  WritePainted("paint.png", 4, 4);
  WriteTextured("paint.png");
  WriteStyles();
  const auto json = RunOk(Stylize("plain", {"--frames", "1-2", "--set", "transfer.colorize=1"}, "p#.png")).Json();
  ASSERT_EQ(json["frames"].size(), 2u);
  EXPECT_EQ(json["frames"][0]["rays"]["primary"], kPixels);
  EXPECT_EQ(json["frames"][0]["work"]["textures_decoded"], 1);
  EXPECT_EQ(json["frames"][1]["rays"]["primary"], 0u) << "the scene stands still";
  EXPECT_EQ(json["frames"][1]["work"]["textures_decoded"], 0);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(json["frames"][i]["work"]["bytes_written"], FileSize("p" + std::to_string(i + 1) + ".png"));
  }
}

// What does not move is decoded once; a picture that is missing ends the whole sequence, with one sentence.
TEST_F(CliRequired, OfAMovingSceneTexturesAreDecodedForAllFrames) {
  WritePainted("paint.png", 4, 4);
  const auto write = [&](const std::string& picture) {
    WriteTextured(picture);
    nlohmann::json json = nlohmann::json::parse(Bytes("scene.gltf"));
    // The triangle's own numbers, read as times 0 and 1 and as two places.
    json["accessors"].push_back(
        {{"bufferView", 0}, {"byteOffset", 24}, {"componentType", 5126}, {"count", 2}, {"type", "SCALAR"}});
    json["accessors"].push_back({{"bufferView", 0}, {"componentType", 5126}, {"count", 2}, {"type", "VEC3"}});
    json["animations"] = {{{"samplers", {{{"input", 2}, {"output", 3}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
    WriteText("scene.gltf", json.dump());
  };
  write("paint.png");
  WriteStyles();
  const Arguments frames = Stylize("plain", {"--frames", "1-3", "--set", "transfer.colorize=1"}, "p#.png");
  const auto json = RunOk(frames).Json();
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(json["frames"][i]["rays"]["primary"], kPixels);
    EXPECT_EQ(json["frames"][i]["work"]["textures_decoded"], i == 0 ? 1 : 0);
    EXPECT_EQ(json["frames"][i]["work"]["materials"], json["frames"][i]["covered_pixels"]);
  }
  write("lost.png");
  const CommandResult lost = ExpectError(frames, 3, {"scene.gltf: image 0 'lost.png'"});
  EXPECT_EQ(lost.err.find("lost.png"), lost.err.rfind("lost.png")) << lost.err;
}

TEST_F(CliRequired, ThePlanSaysWhichPicturesAreDecodedAndWhatWasTaken) {
  WritePainted("paint.png", 4, 4);
  WriteTextured("paint.png");
  WriteStyles();
  const Arguments plan = {"stylize", "scene.gltf", "--style", "plain", "--explain", "--size", std::to_string(kSide)};
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(RunOk(plan).out, "none of 1 decoded"));
  EXPECT_FALSE(has(RunOk(plan).out, "taken:")) << "nothing was";
  const std::string made = RunOk(With(plan, {"--set", "transfer.colorize=1", "-o", "p.png"})).out;
  EXPECT_TRUE(has(made, "1 of 1 decoded")) << made;
  EXPECT_TRUE(has(made, "taken: " + std::to_string(kPixels) + " primary rays, 0 for coverage, 0 for shadows")) << made;
  EXPECT_FALSE(has(RunOk(Stylize("plain")).out, "taken:"));
}

}  // namespace
}  // namespace scumble
