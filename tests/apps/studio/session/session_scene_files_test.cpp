// Files of the scene that other programs save.
#include <gmock/gmock.h>

#include "tests/apps/studio/session/session_fixture.h"
#include "tests/support/gltf_builder.h"

namespace scumble {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// As programs save that keep a copy: the file is away for a moment.
TEST_F(SessionTest, ATextureThatIsAwayIsToldAndSeenWhenItIsBack) {
  const fs::path scene = folder / "m.obj", texture = folder / "t.png";
  Write(scene, "mtllib m.mtl\nv -1 0 0\nv 1 0 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl A\nf 1/1 2/2 3/3\n");
  Write(folder / "m.mtl", "newmtl A\nKd 1 1 1\nmap_Kd t.png\n");
  Picture blue(4, 4);
  for (std::size_t i = 0; i < blue.rgba.size(); i += 4) blue.rgba[i + 2] = blue.rgba[i + 3] = 65535;
  ASSERT_TRUE(WritePicture(texture, blue).ok());
  Open({"render"}, scene);
  const HttpResponse first = Frame();
  ASSERT_EQ(first.status, 200) << first.body;
  EXPECT_EQ(State()["warnings"], json::array());
  fs::rename(texture, folder / "t.png~");
  EXPECT_THAT(Await("warnings"), ElementsAre(HasSubstr("t.png")));
  EXPECT_THAT(State()["warnings"].at(0).get<std::string>(), HasSubstr("a texture cannot be read"));
  EXPECT_NE(Frame().body, first.body);
  fs::rename(folder / "t.png~", texture);
  EXPECT_EQ(Await("warnings"), json::array());
  EXPECT_EQ(Frame().body, first.body);
}

// Long after the scene was tried in vain.
TEST_F(SessionTest, ABufferThatIsAwayIsSeenWhenItIsBack) {
  GltfBuilder b;
  const int position = b.Floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  b.Mesh({{{"attributes", {{"POSITION", position}}}}});
  b.Root({{"name", "Tile"}, {"mesh", 0}});
  const std::vector<unsigned char> glb = b.Glb();
  const std::size_t length = glb[12] | glb[13] << 8;  // of the JSON, which begins at byte 20
  json scene = json::parse(glb.begin() + 20, glb.begin() + 20 + std::ptrdiff_t(length));
  scene["buffers"][0]["uri"] = "a.bin";
  Write(folder / "a.gltf", scene.dump());
  Write(folder / "a.bin", std::string(glb.begin() + 28 + std::ptrdiff_t(length), glb.end()));
  Open({(folder / "mine").string()}, folder / "a.gltf");
  const HttpResponse first = Frame();
  ASSERT_EQ(first.status, 200) << first.body;
  EXPECT_THAT(State()["objects"], ElementsAre("Tile"));
  fs::rename(folder / "a.bin", folder / "away");
  EXPECT_THAT(Await("problem")["message"].get<std::string>(), HasSubstr("a.bin"));
  EXPECT_THAT(State()["objects"], ElementsAre("Tile")) << "as long as the page still shows it";
  fs::rename(folder / "away", folder / "a.bin");
  EXPECT_TRUE(Await("problem").is_null());
  EXPECT_EQ(Frame().body, first.body);
}

}  // namespace
}  // namespace scumble
