// scumble crosscheck end to end: a small .blend and a sample scene, both sides rendered here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/blender/blender_version.h"
#include "tests/support/cli_harness.h"
#include "tests/support/gltf_builder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const std::string kSuzanne = SCUMBLE_SOURCE_DIR "/scenes/suzanne.glb";

std::map<std::string, Json> Figures(const Json& report) {
  std::map<std::string, Json> figures;
  for (const Json& figure : report["figures"]) {
    figures[figure["layer"].get<std::string>() + " " + figure["name"].get<std::string>()] = figure;
  }
  return figures;
}

std::string TextOf(const fs::path& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class CrosscheckBlender : public CliTest {
 protected:
  // 0 or 1, and one report a scene.
  Json Check(Arguments arguments, int code) {
    arguments.insert(arguments.begin(), "crosscheck");
    arguments.insert(arguments.end(), {"--json", "--quiet"});
    CommandSettings settings;
    settings.patience_seconds = 240;  // Blender renders
    const CommandResult result = Run(arguments, settings);
    EXPECT_EQ(result.code, code) << result.err << result.out;
    said_ = result.err;
    return result.Json();
  }
  // The scenes that make_crosscheck.py describes.
  void MakeScenes() {
    const std::string make = "blender -b -noaudio --factory-startup -P '" SCUMBLE_SOURCE_DIR
                             "/tests/blender/make_crosscheck.py' -- '" +
                             At("").string() + "' > '" + At("log").string() + "' 2>&1";
    ASSERT_EQ(std::system(make.c_str()), 0) << TextOf(At("log"));
  }
  GuideSet Guides(const std::string& file) {
    GuideReadOptions read;
    read.required = {Layer::kCoverage, Layer::kNormal, Layer::kObject};
    auto guides = ReadGuides(At(file), read);
    EXPECT_TRUE(guides.ok()) << guides.error().message;
    return guides ? *std::move(guides) : GuideSet(1, 1);
  }
  // The names of the objects.
  static std::set<std::string> SeenIn(const GuideSet& guides) {
    std::set<std::string> seen;
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      const auto name = guides.object_names.find(std::uint32_t(guides.Plane(Layer::kObject)[i]));
      if (name != guides.object_names.end()) seen.insert(name->second);
    }
    return seen;
  }
  std::string said_;
};

TEST_F(CrosscheckBlender, ASampleSceneAgreesKeepsItsGuidesAndItsBaseline) {
  const Arguments run{kSuzanne, "--size", "160x90"};
  Arguments first = run;
  first.insert(first.end(), {"--samples", "384", "--max-bounces", "3", "--keep", "kept", "-o", "report.html",
                             "--write-baseline", "b.json"});
  const Json reports = Check(first, 0);
  ASSERT_EQ(reports.size(), 1u);
  const auto figures = Figures(reports[0]);
  EXPECT_EQ(figures.at("lpe.LSE mean difference")["note"], "no such light");
  EXPECT_LT(figures.at("lpe.LDE mean difference")["value"], 0.5);
  EXPECT_EQ(reports[0]["noise"].size(), 6u);
  EXPECT_EQ(reports[0]["noise"][0]["samples"], Json({24, 96, 384}));
  EXPECT_LT(reports[0]["noise"][2]["slope"], -0.4) << "LDDE";
  EXPECT_EQ(reports[0]["warnings"].size(), 1u);
  EXPECT_NE(reports[0]["warnings"][0].get<std::string>().find("Skin, Eyes, Plinth, Ball, Ring"), std::string::npos);

  GuideReadOptions read;
  read.required = {Layer::kCoverage, Layer::kNormal, Layer::kLpeFull, Layer::kLpeLDDE};
  for (const std::string side : {"kept/suzanne.cycles.exr", "kept/suzanne.ours.exr"}) {
    const auto guides = ReadGuides(At(side), read);
    ASSERT_TRUE(guides.ok()) << guides.error().message;
    EXPECT_EQ(guides->width(), 160);
  }
  EXPECT_NE(TextOf(At("report.html")).find("<svg"), std::string::npos);

  // A baseline with impossible limits: exit code 1, and a message that names each limit and its source.
  Json baseline = Json::parse(TextOf(At("b.json")), nullptr, false);
  ASSERT_FALSE(baseline.is_discarded());
  EXPECT_EQ(baseline["blender"].get<std::string>().rfind(BlenderVersion(), 0), 0u);
  EXPECT_EQ(baseline["scenes"]["suzanne.glb"]["size"], "160x90");
  EXPECT_LE(baseline["scenes"]["suzanne.glb"]["limits"]["lpe.LDE mean difference"], 0.5);
  Json& scene = baseline["scenes"]["suzanne.glb"];
  scene["samples"] = scene["max_bounces"] = 0;
  scene["limits"] = {{"normal 99% within", 1e-6},
                     {"normal 99.9% within", scene["limits"]["normal 99.9% within"]},
                     {"albedo mean difference", 5.0}};
  std::ofstream(At("b.json")) << baseline;
  Arguments again = run;
  again.insert(again.end(), {"--samples", "0", "--baseline", "b.json"});
  const Json judged = Check(again, 1);
  EXPECT_NE(said_.find("albedo mean difference is above the built-in one"), std::string::npos) << said_;
  for (const auto& [name, figure] : Figures(judged[0])) {
    EXPECT_EQ(figure["kept"], name != "normal 99% within") << name << ": both renderers repeat themselves";
  }
}

TEST_F(CrosscheckBlender, ABlendFileAgreesAtTheFrameAskedFor) {
  MakeScenes();
  const Arguments run{"room.blend", "--size", "160x90", "--max-bounces", "3"};
  Arguments first = run, fifth = run, data = run;
  first.insert(first.end(), {"--samples", "32"});
  fifth.insert(fifth.end(), {"--samples", "0", "--frame", "5", "--keep", "five"});
  data.insert(data.end(), {"--samples", "0", "--keep", "one"});
  const Json reports = Check(first, 0);
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_EQ(reports[0]["glossy"], true);
  for (const auto& [name, figure] : Figures(reports[0])) {
    EXPECT_FALSE(figure.contains("note")) << name << ": every kind of light is there";
  }
  EXPECT_EQ(Figures(reports[0]).at("lpe.LDDE mean difference")["limit"], 2.0);
  EXPECT_TRUE(reports[0]["warnings"].empty()) << reports[0]["warnings"];

  // glTF's opaque surfaces show colours whatever their alpha.
  Picture pale(2, 1);
  pale.rgba = {65535, 0, 0, 0, 0, 0, 65535, 65535};
  ASSERT_TRUE(WritePicture(At("pale.png"), pale).ok());
  GltfBuilder b;
  b.Append("images", {{"uri", "pale.png"}});
  b.Append("samplers", {{"magFilter", 9728}});
  b.Append("textures", {{"source", 0}, {"sampler", 0}});
  b.Append("materials", {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorTexture", {{"index", 0}}}}}});
  const Json corners = {{"POSITION", b.Floats({0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0}, 3)},
                        {"TEXCOORD_0", b.Floats({0, 1, 1, 1, 1, 0, 0, 0}, 2)}};
  const int indices = b.Indices({0, 1, 2, 0, 2, 3});
  b.Root({{"name", "Pale"}, {"mesh", b.Mesh({{{"attributes", corners}, {"indices", indices}, {"material", 0}}})}});
  b.Append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  b.Root({{"translation", {1, 0.5, 4}}, {"camera", 0}});
  const std::vector<unsigned char> glb = b.Glb();
  WriteText("pale.glb", {glb.begin(), glb.end()});
  data.insert(data.begin() + 1, "pale.glb");
  Check(data, 0);
  const Json moved = Check(fifth, 0);
  EXPECT_EQ(moved[0]["frame"], 5);
  EXPECT_EQ(moved[0]["samples"], 0);
  EXPECT_EQ(Run({"compare", "one/room.cycles.exr", "five/room.cycles.exr", "--layer", "object"}).code, 1)
      << "the box has moved";
}

TEST_F(CrosscheckBlender, InstancesOfEveryKindAreToldApart) {
  MakeScenes();
  const Json reports = Check({"scatter.blend", "--size", "160x90", "--samples", "0", "--keep", "kept"}, 0);
  EXPECT_EQ(Figures(reports[0]).at("object differing")["value"], 0.0);
  ASSERT_EQ(reports[0]["unsupported"].size(), 1u) << reports[0]["unsupported"];
  EXPECT_NE(reports[0]["unsupported"][0].get<std::string>().find("'Unseen': is not seen by the camera"),
            std::string::npos);
  for (const std::string side : {"kept/scatter.cycles.exr", "kept/scatter.ours.exr"}) {
    const GuideSet guides = Guides(side);
    EXPECT_EQ(guides.camera->name, "Aside") << "the first by name";
    const std::set<std::string> seen = SeenIn(guides);
    for (const char* name : {"Same", "Same#2", "MadeUp", "MadeUp/MadeUp#5", "Group0/Pebble#4", "Group1/Placed",
                             "Corners/Leaf#4", "Bristles/Pebble#2"}) {
      EXPECT_TRUE(seen.count(name)) << side << " shows no " << name;
    }
    EXPECT_FALSE(seen.count("Unseen") || seen.count("Corners")) << side;
  }
}

TEST_F(CrosscheckBlender, KeysOfVisibilityDoNotBringInstancersBack) {
  MakeScenes();
  const Json reports = Check({"keyed_scatter.blend", "--size", "160x90", "--samples", "0", "--keep", "kept"}, 0);
  EXPECT_EQ(Figures(reports[0]).at("object differing")["value"], 0.0);
  EXPECT_TRUE(reports[0]["unsupported"].empty()) << reports[0]["unsupported"];
  const std::set<std::string> seen = SeenIn(Guides("kept/keyed_scatter.ours.exr"));
  EXPECT_TRUE(seen.count("Corners/Leaf#4") && seen.count("Bristles/Pebble#2") && seen.count("Shown/Placed"));
  EXPECT_FALSE(seen.count("Corners") || seen.count("Leaf") || seen.count("Hidden/Placed"));
  EXPECT_EQ(SeenIn(Guides("kept/keyed_scatter.cycles.exr")), seen);
}

TEST_F(CrosscheckBlender, WhatCannotAgreeIsNamedOnce) {
  MakeScenes();
  const Json reports = Check({"crooked.blend", "--size", "96x54", "--samples", "0"}, 1);
  const std::vector<std::string> warnings = reports[0]["unsupported"];
  EXPECT_EQ(warnings.size(), 4u) << reports[0]["unsupported"];
  for (const char* cause :
       {"camera 'Camera': the scale of what it hangs on mirrors", "object 'Hole': is a holdout",
        "image 'Gone' cannot be read from '//gone.png'", "its material override 'Clay' is ignored"}) {
    EXPECT_EQ(std::count_if(warnings.begin(), warnings.end(),
                            [&](const std::string& line) { return line.find(cause) != std::string::npos; }),
              1)
        << cause;
  }
}

TEST_F(CrosscheckBlender, MarkersAndAnimationDoNotUndoTheReferencesSettings) {
  MakeScenes();
  const Json reports =
      Check({"keyed.blend", "--camera", "Second", "--size", "160x90", "--samples", "0", "--keep", "kept"}, 0);
  // The grease pencil before the ball is on neither side.
  ASSERT_EQ(reports[0]["unsupported"].size(), 1u) << reports[0]["unsupported"];
  EXPECT_NE(reports[0]["unsupported"][0].get<std::string>().find("PENCIL, left out"), std::string::npos);
  GuideReadOptions read;
  read.required = {Layer::kCoverage, Layer::kNormal};
  const auto guides = ReadGuides(At("kept/keyed.cycles.exr"), read);
  ASSERT_TRUE(guides.ok()) << guides.error().message;
  EXPECT_EQ(guides->camera->name, "Second");
}

TEST_F(CrosscheckBlender, SimplifyHoldsOnBothSides) {
  MakeScenes();
  const Json reports = Check({"simplified.blend", "--size", "160x90", "--samples", "0"}, 0);
  EXPECT_TRUE(reports[0]["reasons"].empty());
}

}  // namespace
}  // namespace scumble
