// What is said where light keeps its noise.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pipeline/scene_guides.h"
#include "tests/support/light_path_scenes.h"

namespace scumble::testing {
namespace {

using ::testing::ElementsAre, ::testing::HasSubstr, ::testing::IsEmpty;

// The notes on noise of a floor under many lamps, cast twice as two frames are.
std::vector<std::string> NoiseNotes(int samples, bool given) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.5f), 3.0);
  for (int i = 0; i < 12; ++i) {
    Light light = PointLight({i - 6.0, i % 3 - 1.0, 0.5 + 0.1 * i}, 10.0);
    light.radius = 0.3;
    scene.lights.push_back(light);
  }
  SceneRequest request;
  request.size = {24, 16};
  request.view.emplace();
  request.samples = samples, request.samples_given = given;
  std::vector<std::string> notes;
  RunContext context;
  context.on_message = [&](const Message& message) {
    if (message.text.find("noisy") != std::string::npos) notes.push_back(message.text);
  };
  for (int frame = 0; frame < 2; ++frame) {
    EXPECT_TRUE(MakeGuidesOf(scene, request, {Layer::kLuminance}, context.WithoutNotes(), {}));
    EXPECT_TRUE(MakeGuidesOf(scene, request, {Layer::kLuminance}, context, {}));
  }
  return notes;
}

TEST(LightNoise, ThatStaysIsSaidOnce) {
  EXPECT_THAT(NoiseNotes(4, false), ElementsAre(HasSubstr("1.5% is wanted; try --samples 16")));
  EXPECT_THAT(NoiseNotes(4, true), IsEmpty()) << "who sets the number has chosen";
  EXPECT_THAT(NoiseNotes(1024, false), IsEmpty());
}

}  // namespace
}  // namespace scumble::testing
