// The scenes of tests/blender/make_cases.py, for the tests that export them with the real Blender.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/temporary_folder.h"

namespace scumble {

inline constexpr const char* kHeadlessBlender = "blender -b -noaudio --factory-startup -Y ";

// Made and exported once for all tests of a program, which registers it as a global environment.
class BlenderCases : public testing::Environment {
 public:
  void SetUp() override {
    folder_ = new TemporaryFolder;
    Shell(kHeadlessBlender + ("-P " + Source("tests/blender/make_cases.py")) + " -- --output " +
          folder_->path().string());
    for (const char* name :
         {"lamps", "materials", "objects", "deformed", "cameras", "rendered", "broken", "bordered", "old"})
      Export(name, "", name);
    Export("bordered", " --scene Cropped", "cropped");
    Export("objects", " --frame 6", "objects6");
    Export("deformed", " --frame 6", "deformed6");
    expected_ = nlohmann::json::parse(std::ifstream(*folder_ / "expected.json"), nullptr, false);
    ASSERT_TRUE(expected_.is_object()) << "make_cases.py wrote no expected.json";
  }
  void TearDown() override { delete folder_; }

  // Cycles' data passes through these cameras of the scene, as "Camera:160x90".
  static void Render(const std::string& scene, const std::string& views) {
    Shell(kHeadlessBlender + File(scene + ".blend").string() + " -P " + Source("tests/blender/render_normals.py") +
          " -- --output " + folder_->path().string() + " --view " + views);
  }

  static std::filesystem::path File(const std::string& name) { return *folder_ / name; }
  static const nlohmann::json& Expected(const std::string& name) { return expected_[name]; }
  static std::string Source(const std::string& name) { return std::string(SCUMBLE_SOURCE_DIR) + "/" + name; }

 private:
  static void Shell(const std::string& command) {
    const std::string log = (*folder_ / "log").string();
    if (std::system((command + " > " + log + " 2>&1").c_str()) == 0) return;
    std::ifstream stream(log);
    FAIL() << command << "\n" << std::string(std::istreambuf_iterator<char>(stream), {});
  }
  static void Export(const std::string& scene, const std::string& more, const std::string& name) {
    Shell(kHeadlessBlender + File(scene + ".blend").string() + " -P " + Source("blender_scripts/export_scene.py") +
          " -- --output " + File(name + ".glb").string() + more);
  }

  inline static TemporaryFolder* folder_ = nullptr;
  inline static nlohmann::json expected_;
};

}  // namespace scumble
