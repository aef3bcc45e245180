// A camera's border: what lies within it has the bytes of the whole frame, or is the whole picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "guidegen/guidegen.h"
#include "guidegen/rays/camera_rays.h"
#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"

namespace scumble::testing {
namespace {

constexpr int kFrameWidth = 90, kFrameHeight = 61;

Scene LitScene() {
  Scene scene = SceneOf(BallMesh(12));
  AddObject(scene, "wall", QuadMesh(), Moved(0.0, 0.0, -2.0) * glm::scale(glm::dmat4(1.0), glm::dvec3(6.0)));
  scene.lights.push_back(PointLight({2.0, 4.0, 4.0}, 40.0));
  scene.lights.back().radius = 0.5;
  return scene;
}

GuidegenOptions LitLayers(int width, int height) {
  GuidegenOptions options =
      Sized(width, height,
            {Layer::kPosition, Layer::kAlbedo, Layer::kLuminance, Layer::kShadow, Layer::kLpeLDE, Layer::kLpeFull});
  options.samples = 4, options.aa = 2;
  return options;
}

GuideSet CastLit(const Camera& camera, int width, int height) {
  const auto result = RenderGuides(LitScene(), camera, LitLayers(width, height));
  EXPECT_TRUE(result) << (result ? "" : result.error().message);
  return result ? result->guides : GuideSet(1, 1);
}

Camera BorderedCamera(std::optional<CameraBorder> border = std::nullopt) {
  Camera camera = LookingAt({1.0, 0.8, 5.0}, {0.0, 0.0, 0.0});
  camera.fit = CameraFit::kLonger;
  camera.shift_x = 0.07, camera.shift_y = -0.04;
  camera.border = border;
  return camera;
}

TEST(CameraBorder, TheWindowIsBlendersWholePixels) {
  const auto window = [](CameraBorder border, int width, int height) {
    return CameraRays::Make(BorderedCamera(border), width, height)->window();
  };
  // 0.213 · 90 = 19.17, 0.777 · 90 = 69.93; from below 0.127 · 61 = 7.7, 0.903 · 61 = 55.08.
  EXPECT_EQ(window({0.213, 0.127, 0.777, 0.903}, kFrameWidth, kFrameHeight), (PixelWindow{19, 61 - 55, 69, 61 - 7}));
  EXPECT_EQ(window({0.0, 0.0, 1.0, 1.0}, kFrameWidth, kFrameHeight), (PixelWindow{0, 0, kFrameWidth, kFrameHeight}));
  EXPECT_EQ(window({0.213, 0.127, 0.777, 0.903, true}, kFrameWidth, kFrameHeight),
            (PixelWindow{0, 0, kFrameWidth, kFrameHeight}));
  EXPECT_EQ(window({0.7, 0.0, 1.0, 1.0}, 10, 10).x0, 7) << "in floats 0.7 · 10 is 7";
}

TEST(CameraBorder, OutsideIsBackgroundAndInsideTheFramesBytes) {
  const GuideSet whole = CastLit(BorderedCamera(), kFrameWidth, kFrameHeight);
  const CameraBorder border{0.213, 0.127, 0.777, 0.903};
  const GuideSet part = CastLit(BorderedCamera(border), kFrameWidth, kFrameHeight);
  const PixelWindow window = CameraRays::Make(BorderedCamera(border), kFrameWidth, kFrameHeight)->window();
  ASSERT_EQ(part.layers(), whole.layers());
  EXPECT_EQ(part.camera->clip_from_view, whole.camera->clip_from_view);
  for (const LayerInfo& info : AllLayers()) {
    for (int c = 0; part.Has(info.layer) && c < ChannelCount(info.layer); ++c) {
      const auto there = part.Plane(info.layer, c), frame = whole.Plane(info.layer, c);
      std::size_t wrong = 0;
      for (int y = 0; y < kFrameHeight; ++y) {
        for (int x = 0; x < kFrameWidth; ++x) {
          const std::size_t i = part.Index(x, y);
          const float expected = window.Contains(x, y) ? frame[i] : BackgroundValue(info.layer);
          wrong += std::memcmp(&there[i], &expected, sizeof expected) != 0;
        }
      }
      EXPECT_EQ(wrong, 0u) << info.name << " " << c;
    }
  }
}

TEST(CameraBorder, WithoutAPixelThePictureIsEmpty) {
  for (const CameraBorder border : {CameraBorder{0.5, 0.5, 0.501, 0.501}, CameraBorder{0.999, 0.0, 1.0, 0.01}}) {
    const GuideSet guides = CastLit(BorderedCamera(border), 20, 20);
    const auto coverage = guides.Plane(Layer::kCoverage);
    EXPECT_LE(std::count_if(coverage.begin(), coverage.end(), [](float a) { return a > 0.0f; }), 0);
  }
}

// Sides on whole pixels: the picture is that part of the frame, for every fit and both kinds of camera.
TEST(CameraBorder, ACroppedPictureIsThatPartOfTheFrame) {
  const PixelWindow window{18, 6, 72, 54};
  const CameraBorder border{18.0 / kFrameWidth, (kFrameHeight - 54.0) / kFrameHeight, 72.0 / kFrameWidth,
                            (kFrameHeight - 6.0) / kFrameHeight, true};
  for (const CameraFit fit : {CameraFit::kLonger, CameraFit::kHorizontal, CameraFit::kVertical}) {
    for (const bool orthographic : {false, true}) {
      Camera frame = BorderedCamera(), cropped = BorderedCamera(border);
      for (Camera* camera : {&frame, &cropped})
        camera->fit = fit, camera->orthographic = orthographic, camera->ymag = 3;
      const GuideSet whole = CastLit(frame, kFrameWidth, kFrameHeight);
      const GuideSet part = CastLit(cropped, window.x1 - window.x0, window.y1 - window.y0);
      std::size_t other = 0;
      double apart = 0.0;
      for (int y = window.y0; y < window.y1; ++y) {
        for (int x = window.x0; x < window.x1; ++x) {
          const std::size_t i = whole.Index(x, y), j = part.Index(x - window.x0, y - window.y0);
          if (whole.Plane(Layer::kObject)[i] != part.Plane(Layer::kObject)[j]) {
            ++other;
          } else {
            apart =
                std::max(apart, double(glm::length(whole.Vec3(Layer::kPosition, i) - part.Vec3(Layer::kPosition, j))));
          }
        }
      }
      EXPECT_LE(other, 1u) << int(fit) << orthographic << ": a ray at the very edge may see either side";
      EXPECT_LT(apart, 1e-5) << int(fit) << orthographic;
    }
  }
}

TEST(CameraBorder, SidesOutOfOrderAreNamed) {
  for (const CameraBorder border :
       {CameraBorder{0.5, 0.0, 0.5, 1.0}, CameraBorder{0.0, 0.7, 1.0, 0.2}, CameraBorder{-0.1, 0.0, 1.0, 1.0},
        CameraBorder{0.0, 0.0, 1.0, 1.1}, CameraBorder{std::nan(""), 0.0, 1.0, 1.0}}) {
    const auto rays = CameraRays::Make(BorderedCamera(border), kFrameWidth, kFrameHeight);
    ASSERT_FALSE(rays);
    EXPECT_EQ(rays.error().kind, ErrorKind::kInput);
    EXPECT_NE(rays.error().message.find("has a border"), std::string::npos) << rays.error().message;
  }
}

}  // namespace
}  // namespace scumble::testing
