// Files that change while a workspace reads them: its next picture is that of the files as they are.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "core/io/picture_file.h"
#include "pipeline/workspace.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

Picture Ball(std::uint16_t red) {
  Picture ball(16, 16);
  for (std::size_t i = 0; i < ball.rgba.size(); i += 4) ball.rgba[i] = red, ball.rgba[i + 3] = 65535;
  return ball;
}

class WorkspaceRaces : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"one", "two"}) {
      fs::create_directories(folder / name);
      std::ofstream(folder / name / "style.toml") << "[[exemplar]]\nimage = \"lit.png\"\n";
      Save(name, 10000);
    }
    scene.scene = std::string(SCUMBLE_SOURCE_DIR) + "/scenes/ball.glb";
    scene.size = {32, 18};
    style.style = (folder / "one").string();
    style.assigned = {"no such=" + (folder / "two").string()};
  }

  void Save(const std::string& name, std::uint16_t red) {
    ASSERT_TRUE(WritePicture(folder / "new.png", Ball(red)));
    fs::rename(folder / "new.png", folder / name / "lit.png");
  }

  Picture Paint(Workspace& workspace) {
    auto painted = workspace.Paint(scene, style, {});
    EXPECT_TRUE(painted.ok()) << painted.error().message;
    return painted ? std::move(painted->picture) : Picture();
  }

  TemporaryFolder folder;
  SceneRequest scene;
  StyleRequest style;
};

// At every moment at which a workspace asks whether it is cancelled, between the reading of two files for one.
TEST_F(WorkspaceRaces, AStyleThatIsSavedWhileItIsReadIsReadAgain) {
  Workspace fresh{RunContext()};
  const Picture before = Paint(fresh);
  Save("one", 50000);
  const Picture after = Paint(fresh);
  ASSERT_NE(after.rgba, before.rgba);
  bool was_late = false;
  for (int moment = 1; !was_late; ++moment) {
    ASSERT_LT(moment, 1000);
    Save("one", 10000);
    int calls = 0;
    RunContext context;
    context.is_cancelled = [&] {
      if (++calls == moment) Save("one", 50000);
      return false;
    };
    Workspace workspace(context);
    Paint(workspace);
    was_late = calls < moment;
    if (was_late) Save("one", 50000);
    EXPECT_EQ(Paint(workspace).rgba, after.rgba) << "saved at moment " << moment;
    // Likewise where the files are known already.
    Save("one", 10000);
    EXPECT_EQ(Paint(workspace).rgba, before.rgba);
    calls = 0;
    Save("two", std::uint16_t(moment));
    Paint(workspace);
    if (calls < moment) Save("one", 50000);
    EXPECT_EQ(Paint(workspace).rgba, after.rgba) << "saved again at moment " << moment;
  }
}

}  // namespace
}  // namespace scumble
