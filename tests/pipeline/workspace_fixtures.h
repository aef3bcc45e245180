// What the tests of the workspace share.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/io/picture_file.h"
#include "pipeline/workspace.h"
#include "tests/support/temporary_folder.h"

namespace scumble {

namespace fs = std::filesystem;

inline const std::string kSource = SCUMBLE_SOURCE_DIR;

inline RunContext Context() {
  RunContext context;
  context.data_roots = {kSource};
  return context;
}

inline SceneRequest SceneOf(const std::string& name) {
  SceneRequest request;
  request.scene = kSource + "/scenes/" + name + ".glb";
  request.size = {96, 54};
  request.samples = 2, request.samples_given = true;
  return request;
}

inline StyleRequest StyleOf(const std::string& style, const std::vector<std::string>& sets = {}) {
  StyleRequest request;
  request.style = style, request.sets = *ParseStyleOverrides(sets);
  return request;
}

inline Picture Painted(Workspace& workspace, const SceneRequest& scene, const StyleRequest& style,
                       const PictureRequest& picture = {}) {
  auto painted = workspace.Paint(scene, style, picture);
  EXPECT_TRUE(painted.ok()) << painted.error().message;
  return painted ? painted->picture : Picture();
}

// What the program writes for these options.
inline Picture Stylized(const std::string& options) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "p.png").string();
  const std::string command = std::string(SCUMBLE_BINARY) + " stylize " + options +
                              " --samples 2 --bits 16 --quiet -o " + file + " > /dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  const auto picture = ReadPicture(file);
  EXPECT_TRUE(picture.ok());
  return picture ? *picture : Picture();
}

}  // namespace scumble
