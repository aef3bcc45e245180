// Styles by object and material: from the scene's author, from --assign, and changed by --set; shadow catchers; wrong
// names.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/cli_harness.h"
#include "tests/support/gltf_builder.h"

namespace scumble {
namespace {

class CliSceneStyles : public CliTest {
 protected:
  void WriteGlb(const std::string& name, const GltfBuilder& builder) {
    const std::vector<unsigned char> glb = builder.Glb();
    WriteText(name, std::string(glb.begin(), glb.end()));
  }
  // A style of one colour, so that a pixel shows which style painted it.
  void WriteColor(const std::string& folder, int red, int green, int blue, const std::string& more = "") {
    Picture picture(16, 16);
    for (int i = 0; i < 16 * 16; ++i) {
      std::uint16_t* pixel = picture.At(i % 16, i / 16);
      pixel[0] = red * 257, pixel[1] = green * 257, pixel[2] = blue * 257, pixel[3] = 65535;
    }
    std::filesystem::create_directories(At(folder));
    ASSERT_TRUE(WritePicture(At(folder + "/lit.png"), picture));
    WriteText(folder + "/style.toml",
              "[transfer]\nreference_height = 0\nblend_radius = 0\n" + more + "[[exemplar]]\nimage = \"lit.png\"\n");
  }
  // Columns of squares, each `side` wide, of one mesh in the material "Paint", seen from the front: object i is "Tile"
  // i.
  static GltfBuilder Tiles(int columns, int rows) {
    GltfBuilder b;
    const int position = b.Floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
    b.Append("materials", {{"name", "Paint"}});
    b.Mesh({{{"attributes", {{"POSITION", position}}}, {"indices", b.Indices({0, 1, 2, 0, 2, 3})}, {"material", 0}}});
    for (int i = 0; i < columns * rows; ++i) {
      b.Root({{"name", "Tile" + std::to_string(i)},
              {"mesh", 0},
              {"translation", {i % columns, rows - 1 - i / columns, 0}}});
    }
    b.Append("cameras",
             {{"type", "orthographic"},
              {"orthographic", {{"xmag", columns / 2.0}, {"ymag", rows / 2.0}, {"znear", 0.1}, {"zfar", 100}}}});
    b.Root({{"name", "Eye"}, {"camera", 0}, {"translation", {columns / 2.0, rows / 2.0, 10}}});
    return b;
  }
  static void Want(GltfBuilder& b, int tile, const std::string& style, bool ours = false) {
    nlohmann::json extras = {{"scumble_style", style}};
    if (ours) extras = {{"scumble", {{"style", style}, {"pass_index", 0}}}};
    b.json["nodes"][tile]["extras"] = extras;
  }
  // Per tile "r", "g", "b" or "." for its middle, of a picture whose tiles are 8 pixels wide.
  std::string Colors(const std::string& name, int columns, int rows) {
    const Expected<Picture> picture = ReadPicture(At(name));
    std::string colors;
    if (!picture) return colors;
    for (int i = 0; i < columns * rows; ++i) {
      const std::uint16_t* pixel = picture->At(8 * (i % columns) + 4, 8 * (i / columns) + 4);
      if (pixel[3] == 0)
        colors += '.';
      else
        colors += pixel[0] > 40000 ? 'r' : pixel[1] > 40000 ? 'g' : 'b';
    }
    return colors;
  }
  void SetUp() override {
    WriteColor("red", 250, 10, 10);
    WriteColor("scene/green", 10, 250, 10);  // beside the scene, not where the program runs
    WriteColor("scene/blue", 10, 10, 250, "edge_aware = false\n");
  }
};

TEST_F(CliSceneStyles, ObjectsAndMaterialsGetWhatTheirAuthorWants) {
  GltfBuilder b = Tiles(4, 1);
  Want(b, 0, "green");
  Want(b, 1, "blue", true);
  Want(b, 2, "rendered");
  WriteGlb("scene/s.glb", b);
  const auto colors = [&](const Arguments& more) {
    const Arguments stylize = {"stylize", "scene/s.glb", "--style", "red", "--size", "32x8", "-o", "p.png"};
    RunOk(With(stylize, more));
    return Colors("p.png", 4, 1);
  };
  EXPECT_EQ(colors({}), "gb.r");
  EXPECT_EQ(colors({"--no-scene-styles"}), "rrrr");
  EXPECT_EQ(colors({"--assign", "Tile0=red"}), "rb.r");
  EXPECT_EQ(colors({"--assign", "Tile2=scene/green"}), "gbgr");
  EXPECT_EQ(colors({"--assign", "Paint=scene/blue"}), "bbbb")
      << "what is asked for goes before the scene, even by material";
  EXPECT_EQ(colors({"--assign", "Paint=scene/blue", "--assign", "Tile1=rendered"}), "b.bb");
  b.json["materials"][0]["extras"] = {{"scumble_style", "green"}};
  WriteGlb("scene/s.glb", b);
  EXPECT_EQ(colors({}), "gb.g") << "an object goes before its material";
  EXPECT_EQ(colors({"--assign", "Tile3=red"}), "gb.r");
  const nlohmann::json info = RunOk({"info", "scene/s.glb", "--json"}).Json();
  EXPECT_EQ(info["styles"], nlohmann::json({{"Tile0", "green"}, {"Tile1", "blue"}, {"Tile2", "rendered"}}));
  EXPECT_EQ(info["material styles"], nlohmann::json({{"Paint", "green"}}));
  // A bundled style by its name, and the default style once more, which is no second one.
  Want(b, 0, "../red");
  Want(b, 1, "charcoal");
  b.json["materials"][0].erase("extras");
  WriteGlb("scene/s.glb", b);
  const std::string bundled = colors({});
  EXPECT_EQ(bundled[0], 'r');
  EXPECT_EQ(bundled[3], 'r');
}

// They are opened with the scene, and read later.
TEST_F(CliSceneStyles, NoOutputTakesThePlaceOfTheirFiles) {
  GltfBuilder b = Tiles(2, 1);
  Want(b, 0, "green");
  WriteGlb("scene/s.glb", b);
  const std::string painting = Bytes("scene/green/lit.png");
  std::filesystem::create_symlink(At("scene/green/lit.png"), At("p2.png"));
  RunOk({"guidegen", "scene/s.glb", "--style", "red", "--size", "16x8", "-o", "scene/g.exr"});
  for (const Arguments& verb : {Arguments{"stylize", "scene/s.glb", "--size", "16x8"}, {"transfer", "scene/g.exr"}}) {
    const Arguments paint = With(verb, {"--style", "red"});
    ExpectError(With(paint, {"-o", "scene/green/lit.png"}), 2,
                {"scene/green/lit.png", "overwrite a file of the style"});
    ExpectError(With(paint, {"--frames", "1-2", "-o", "p#.png"}), 2, {"-o p2.png", "overwrite a file of the style"});
    EXPECT_FALSE(Exists("p1.png"));
    RunOk(With(paint, {"-o", "new.png"}));
  }
  std::filesystem::create_symlink(At("scene/green/lit.png"), At("g2.exr"));
  ExpectError({"guidegen", "scene/s.glb", "--style", "red", "--size", "16x8", "--frames", "1-2", "-o", "g#.exr"}, 2,
              {"-o g2.exr", "overwrite a file of the style"});
  EXPECT_FALSE(Exists("g1.exr"));
  EXPECT_EQ(Bytes("scene/green/lit.png"), painting);
}

TEST_F(CliSceneStyles, TheyTravelWithTheGuides) {
  GltfBuilder b = Tiles(4, 1);
  Want(b, 0, "green");
  Want(b, 3, "lit");
  WriteColor("scene/lit", 10, 10, 250, "[[exemplar]]\nimage = \"lit.png\"\nluminance = 0.1\n");
  WriteGlb("scene/s.glb", b);
  RunOk({"stylize", "scene/s.glb", "--style", "red", "--size", "32x8", "-o", "p.png"});
  EXPECT_EQ(Colors("p.png", 4, 1), "grrb");
  // The layers that the scene's styles read are made with the style's own, and paths are found beside the guides.
  const Arguments guidegen = {"guidegen", "scene/s.glb", "--style", "red", "--size", "32x8"};
  EXPECT_NE(RunOk(With(guidegen, {"-o", "scene/g.exr"})).out.find("luminance"), std::string::npos);
  RunOk({"transfer", "scene/g.exr", "--style", "red", "-o", "two.png"});
  EXPECT_TRUE(Pixels("two.png") == Pixels("p.png"));
  RunOk({"transfer", "scene/g.exr", "--style", "red", "-o", "plain.png", "--no-scene-styles"});
  EXPECT_EQ(Colors("plain.png", 4, 1), "rrrr");
  EXPECT_EQ(RunOk(With(guidegen, {"--no-scene-styles", "-o", "n.exr"})).out.find("luminance"), std::string::npos);
  EXPECT_EQ(RunOk({"info", "scene/g.exr", "--json"}).Json()["styles"],
            nlohmann::json({{"Tile0", "green"}, {"Tile3", "lit"}}));
  RunOk(With(guidegen, {"--frames", "1-2", "-o", "scene/r#.exr"}));
  EXPECT_NE(RunOk(With(guidegen, {"--frames", "1-2", "-o", "scene/r#.exr", "--resume"})).out.find("2 kept"),
            std::string::npos);
  RunOk({"transfer", "scene/r#.exr", "--style", "red", "--frames", "1-2", "-o", "t#.png"});
  EXPECT_EQ(Bytes("t2.png"), Bytes("p.png"));
}

TEST_F(CliSceneStyles, WishesThatCannotBeGranted) {
  GltfBuilder b = Tiles(2, 1);
  Want(b, 1, "oill");
  WriteGlb("scene/s.glb", b);
  const Arguments stylize = {"stylize", "scene/s.glb", "--style", "red", "--size", "16x8", "-o", "p#.png"};
  for (const Arguments& frames : {Arguments{"--frame", "1"}, Arguments{"--frames", "1-2"}}) {
    ExpectError(With(stylize, frames), 3,
                {"scene/s.glb: object 'Tile1'", "'oill'", "scumble_style", "charcoal", "--assign 'Tile1=STYLE'",
                 "--no-scene-styles"});
    RunOk(With(With(stylize, frames), {"--no-scene-styles"}));
    RunOk(With(With(stylize, frames), {"--assign", "Tile*=rendered"}));
  }
  b.json["nodes"][1].erase("extras");
  b.json["materials"][0]["extras"] = {{"scumble_style", "../no/style"}};
  WriteGlb("scene/s.glb", b);
  ExpectError(With(stylize, {"--frame", "1"}), 3, {"material 'Paint'", "there is no style '../no/style' in scene: "});
  b.json["materials"][0]["extras"] = {{"scumble_style", 7}};
  WriteGlb("scene/s.glb", b);
  ExpectError(With(stylize, {"--frame", "1"}), 3, {"material 0 'Paint'", "scumble_style is no text"});
  b.json["materials"][0]["extras"] = {{"scumble_style", "catcher"}};
  WriteGlb("scene/s.glb", b);
  ExpectError(With(stylize, {"--frame", "1"}), 3, {"material 'Paint'", "'catcher'", "--set transfer.shadow=paint"});
  // A name that no object has is a warning that lists those there are.
  b.json["materials"][0].erase("extras");
  WriteGlb("scene/s.glb", b);
  const CommandResult run = RunOk(With(stylize, {"--frame", "1", "--assign", "Tree*=scene/green"}));
  for (const char* words : {"--assign Tree*", "no such object or material", "Tile0", "Tile1"}) {
    EXPECT_NE(run.Warning().find(words), std::string::npos) << run.err;
  }
}

// A box ticked in Blender is no slip: a style without shadows leaves the object out.
TEST_F(CliSceneStyles, ATickedCatcherIsLeftOutByStylesWithoutShadows) {
  GltfBuilder b = Tiles(4, 1);
  Want(b, 1, "catcher-or-rendered", true);
  WriteGlb("s.glb", b);
  const Arguments red = {"--style", "red", "-o", "p.png"}, shadow = {"--set", "transfer.shadow=paint"};
  const Arguments stylize = With({"stylize", "s.glb", "--size", "32x8"}, red);
  RunOk(With(stylize, {"--no-scene-styles", "--assign", "Tile1=rendered"}));
  const std::string left_out = Pixels("p.png");
  EXPECT_EQ(Colors("p.png", 4, 1), "r.rr");
  RunOk(stylize);
  EXPECT_TRUE(Pixels("p.png") == left_out);
  RunOk({"guidegen", "s.glb", "--size", "32x8", "--style", "red", "-o", "g.exr"});
  RunOk(With({"transfer", "g.exr"}, red));
  EXPECT_TRUE(Pixels("p.png") == left_out);
  ASSERT_TRUE(WritePicture(At("under.png"), Picture(32, 8)));
  RunOk(With(stylize, {"--over", "under.png"}));
  EXPECT_EQ(Colors("p.png", 4, 1), "r.rr");
  RunOk(With(With(stylize, shadow), {"--no-scene-styles", "--assign", "Tile1=catcher"}));
  const std::string caught = Pixels("p.png");
  RunOk(With(stylize, shadow));
  EXPECT_TRUE(Pixels("p.png") == caught);
  ExpectError(With(stylize, {"--no-scene-styles", "--assign", "Tile1=catcher"}), 2, {"--assign Tile1=catcher"});
}

// A sphere's shadow on an unpainted floor, in the style's darkest paint: over paper, transparency or a picture.
TEST_F(CliSceneStyles, ACatcherShowsTheShadowsOnIt) {
  WriteColor("grey", 120, 120, 120);
  GltfBuilder b;
  const int floor = b.Floats({-4, 0, -4, -4, 0, 4, 4, 0, 4, 4, 0, -4}, 3);
  const int lid = b.Floats({-1, 1, -1, -1, 1, 1, 1, 1, 1, 1, 1, -1}, 3);
  for (const auto& [name, position] : {std::pair{"Floor", floor}, {"Lid", lid}}) {
    const int mesh = b.Mesh({{{"attributes", {{"POSITION", position}}}, {"indices", b.Indices({0, 1, 2, 0, 2, 3})}}});
    b.Root({{"name", name}, {"mesh", mesh}});
  }
  b.json["extensionsUsed"] = {"KHR_lights_punctual"};
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}, {"intensity", 2000}}};
  // The sun stands to the left, halfway up: the lid's shadow falls to the right of it. Seen from straight above.
  b.Root({{"name", "Sun"},
          {"rotation", {-0.5, -0.5, 0, std::sqrt(0.5)}},
          {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  b.Append("cameras",
           {{"type", "orthographic"}, {"orthographic", {{"xmag", 5}, {"ymag", 5}, {"znear", 0.1}, {"zfar", 100}}}});
  b.Root({{"name", "Eye"},
          {"camera", 0},
          {"translation", {0, 20, 0}},
          {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}});
  WriteGlb("s.glb", b);
  const Arguments stylize = {"stylize", "s.glb", "--style", "grey", "--size", "100", "-o", "p.png"};
  const Arguments catches = With(stylize, {"--assign", "Floor=catcher", "--set", "transfer.shadow=paint"});
  RunOk(With({"guidegen", "s.glb", "--size", "100", "--layers", "shadow"}, {"-o", "g.exr"}));
  GuideReadOptions read;
  read.required = AlwaysWritten().Add(Layer::kShadow);
  const Expected<GuideSet> guides = ReadGuides(At("g.exr"), read);
  ASSERT_TRUE(guides);
  std::uint32_t floor_id = 0;
  for (const auto& [id, name] : guides->object_names) floor_id = name == "Floor" ? id : floor_id;
  RunOk(catches);
  const Expected<Picture> alone = ReadPicture(At("p.png"));
  ASSERT_TRUE(alone);
  Picture under(100, 100);
  for (int i = 0; i < 10000; ++i) {
    std::uint16_t* pixel = under.At(i % 100, i / 100);
    pixel[0] = pixel[1] = pixel[2] = 200 * 257, pixel[3] = 65535;
  }
  ASSERT_TRUE(WritePicture(At("under.png"), under));
  RunOk(With(catches, {"--over", "under.png"}));
  const Expected<Picture> over = ReadPicture(At("p.png"));
  ASSERT_TRUE(over);
  const auto is_floor_at = [&](int x, int y) {
    return guides->Plane(Layer::kObject)[guides->Index(x, y)] == static_cast<float>(floor_id);
  };
  // Outlines are smoothed over the 5 × 5 pixels around.
  const auto near_outline = [&](int x, int y) {
    const float here = guides->Plane(Layer::kShadow)[guides->Index(x, y)];
    for (int v = std::max(0, y - 2); v <= std::min(99, y + 2); ++v) {
      for (int u = std::max(0, x - 2); u <= std::min(99, x + 2); ++u) {
        if (is_floor_at(u, v) && guides->Plane(Layer::kShadow)[guides->Index(u, v)] != here) return true;
      }
    }
    return false;
  };
  int shaded = 0, lit = 0;
  for (int i = 0; i < 10000; ++i) {
    const int x = i % 100, y = i / 100;
    const bool is_floor = is_floor_at(x, y);
    const float shadow = guides->Plane(Layer::kShadow)[i];
    if (is_floor && near_outline(x, y)) continue;
    if (is_floor && shadow == 0.0f) {
      ASSERT_EQ(alone->At(x, y)[3], 0) << x << ", " << y;
      ASSERT_EQ(over->At(x, y)[0], 200 * 257);
      ++lit;
    } else if (is_floor && shadow == 1.0f) {
      ASSERT_GT(alone->At(x, y)[3], 0) << x << ", " << y;
      ASSERT_LT(over->At(x, y)[0], 199 * 257);
      ++shaded;
    } else if (!is_floor && guides->Plane(Layer::kCoverage)[i] == 1.0f) {
      ASSERT_EQ(alone->At(x, y)[3], 65535) << "the lid is painted";
    }
  }
  EXPECT_GT(lit, 3000);
  EXPECT_GT(shaded, 100);
  // The same from guides, and by the scene's own request.
  RunOk({"transfer", "g.exr", "--style", "grey", "--assign", "Floor=catcher", "--set", "transfer.shadow=paint",
         "--over", "under.png", "-o", "two.png"});
  EXPECT_TRUE(Pixels("two.png") == Pixels("p.png"));
  b.json["nodes"][0]["extras"] = {{"scumble_style", "catcher"}};
  WriteGlb("s.glb", b);
  RunOk(With(stylize, {"--set", "transfer.shadow=paint", "--over", "under.png"}));
  EXPECT_TRUE(Pixels("two.png") == Pixels("p.png"));
  ExpectError(With(stylize, {"--assign", "Floor=catcher"}), 2, {"--assign Floor=catcher", "transfer.shadow=paint"});
}

TEST_F(CliSceneStyles, TwoThousandObjectsOfThreeStyles) {
  constexpr int kColumns = 50, kRows = 40;
  GltfBuilder b = Tiles(kColumns, kRows);
  const char* wishes[] = {"green", "blue", "../red"};
  std::string expected;
  for (int i = 0; i < kColumns * kRows; ++i) {
    Want(b, i, wishes[i * 7 % 3]);
    expected += "gbr"[i * 7 % 3];
  }
  WriteGlb("scene/s.glb", b);
  const Arguments stylize = {"stylize", "scene/s.glb", "--style", "red", "--size", "400x320", "--json", "-o", "p.png"};
  const nlohmann::json many = RunOk(stylize).Json();
  EXPECT_EQ(Colors("p.png", kColumns, kRows), expected);
  RecordProperty("prepare_ms", std::to_string(many["ms"]["prepare"]["median"].get<double>()));
  RecordProperty(
      "plain_prepare_ms",
      std::to_string(RunOk(With(stylize, {"--no-scene-styles"})).Json()["ms"]["prepare"]["median"].get<double>()));
  // Two thousand options do what the scene did.
  Arguments assigned = With(stylize, {"--no-scene-styles"});
  for (int i = 0; i < kColumns * kRows; ++i) {
    const char* styles[] = {"scene/green", "scene/blue", "red"};
    assigned = With(std::move(assigned), {"--assign", "Tile" + std::to_string(i) + "=" + styles[i * 7 % 3]});
  }
  const std::string by_scene = Pixels("p.png");
  RunOk(stylize);
  const std::string first = Pixels("p.png");
  RunOk(assigned);
  EXPECT_TRUE(Pixels("p.png") == first);
  EXPECT_FALSE(by_scene == first) << "without the scene's styles it is another picture";
}

int Count(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

class CliAssign : public CliSceneStyles {
 protected:
  void SetUp() override {
    CliSceneStyles::SetUp();
    WriteColor("scene/lit", 10, 10, 250, "[[exemplar]]\nimage = \"lit.png\"\nluminance = 0.1\n");
    WriteGlb("s.glb", Tiles(4, 1));
  }
  CommandResult Paint(const Arguments& more) {
    return RunOk(With({"stylize", "s.glb", "--style", "red", "--size", "32x8", "-o", "p.png", "--json"}, more));
  }
  std::string ColorsWith(const Arguments& more) {
    Paint(more);
    return Colors("p.png", 4, 1);
  }
};

TEST_F(CliAssign, TheLaterOneWinsBeItAnObjectsOrAMaterials) {
  EXPECT_EQ(ColorsWith({"--assign", "*=scene/green", "--assign", "Paint=scene/blue"}), "bbbb");
  EXPECT_EQ(ColorsWith({"--assign", "Paint=scene/blue", "--assign", "*=scene/green"}), "gggg");
  EXPECT_EQ(ColorsWith({"--assign", "Paint=scene/blue", "--assign", "Tile1=scene/green"}), "bgbb");
  const CommandResult hidden =
      Paint({"--assign", "Tile1=scene/green", "--assign", "Tile2=rendered", "--assign", "Paint=scene/blue"});
  EXPECT_EQ(Colors("p.png", 4, 1), "bbbb");
  EXPECT_EQ(hidden.Warning(),
            "--assign Tile1=scene/green, --assign Tile2=rendered paint no pixel: what is named there is "
            "not seen, or a later assignment names it too");
  ASSERT_EQ(hidden.Json()["warnings"].size(), 1u);
  EXPECT_EQ(hidden.Json()["warnings"][0], hidden.Warning());
  EXPECT_TRUE(Paint({"--assign", "Tile1=scene/green"}).Json()["warnings"].empty());
}

TEST_F(CliAssign, NamesThatFitNothingAreSaidOncePerRun) {
  const Arguments stylize = {"stylize",  "s.glb",
                             "--style",  "red",
                             "--size",   "32x8",
                             "--frames", "1-3",
                             "-o",       "p#.png",
                             "--assign", "tile0=scene/green",
                             "--assign", "Pait=scene/blue",
                             "--assign", "Zebra=rendered"};
  const CommandResult run = RunOk(With(stylize, {"--json"}));
  const std::string names = "its objects are Tile0, Tile1, Tile2, Tile3; its materials are Paint";
  for (const std::string& line :
       {"--assign tile0=scene/green: the scene has no such object or material; " + names + "; did you mean Tile0?\n",
        "--assign Pait=scene/blue: the scene has no such object or material; " + names + "; did you mean Paint?\n",
        "--assign Zebra=rendered: the scene has no such object or material; " + names + "\n"}) {
    EXPECT_EQ(Count(run.err, line), 1) << run.err;
  }
  EXPECT_EQ(Count(run.err, "warning"), 3) << run.err;
  EXPECT_EQ(run.Json()["warnings"].size(), 3u);
}

TEST_F(CliAssign, FilesHoldManyAssignments) {
  WriteText("sheet.txt",
            "\xef\xbb\xbf# the set\r\n\n  Tile0 = scene/green\r\nPaint=scene/blue\n   # over it\nTile3=rendered");
  EXPECT_EQ(ColorsWith({"--assign", "@sheet.txt"}), "bbb.");
  EXPECT_EQ(ColorsWith({"--assign", "@sheet.txt", "--assign", "Tile1=red"}), "brb.");
  EXPECT_EQ(ColorsWith({"--assign", "Tile1=red", "--assign", "@sheet.txt"}), "bbb.");
  const Arguments stylize = {"stylize", "s.glb", "--style", "red", "-o", "p.png", "--assign"};
  WriteText("bad.txt", "# one\nTile0\n");
  ExpectError(With(stylize, {"@bad.txt"}), 3, {"bad.txt:2: Tile0", "NAME=STYLE"});
  WriteText("bad.txt", "Tile0 = nope\n");
  ExpectError(With(stylize, {"@bad.txt"}), 3, {"bad.txt:1: Tile0 = nope: there is no style 'nope'"});
  ExpectError(With(stylize, {"@none.txt"}), 3, {"none.txt"});
  ExpectError(With(stylize, {"Tile0=nope"}), 3, {"--assign Tile0=nope: there is no style 'nope'"});
  ExpectError(With(stylize, {"Tile0"}), 2, {"--assign Tile0", "NAME=STYLE"});
}

TEST_F(CliAssign, OneKeyOfOneStyleAndAllStylesInTheReport) {
  const Arguments two = {"--assign", "Tile1=scene/lit"};
  const nlohmann::json plain = Paint(two).Json();
  ASSERT_EQ(plain["styles"].size(), 2u);
  EXPECT_EQ(plain["styles"][0]["style"], "red");
  EXPECT_EQ(plain["styles"][1]["style"], "scene/lit");
  EXPECT_EQ(plain["styles"][1]["exemplars"], 2);
  EXPECT_EQ(plain["styles"][1]["luminances"].size(), 2u);
  EXPECT_FALSE(plain["styles"][0].contains("luminances"));
  EXPECT_TRUE(plain.contains("exposure")) << "the assigned style looks at the light";
  EXPECT_FALSE(Paint({"--assign", "Tile1=scene/green"}).Json().contains("exposure"));
  const auto widths = [&](const Arguments& sets) {
    const nlohmann::json json = Paint(With(two, sets)).Json();
    return std::vector<int>{json["styles"][0]["exemplar_width"], json["styles"][1]["exemplar_width"]};
  };
  EXPECT_EQ(widths({}), (std::vector<int>{16, 16}));
  EXPECT_EQ(widths({"--set", "transfer.scale=2"}), (std::vector<int>{32, 32}));
  EXPECT_EQ(widths({"--set", "scene/lit:transfer.scale=0.5"}), (std::vector<int>{16, 8}));
  EXPECT_EQ(widths({"--set", "transfer.scale=2", "--set", "red:transfer.scale=0.5"}), (std::vector<int>{8, 32}));
  EXPECT_EQ(widths({"--set", "red:transfer.scale=0.5", "--set", "transfer.scale=2"}), (std::vector<int>{32, 32}));
  EXPECT_EQ(widths({"--set", "./scene/lit:transfer.scale=0.5"}), (std::vector<int>{16, 8})) << "the same folder";
  const Arguments stylize = {"stylize", "s.glb", "--style", "red", "-o", "p.png", "--set"};
  ExpectError(With(stylize, {"scene/lit:transfer.scale=2"}), 2, {"give no style 'scene/lit'", "they give red"});
  ExpectError(With(stylize, {"nope:transfer.scale=2"}), 2, {"give no style 'nope'"});
  ExpectError(With(stylize, {"red:transfer.scalee=2"}), 2, {"unknown key transfer.scalee"});
}

// "exemplar." also begins keys of an exemplar, and '=' and ':' may stand in a folder's name.
TEST_F(CliAssign, NamesThatLookLikeKeysAreNames) {
  for (const std::string name : {"exemplar.png", "a=b", "a:b"}) {
    WriteColor(name, 10, 250, 10);
    const Arguments paint = {"stylize", "s.glb", "--style", name, "--size", "32x8", "-o", "p.png", "--json"};
    const nlohmann::json json = RunOk(With(paint, {"--set", name + ":transfer.scale=0.5"})).Json();
    EXPECT_EQ(json["styles"][0]["exemplar_width"], 8) << name;
  }
}

TEST_F(CliAssign, TheTwoStepsTakeWhatTheOneTakes) {
  const Arguments styles = {"--style", "red", "--assign", "Tile1=scene/lit", "--set", "red:transfer.colorize=1"};
  RunOk(With(With({"stylize", "s.glb", "--size", "32x8", "-o", "one.png"}, styles), {}));
  RunOk(With({"guidegen", "s.glb", "--size", "32x8", "-o", "g.exr"}, styles));
  RunOk(With({"transfer", "g.exr", "-o", "two.png"}, styles));
  EXPECT_TRUE(Bytes("one.png") == Bytes("two.png"));
  RunOk({"guidegen", "s.glb", "--size", "32x8", "--style", "red", "-o", "few.exr"});
  const CommandResult lacks = ExpectError(
      With({"transfer", "few.exr", "-o", "no.png"}, styles), 3,
      {"few.exr has no layer albedo, luminance", "--layers albedo,luminance",
       "the same --style, --assign, --set and --finish as here", "It has A, normal, depth, object, material"});
  EXPECT_EQ(Count(lacks.err, "normal.X"), 0) << lacks.err;
  RunOk({"guidegen", "s.glb", "--size", "32x8", "--layers", "albedo,luminance", "-o", "few.exr"});
  RunOk(With({"transfer", "few.exr", "-o", "two.png"}, styles));
  EXPECT_TRUE(Bytes("one.png") == Bytes("two.png")) << "the option that the error names fixes it";
  ExpectError({"guidegen", "s.glb", "--assign", "Tile1=red", "-o", "g.exr"}, 2, {"--assign", "--style"});
}

// Renders may have a Cryptomatte of objects alone.
TEST_F(CliAssign, OneLayerOfNamesIsEnoughForWhatItNames) {
  RunOk({"guidegen", "s.glb", "--size", "32x8", "--style", "red", "-o", "g.exr"});
  const Expected<GuideSet> all = ReadGuides(At("g.exr"));
  ASSERT_TRUE(all);
  GuideSet objects = *all, materials = *all, neither = *all;
  objects.Remove(Layer::kMaterial), materials.Remove(Layer::kObject);
  neither.Remove(Layer::kMaterial), neither.Remove(Layer::kObject);
  WriteGuideFile("objects.exr", objects);
  WriteGuideFile("materials.exr", materials);
  WriteGuideFile("neither.exr", neither);
  const auto with = [](const std::string& file, const std::string& assigned) -> Arguments {
    return {"transfer", file,     "--style", "red",  "--set", "transfer.edge_aware=false",
            "--assign", assigned, "-o",      "p.png"};
  };
  RunOk(with("objects.exr", "Tile2=scene/blue"));
  EXPECT_EQ(Colors("p.png", 4, 1), "rrbr");
  RunOk(with("materials.exr", "Paint=scene/blue"));
  EXPECT_EQ(Colors("p.png", 4, 1), "bbbb");
  ExpectError(with("objects.exr", "Paint=scene/blue"), 3,
              {"--assign Paint=scene/blue", "objects.exr", "its objects are Tile0, Tile1", "lacks the layer material"});
  ExpectError(with("materials.exr", "Tile2=scene/blue"), 3, {"its materials are Paint", "lacks the layer object"});
  ExpectError(with("neither.exr", "Tile2=scene/blue"), 3, {"lacks the layers object and material"});
}

TEST_F(CliAssign, ShadowsThatComeLaterCanBeCaught) {
  const Arguments stylize = {"stylize", "s.glb", "--style",  "red",           "--size",  "32x8",
                             "-o",      "p.png", "--assign", "Tile0=catcher", "--frame", "6"};
  RunOk(With(stylize, {"--set", R"(transfer.shadow=[[1, "none"], [5, "paint"]])"}));
  EXPECT_EQ(Colors("p.png", 4, 1), ".rrr");
  ExpectError(stylize, 2, {"--assign Tile0=catcher", "transfer.shadow=paint"});
  ExpectError(With(stylize, {"--set", R"(transfer.shadow=[[1, "none"], [5, "none"]])"}), 2, {"--assign Tile0=catcher"});
}

}  // namespace
}  // namespace scumble
