// Pictures whose pixels choose how many samples of light they take, against pictures with 1,024 samples each.
#include <cmath>
#include <string>

#include "core/style/style_file.h"
#include "measure/flip.h"
#include "tests/support/light_path_scenes.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

Light SquareLamp(const glm::dvec3& at, double size, double radiance) {
  Light light = PointLight(at, radiance);
  light.type = LightType::kArea;
  light.size_x = light.size_y = size;
  return light;
}

// StyLit's set-up: a ball on the ground under one lamp. Lit from +Z, which is up.
Scene BallUnderALamp() {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.7f), 6.0);
  AddObject(scene, "ball", BallMesh(24), glm::scale(Moved(0, 0, 0.8), glm::dvec3(0.8)));
  scene.lights = {SquareLamp({-1.5, 1.2, 4.0}, 1.2, 12.0)};
  return scene;
}

// Pillars and crates under six lamps, as in a level of a game.
Scene CratesUnderSixLamps() {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.7f), 6.0);
  for (int i = 0; i < 14; ++i) {
    const double side = 0.12 + 0.03 * (i % 4), high = i % 3 ? side : 1.4;
    AddObject(
        scene, "crate " + std::to_string(i), CubeMesh(),
        glm::scale(Moved(2.2 * std::cos(2.4 * i) * (0.3 + 0.05 * i), 1.8 * std::sin(2.4 * i) * (0.3 + 0.05 * i), high),
                   glm::dvec3(side, side, high)));
  }
  for (int i = 0; i < 6; ++i) {
    scene.lights.push_back(SquareLamp({2.5 * std::cos(1.05 * i), 2.0 * std::sin(1.05 * i), 3.0}, 0.5, 6.0));
  }
  return scene;
}

Picture PaintedWith(const Scene& scene, const Style& style, int samples, double light_error) {
  GuidegenOptions options = Sized(96, 54, RequiredLayers(style));
  options.samples = samples, options.light_error = light_error;
  const GuideSet guides = Render(scene, LookingAt({0, -4.5, 3.6}, {0, 0, 0.5}, 45.0), options).guides;
  return MustTransfer(style, guides).picture;
}

double MeanFlip(const Picture& a, const Picture& b) {
  const auto report = MeasureFlip(a, b);
  EXPECT_TRUE(report.ok());
  return report->mean;
}

TEST(LightSamples, PicturesAreThoseOfAThousandSamples) {
  for (const char* name : {"chiaroscuro", "gouache"}) {
    const auto style = LoadStyle(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/" + name);
    ASSERT_TRUE(style.ok()) << style.error().message;
    ASSERT_TRUE(LooksAtLight(*style));
    for (const Scene& scene : {BallUnderALamp(), CratesUnderSixLamps()}) {
      SCOPED_TRACE(name + std::string(scene.lights.size() > 1 ? ", crates" : ", ball"));
      const Picture truth = PaintedWith(scene, *style, 1024, 0.0);
      const double chosen = MeanFlip(truth, PaintedWith(scene, *style, 64, kUnseenLightError));
      EXPECT_LE(chosen, 0.01);
      EXPECT_GT(MeanFlip(truth, PaintedWith(scene, *style, 1, 0.0)), 2 * chosen) << "one sample must show";
    }
  }
}

}  // namespace
}  // namespace scumble
