// What the installed API does with values that its callers may get wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "pipeline/scene/scene_sequence.h"
#include "scumble/scumble.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

TEST(Library, APictureWhoseMembersDoNotFitIsAnError) {
  const TemporaryFolder folder;
  for (const char* const name : {"p.png", "p.tif", "p.exr", "p.jpg"}) {
    const std::string file = (folder / name).string();
    const auto refuses = [&](const Picture& picture, const std::string& words) {
      const Status status = SavePicture(file, picture);
      ASSERT_FALSE(status) << name << " " << words;
      EXPECT_EQ(status.error().kind, ErrorKind::kUsage);
      EXPECT_NE(status.error().message.find(name), std::string::npos) << status.error().message;
      EXPECT_NE(status.error().message.find(words), std::string::npos) << status.error().message;
      EXPECT_FALSE(std::filesystem::exists(file));
    };
    Picture large(4, 4);
    large.width = large.height = 6000;
    refuses(large, "6000×6000 with 64 values in rgba; expected 144000000");
    Picture bare(4, 4);
    bare.rgba.clear();
    refuses(bare, "4×4 with 0 values");
    Picture more(4, 4);
    more.rgba.push_back(0);
    refuses(more, "with 65 values in rgba; expected 64");
    Picture negative(4, 4);
    negative.width = -3;
    refuses(negative, "-3×4");
    negative.height = -4;
    refuses(negative, "-3×-4");
    refuses(Picture(), "at least 1×1");
  }
  EXPECT_TRUE(SavePicture((folder / "p.png").string(), Picture(4, 4)));
}

// oneTBB warns of threads beyond the cores, unless it is told of them.
TEST(Library, MoreThreadsThanCoresPrintNothing) {
  SceneSettings scene;
  scene.file = std::string(SCUMBLE_SOURCE_DIR) + "/scenes/ball.glb";
  scene.width = scene.height = 32;
  StylizerOptions more, most;
  more.threads = int(std::thread::hardware_concurrency()) + 1, most.threads = more.threads + 3;
  ::testing::internal::CaptureStderr();
  std::vector<std::jthread> users;
  for (const StylizerOptions& options : {more, most}) {
    users.emplace_back([&scene, options] {
      Stylizer stylizer(options);
      StyleSettings style;
      style.style = std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/oil";
      EXPECT_TRUE(stylizer.Paint(scene, style));
    });
  }
  users.clear();
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

// Measured as guidegen does, with and without what the Stylizer has kept.
TEST(Library, ViewsAndLightsOutsideTheirRangeAreRefused) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  Stylizer stylizer;
  const auto refuses = [&](const std::string& words, const auto& change) {
    SceneSettings scene;
    scene.file = std::string(SCUMBLE_SOURCE_DIR) + "/scenes/ball.glb";
    scene.width = 16, scene.height = 16;
    scene.view.emplace(), scene.light.emplace();
    change(scene);
    const auto guides = stylizer.Guides(scene, {});
    ASSERT_FALSE(guides) << words;
    EXPECT_EQ(guides.error().kind, ErrorKind::kUsage) << guides.error().message;
    EXPECT_EQ(guides.error().message.substr(0, words.size()), words);
  };
  refuses("frame -2147483648", [&](SceneSettings& scene) { scene.frame = std::numeric_limits<int>::min(); });
  refuses("view.azimuth", [&](SceneSettings& scene) { scene.view->azimuth = kNaN; });
  refuses("view.elevation must be -90 to 90, found 90.5", [&](SceneSettings& scene) { scene.view->elevation = 90.5; });
  refuses("view.distance", [&](SceneSettings& scene) { scene.view->distance = kInfinity; });
  refuses("view.up must be finite, found nan", [&](SceneSettings& scene) { scene.view->up = kNaN; });
  refuses("view.fov", [&](SceneSettings& scene) { scene.view->fov = 180.0; });
  refuses("width 0 is out of range; expected 1 to 32768", [&](SceneSettings& scene) { scene.width = 0; });
  refuses("width and height 32768x32768: expected at most",
          [&](SceneSettings& scene) { scene.width = scene.height = 32768; });
  refuses("coverage_samples 17 is out of range; expected 1 to 16",
          [&](SceneSettings& scene) { scene.coverage_samples = 17; });
  refuses("instruction_set \"foo\" is unknown: expected one of",
          [&](SceneSettings& scene) { scene.instruction_set = "foo"; });
  refuses("view_layer is for .blend scenes", [&](SceneSettings& scene) { scene.view_layer = "a"; });
  refuses("blender_scene is for .blend scenes", [&](SceneSettings& scene) { scene.blender_scene = "a"; });
  refuses("animation plays with the frames' numbers: give frame N",
          [&](SceneSettings& scene) { scene.animation = "a"; });
  refuses("light.azimuth", [&](SceneSettings& scene) { scene.light->azimuth = kInfinity; });
  refuses("light.elevation", [&](SceneSettings& scene) { scene.light->elevation = kNaN; });
}

// No option of the command line is named, neither as what is wrong nor as what to do.
TEST(Library, ErrorsNameMembers) {
  StylizerOptions options;
  options.data_folder = SCUMBLE_SOURCE_DIR;
  Stylizer stylizer(options);
  const auto refusal = [&](const StyleSettings& style, const PaintSettings& paint = {}) {
    SceneSettings scene;
    scene.file = std::string(SCUMBLE_SOURCE_DIR) + "/scenes/ball.glb";
    scene.width = 17, scene.height = 16;
    const auto painted = stylizer.Paint(scene, style, paint);
    EXPECT_FALSE(painted);
    const std::string message = painted ? "" : painted.error().message;
    EXPECT_EQ(message.find("--"), std::string::npos) << message;
    return message.substr(0, message.find_first_of(":;"));
  };
  EXPECT_EQ(refusal({.style = "oil", .overrides = {"transfer.scale"}}), "overrides transfer.scale");
  EXPECT_EQ(refusal({.style = "oil", .overrides = {"finish.pen.width=2"}}), "overrides finish.pen.width=2");
  EXPECT_EQ(refusal({.style = "oil", .assignments = {"Ball"}}), "assignments Ball");
  EXPECT_EQ(refusal({.style = "oil", .assignments = {"Ball=catcher"}}), "assignments Ball=catcher");
  EXPECT_EQ(refusal({.style = "oil", .finishes = {"nothing"}}), "finishes nothing");
  EXPECT_EQ(refusal({.style = "oil"}, {.exposure = {}, .upsample = 2}), "width and height 17x16 with upsample 2");
  EXPECT_EQ(refusal({.style = "oil"}, {.exposure = {}, .upsample = 9}), "upsample 9");
  EXPECT_EQ(refusal({.style = "oil"}, {.exposure = {}, .upscale = true}), "upscale");
  options.data_folder = "/nowhere";
  Stylizer moved(options);
  const auto none = moved.Paint({.file = "a.obj"}, {.style = "oil"});
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("there are none in /nowhere"), std::string::npos) << none.error().message;
}

TEST(Library, MotionIsThatOfGuidegen) {
  SceneSettings scene;
  scene.file = std::string(SCUMBLE_SOURCE_DIR) + "/scenes/toys.glb";
  scene.width = 32, scene.height = 18;
  Stylizer stylizer;
  const auto at_rest = stylizer.Guides(scene, {Layer::kMotion});
  ASSERT_FALSE(at_rest);
  EXPECT_EQ(at_rest.error().kind, ErrorKind::kUsage);
  EXPECT_NE(at_rest.error().message.find("from one frame to the next"), std::string::npos) << at_rest.error().message;
  const LayersFor layers_for = [](const SceneStyleRequests&) -> Expected<LayerSet> { return LayerSet{Layer::kMotion}; };
  SceneRequest request;
  request.scene = scene.file, request.size = {scene.width, scene.height};
  for (const int frame : {10, 11}) {
    scene.frame = frame;
    if (frame == 11) {
      ASSERT_TRUE(stylizer.Guides(scene)) << "its rays are kept";
    }
    const auto found = stylizer.Guides(scene, {Layer::kMotion});
    ASSERT_TRUE(found) << found.error().message;
    const auto expected = MakeGuidesAt(frame, request, layers_for, true, {}, {});
    ASSERT_TRUE(expected) << expected.error().message;
    double moved = 0.0;
    for (const int component : {0, 1}) {
      const auto here = found->Plane(Layer::kMotion, component);
      const auto there = expected->guides.Plane(Layer::kMotion, component);
      EXPECT_TRUE(std::equal(here.begin(), here.end(), there.begin(), there.end())) << frame << " " << component;
      for (const float value : here) moved += std::fabs(value);
    }
    EXPECT_GT(moved, 1.0) << "something moves";
  }
  scene.frame = 999'999'999;
  EXPECT_TRUE(stylizer.Guides(scene, {Layer::kMotion}));
  scene.frame = std::numeric_limits<int>::max();
  EXPECT_FALSE(stylizer.Guides(scene, {Layer::kMotion}));
}

TEST(Library, WhatWasMovedFromMayBeCancelled) {
  Stylizer first;
  Stylizer second(std::move(first));
  first.Cancel();
  second.Cancel();
  first = Stylizer();
  EXPECT_EQ(first.counters().scenes_loaded, 0u);
}

}  // namespace
}  // namespace scumble
