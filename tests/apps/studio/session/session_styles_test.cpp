// Styles of several kinds in the calls of apps/studio/api.md: with more files than a painting, without a painting, and
// those that a scene asks for.
#include <gmock/gmock.h>

#include "core/style/style_file.h"
#include "tests/apps/studio/session/session_fixture.h"
#include "tests/support/gltf_builder.h"

namespace scumble {
namespace {

using testing::HasSubstr;

// A triangle before the camera, that asks for a style, if it is not empty.
void WriteTile(const fs::path& file, const std::string& style) {
  GltfBuilder b;
  const int position = b.Floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  b.Mesh({{{"attributes", {{"POSITION", position}}}}});
  json tile = {{"name", "Tile"}, {"mesh", 0}};
  if (!style.empty()) tile["extras"] = {{"scumble_style", style}};
  b.Root(tile);
  const std::vector<unsigned char> glb = b.Glb();
  Write(file, {reinterpret_cast<const char*>(glb.data()), glb.size()});
}

// From black at the left to `code` at the right.
Picture Shades(std::uint16_t code) {
  constexpr int kSize = 16;
  Picture shades(kSize, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      std::fill_n(shades.At(x, y), 3, std::uint16_t(code * x / (kSize - 1)));
      shades.At(x, y)[3] = 65535;
    }
  }
  return shades;
}

TEST_F(SessionTest, SaveAsTakesEveryFileAlong) {
  const fs::path mine = folder / "mine";
  for (const char* name : {"tile.png", "mask.png", "dusk.png", "ramp.png", "paper.png", "later.png"}) {
    ASSERT_TRUE(WritePicture(mine / name, Shades(std::uint16_t(40000 + 100 * name[0]))).ok());
  }
  Write(mine / "style.toml",
        "[transfer]\npaper = [[1, \"paper.png\"], [10, \"later.png\"]]\n\n[[exemplar]]\nimage = \"art/lit.png\"\n\n"
        "[[finish]]\neffect = \"hatch\"\nstrokes = \"tile.png\"\nmask = \"mask.png\"\n\n"
        "[[finish]]\neffect = \"palette\"\nlike = \"dusk.png\"\n\n"
        "[[finish]]\neffect = \"toon\"\nramp = \"ramp.png\"\n");
  Open({mine.string()});
  const HttpResponse before = Frame();
  ASSERT_EQ(before.status, 200) << before.body;
  const HttpResponse saved = Call("POST", "/api/save-as", {{"name", "other"}});
  ASSERT_EQ(saved.status, 200) << saved.body;
  const HttpResponse after = Frame();
  ASSERT_EQ(after.status, 200) << after.body;
  EXPECT_EQ(PictureOf(after.body).rgba, PictureOf(before.body).rgba);
  EXPECT_EQ(TextOf(folder / "other" / "later.png"), TextOf(mine / "later.png"));
}

// Undo names the file that stood there before.
TEST_F(SessionTest, APictureOfTheFolderIsPaperAgain) {
  const fs::path toml = folder / "mine" / "style.toml";
  ASSERT_TRUE(WritePicture(folder / "mine" / "paper.png", Shades(50000)).ok());
  Write(toml, "[transfer]\npaper = \"paper.png\"\n\n[[exemplar]]\nimage = \"art/lit.png\"\n");
  WriteTile(folder / "tile.glb", "");
  Open({toml.string()}, folder / "tile.glb");
  const auto paper = [&](const std::string& value) {
    return Call("PATCH", "/api/state", {{"keys", {{"transfer.paper", value}}}}).status;
  };
  const auto pixels = [&] {
    HttpResponse painted;
    // The saved file is seen, and painted: that may cancel ours.
    EXPECT_TRUE(Comes([&] { return (painted = Frame()).status == 200; })) << painted.body;
    return PictureOf(painted.body).rgba;
  };
  const auto before = pixels();
  ASSERT_EQ(paper("#ff8888"), 200);
  EXPECT_TRUE(pixels() != before);
  ASSERT_EQ(Call("POST", "/api/save", json::object()).status, 200);
  for (const char* name : {"../mine/paper.png", "/etc/passwd", "art/../../x.png"}) EXPECT_EQ(paper(name), 400) << name;
  ASSERT_EQ(paper("paper.png"), 200);
  EXPECT_TRUE(pixels() == before);
  ASSERT_EQ(Call("POST", "/api/save-as", {{"name", "other"}}).status, 200);
  EXPECT_EQ(State()["file_keys"]["transfer.paper"], "paper.png");
  EXPECT_TRUE(pixels() == before);
}

TEST_F(SessionTest, AStyleWithoutAPaintingIsWhole) {
  Write(folder / "mine" / "style.toml", "[transfer]\nmethod = \"toon\"\n\n[[exemplar]]\nimage = \"art/lit.png\"\n");
  for (const std::string& style : {std::string("toon"), (folder / "mine").string()}) {
    SCOPED_TRACE(style);
    Open({style});
    const json state = State();
    EXPECT_EQ(state["problem"], nullptr);
    EXPECT_EQ(state["exemplars"], json::array());
    EXPECT_EQ(state["file_keys"]["transfer.method"], "toon");
    EXPECT_EQ(json::parse(Call("GET", "/api/check").body), json({{"warnings", json::array()}}));
    EXPECT_EQ(Call("GET", "/api/thumbnail", nullptr, {{"style", state["style"]}}).status, 200);
    const json pick = json::parse(
        Call("GET", "/api/pick", nullptr, {{"x", std::to_string(kWidth / 2)}, {"y", std::to_string(kHeight / 2)}})
            .body);
    EXPECT_TRUE(pick["covered"]);
    EXPECT_FALSE(pick.contains("source")) << pick;
    const HttpResponse before = Frame();
    ASSERT_EQ(before.status, 200) << before.body;
    const std::string name = "copy of " + state["style"].get<std::string>();
    const HttpResponse saved = Call("POST", "/api/save-as", {{"name", name}});
    ASSERT_EQ(saved.status, 200) << saved.body;
    EXPECT_EQ(State()["style"], name);
    EXPECT_EQ(PictureOf(Frame().body).rgba, PictureOf(before.body).rgba);
  }
}

TEST_F(SessionTest, AScenesOwnStylesAreListedAndKeepTheirKeys) {
  fs::copy(folder / "mine", folder / "theirs", fs::copy_options::recursive);
  Write(folder / "theirs" / "style.toml",
        "[transfer]\nmethod = \"litsphere\"\n[[exemplar]]\nimage = \"art/lit.png\"\n");
  ASSERT_TRUE(WritePicture(folder / "theirs" / "art" / "lit.png", Ball(1000)).ok());
  const fs::path scene = folder / "tile.glb";
  WriteTile(scene, "theirs");
  Open({(folder / "mine").string()}, scene);
  const json exemplars = State()["exemplars"];
  ASSERT_EQ(exemplars.size(), 2u) << exemplars;
  EXPECT_EQ(exemplars[1]["style"], 1);
  EXPECT_EQ(exemplars[1]["style_id"], "theirs");
  const json pick = json::parse(
      Call("GET", "/api/pick", nullptr, {{"x", std::to_string(kWidth / 2 - 5)}, {"y", std::to_string(kHeight / 2 + 5)}})
          .body);
  EXPECT_EQ(pick["style_id"], "theirs") << pick;
  const std::string before = Frame().body;
  ASSERT_EQ(Call("PATCH", "/api/state", {{"keys", {{"transfer.scale", 2.0}}}}).status, 200);
  EXPECT_EQ(PictureOf(Frame().body).rgba, PictureOf(before).rgba) << "the key is of the other style";
  EXPECT_THAT(Call("POST", "/api/export", {{"what", "command"}}).body, HasSubstr("mine:transfer.scale=2"));
  const std::string whole = TextOf(scene);
  Write(scene, "half");
  EXPECT_TRUE(Comes([&] { return !State()["problem"].is_null(); }));
  EXPECT_THAT(Call("POST", "/api/export", {{"what", "command"}}).body, HasSubstr("mine:transfer.scale=2"));
  Write(scene, whole);
  EXPECT_TRUE(Comes([&] { return State()["problem"].is_null(); }));
  // What is assigned wins over what the scene asks for.
  ASSERT_EQ(Call("PATCH", "/api/state", {{"assignments", json::array({{{"name", "Tile"}, {"style", "mine"}}})}}).status,
            200);
  EXPECT_EQ(State()["exemplars"].size(), 1u);
}

}  // namespace
}  // namespace scumble
