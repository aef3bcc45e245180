// A workspace reads files again that have changed, and no others.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/io/picture_file.h"
#include "scumble/stylizer.h"
#include "tests/pipeline/workspace_fixtures.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

// A triangle before the camera, that asks for a style.
void WriteSceneWithStyle(const fs::path& file, const std::string& style) {
  GltfBuilder b;
  const int position = b.Floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  b.Mesh({{{"attributes", {{"POSITION", position}}}}});
  b.Root({{"name", "Tile"}, {"mesh", 0}, {"extras", {{"scumble_style", style}}}});
  const std::vector<unsigned char> glb = b.Glb();
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(glb.data()), std::streamsize(glb.size()));
}

void CopyStyle(const std::string& bundled, const fs::path& folder) {
  fs::copy(kSource + "/exemplars/" + bundled, folder, fs::copy_options::recursive);
}

SceneRequest SceneIn(const fs::path& file) {
  SceneRequest request = SceneOf("suzanne");
  request.scene = file.string();
  return request;
}

TEST(Workspace, TheStylesOfASceneAreKept) {
  const TemporaryFolder folder;
  WriteSceneWithStyle(folder / "a/s.glb", "mine");
  CopyStyle("charcoal", folder / "a/mine");
  Workspace workspace(Context());
  const Picture first = Painted(workspace, SceneIn(folder / "a/s.glb"), StyleOf("oil"));
  EXPECT_EQ(Painted(workspace, SceneIn(folder / "a/s.glb"), StyleOf("oil")).rgba, first.rgba);
  EXPECT_EQ(workspace.counters().styles_loaded, 1u);
  EXPECT_EQ(workspace.counters().styles_prepared, 2u);
  // A key that exemplars do not depend on, for both styles.
  Painted(workspace, SceneIn(folder / "a/s.glb"), StyleOf("oil", {"transfer.threshold=0.4"}));
  EXPECT_EQ(workspace.counters().styles_loaded, 2u);
  EXPECT_EQ(workspace.counters().styles_prepared, 2u);
  EXPECT_EQ(workspace.counters().guides_cast, 1u);
  // A painting of the scene's own style.
  fs::copy_file(kSource + "/exemplars/ink/lit.png", folder / "a/mine/lit.png", fs::copy_options::overwrite_existing);
  EXPECT_NE(Painted(workspace, SceneIn(folder / "a/s.glb"), StyleOf("oil")).rgba, first.rgba);
  EXPECT_EQ(workspace.counters().styles_prepared, 3u);
  EXPECT_EQ(workspace.counters().scenes_loaded, 1u);
}

TEST(Workspace, AStyleOfASceneIsThatOfItsFolder) {
  const TemporaryFolder folder;
  for (const auto& [name, style] : {std::pair("a", "charcoal"), {"b", "oil"}}) {
    WriteSceneWithStyle(folder / name / "s.glb", "mine");
    CopyStyle(style, folder / name / "mine");
  }
  Workspace workspace(Context());
  const Picture a = Painted(workspace, SceneIn(folder / "a/s.glb"), StyleOf("oil"));
  const Picture b = Painted(workspace, SceneIn(folder / "b/s.glb"), StyleOf("oil"));
  EXPECT_NE(a.rgba, b.rgba);
  Workspace fresh(Context());
  EXPECT_EQ(b.rgba, Painted(fresh, SceneIn(folder / "b/s.glb"), StyleOf("oil")).rgba);
  EXPECT_EQ(workspace.counters().styles_loaded, 1u) << "the user's is that of before";
  EXPECT_EQ(workspace.counters().styles_prepared, 3u);
  // A scene that asks for none has none.
  const auto plain = workspace.Paint(SceneOf("suzanne"), StyleOf("oil"), {});
  ASSERT_TRUE(plain.ok());
  EXPECT_EQ(std::get<PictureReport>(plain->report.made).styles.size(), 1u);
}

TEST(Workspace, AChangedPictureUnderneathIsReadAgain) {
  const TemporaryFolder folder;
  PictureRequest picture;
  picture.over = (folder / "over.png").string();
  Workspace workspace(Context());
  Picture over(96, 54);
  std::fill(over.rgba.begin(), over.rgba.end(), std::uint16_t(0xffff));
  ASSERT_TRUE(WritePicture(picture.over, over));
  const Picture bright = Painted(workspace, SceneOf("suzanne"), StyleOf("oil"), picture);
  for (std::size_t i = 0; i < over.rgba.size(); i += 4) over.rgba[i] = 0;
  ASSERT_TRUE(WritePicture(picture.over, over));
  const Picture dark = Painted(workspace, SceneOf("suzanne"), StyleOf("oil"), picture);
  EXPECT_NE(dark.rgba, bright.rgba);
  Workspace fresh(Context());
  EXPECT_EQ(dark.rgba, Painted(fresh, SceneOf("suzanne"), StyleOf("oil"), picture).rgba);
  EXPECT_EQ(workspace.counters().guides_cast, 1u);
}

// Wavefront's materials do without a texture that cannot be read, in every pose and in every later cast.
TEST(Workspace, ATextureThatIsMissingStaysLeftOut) {
  const TemporaryFolder folder;
  const auto write = [&](const char* name, const char* text) { std::ofstream(folder / name) << text; };
  write("tile.mtl", "newmtl m\nKd 0.9 0.2 0.1\nmap_Kd gone.png\n");
  write("tile.obj",
        "mtllib tile.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\n"
        "f 1/1 2/2 3/3 4/4\n");
  SceneRequest scene = SceneIn(folder / "tile.obj"), turned = scene;
  turned.view = ViewAngles{30.0, 10.0, 0.0};
  Workspace workspace(Context());
  Painted(workspace, scene, StyleOf("oil"));  // looks at no texture
  const Picture tinted = Painted(workspace, scene, StyleOf("tinted-oil"));
  const Picture other = Painted(workspace, turned, StyleOf("tinted-oil"));
  Workspace fresh(Context()), fresh_turned(Context());
  EXPECT_EQ(tinted.rgba, Painted(fresh, scene, StyleOf("tinted-oil")).rgba);
  EXPECT_EQ(other.rgba, Painted(fresh_turned, turned, StyleOf("tinted-oil")).rgba);
  EXPECT_EQ(workspace.counters().scenes_loaded, 1u);
  EXPECT_EQ(workspace.counters().structures_built, 3u) << "it depends on materials, and on the camera";
}

// Also where it is in the folder of the library, was missing, or could not be loaded with the scene.
TEST(Workspace, AFileOfTheSceneThatChangedIsReadAgain) {
  const TemporaryFolder folder;
  const auto write = [&](const char* name, const std::string& text) { std::ofstream(folder / name) << text; };
  fs::create_directory(folder / "tex");
  write("tex/tile.mtl", "newmtl m\nmap_Kd skin.png\n");
  write("tile.obj", "mtllib tex\\tile.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  const SceneRequest scene = SceneIn(folder / "tile.obj");
  const std::string skin = (folder / "tex/skin.png").string();
  Workspace workspace(Context());
  const Picture without = Painted(workspace, scene, StyleOf("tinted-oil"));
  EXPECT_THAT(workspace.SceneFiles(), testing::Contains(skin)) << "to wait for it";
  Picture texture(8, 8);
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4) texture.rgba[i - 3] = texture.rgba[i] = 0xffff;
  ASSERT_TRUE(WritePicture(skin, texture));
  const Picture red = Painted(workspace, scene, StyleOf("tinted-oil"));
  EXPECT_NE(red.rgba, without.rgba);
  fs::remove(skin);
  EXPECT_EQ(Painted(workspace, scene, StyleOf("tinted-oil")).rgba, without.rgba);
  EXPECT_EQ(workspace.counters().scenes_loaded, 3u);
  write("lost.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"lost.bin"}]})");
  EXPECT_FALSE(workspace.Describe(SceneIn(folder / "lost.gltf"), std::nullopt));
  EXPECT_THAT(workspace.SceneFiles(), testing::Contains((folder / "lost.bin").string()));
}

TEST(Workspace, AnotherSmoothingLoadsTheFileAgain) {
  const TemporaryFolder folder;
  std::ofstream(folder / "roof.obj")
      << "v -1 0 0\nv 0 0 1\nv 0 1 1\nv -1 1 0\nv 1 0 0\nv 1 1 0\nf 1 2 3 4\nf 2 5 6 3\n";
  SceneRequest scene = SceneIn(folder / "roof.obj"), smooth = scene;
  smooth.auto_smooth_degrees = 180.0;
  Workspace workspace(Context());
  const Picture before = Painted(workspace, scene, StyleOf("oil"));
  const Picture round = Painted(workspace, smooth, StyleOf("oil"));
  EXPECT_NE(round.rgba, before.rgba);
  Painted(workspace, smooth, StyleOf("oil"));
  EXPECT_EQ(workspace.counters().scenes_loaded, 2u);
  EXPECT_EQ(Painted(workspace, scene, StyleOf("oil")).rgba, before.rgba);
  // As the API has it.
  Stylizer stylizer;
  SceneSettings settings;
  settings.file = scene.scene, settings.width = 96, settings.height = 54;
  settings.auto_smooth = 180.0;
  const auto painted = stylizer.Paint(settings, {.style = kSource + "/exemplars/oil"});
  ASSERT_TRUE(painted.ok()) << painted.error().message;
  EXPECT_EQ(painted->rgba, round.rgba);
  for (const double wrong : {-1.0, 180.5, std::nan("")}) {
    settings.auto_smooth = wrong;
    const auto refused = stylizer.Paint(settings, {.style = kSource + "/exemplars/oil"});
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
  }
}

// Stands for Blender, as export_scene.py would be run.
class FakeBlender {
 public:
  // `body` finds the values of --output and --files-file in $output and $files.
  explicit FakeBlender(const std::string& body) {
    fs::create_directory(folder_ / "tmp");
    std::ofstream(folder_ / "shot.blend");
    std::ofstream(folder_ / "blender")
        << "#!/bin/sh\nfor word; do\n"
           "case \"$last\" in --output) output=$word;; --files-file) files=$word;; esac\n"
           "last=$word; done\n"
        << body << "\n";
    fs::permissions(folder_ / "blender", fs::perms::owner_all);
  }
  SceneRequest Scene() const {
    SceneRequest request = SceneOf("suzanne");
    request.scene = (folder_ / "shot.blend").string();
    request.blender.program = (folder_ / "blender").string();
    return request;
  }
  RunContext Environment() const {
    RunContext context = Context();
    context.temporary_folder = folder_ / "tmp";
    return context;
  }
  const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
};

TEST(Workspace, ALinkedLibraryThatChangedExportsAgain) {
  const TemporaryFolder libraries;
  const std::string library = (libraries / "library.blend").string();
  std::ofstream(library) << "one";
  const FakeBlender blender("cp " + kSource + "/scenes/suzanne.glb \"$output\"; echo " + library + " > \"$files\"");
  Workspace workspace(blender.Environment());
  const Picture first = Painted(workspace, blender.Scene(), StyleOf("oil"));
  EXPECT_EQ(Painted(workspace, blender.Scene(), StyleOf("oil")).rgba, first.rgba);
  EXPECT_EQ(workspace.counters().scenes_loaded, 1u);
  std::ofstream(library) << "another";
  EXPECT_EQ(Painted(workspace, blender.Scene(), StyleOf("oil")).rgba, first.rgba);
  EXPECT_EQ(workspace.counters().scenes_loaded, 2u);
  EXPECT_EQ(workspace.counters().styles_prepared, 1u);
}

TEST(Workspace, AnExportByBlenderIsCancelled) {
  const FakeBlender blender("echo > \"$(dirname \"$output\")/../../runs\"; sleep 60");
  Workspace workspace(blender.Environment());
  std::thread canceller([&] {
    while (!fs::exists(blender.folder() / "runs")) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    workspace.Cancel();
  });
  const auto begin = std::chrono::steady_clock::now();
  const auto painted = workspace.Paint(blender.Scene(), StyleOf("oil"), {});
  canceller.join();
  ASSERT_FALSE(painted.ok());
  EXPECT_EQ(painted.error().kind, ErrorKind::kCancelled) << painted.error().message;
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
  EXPECT_TRUE(fs::is_empty(blender.folder() / "tmp"));
  Painted(workspace, SceneOf("suzanne"), StyleOf("oil"));
}

TEST(Workspace, AnEditedAssignmentFileIsReadAgain) {
  const TemporaryFolder folder;
  const std::string sheet = (folder.path() / "sheet.txt").string();
  const auto write = [&](const std::string& text) { std::ofstream(sheet) << text; };
  write("Nothing* = ink\n");
  StyleRequest style = StyleOf("oil");
  style.assigned = {"@" + sheet};
  Workspace workspace(Context());
  const Picture plain = Painted(workspace, SceneOf("suzanne"), style);
  write("* = charcoal and longer\n");
  write("* = charcoal\n");
  EXPECT_NE(Painted(workspace, SceneOf("suzanne"), style).rgba, plain.rgba);
}

}  // namespace
}  // namespace scumble
