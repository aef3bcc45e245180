// The camera that is solved from a Position pass against the true one.
#include "core/io/blender/solve_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/core/io/blender/true_camera.h"
#include "tests/support/refusal.h"

namespace scumble {
namespace {

// The solved camera against the true one: rotation in degrees, and the largest reprojection in pixels.
void ExpectSolved(const TrueCamera& truth, double degrees, double pixels, bool jittered = false) {
  const Render render(truth);
  const auto solved = render.Solve();
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_EQ(solved->orthographic, truth.orthographic);
  EXPECT_EQ(solved->jittered, jittered) << solved->error_pixels;
  const GuideCamera& camera = solved->camera;
  EXPECT_LT(AngleBetween(glm::dmat3(camera.view_from_world), truth.view_from_world), degrees);
  const glm::dmat4 clip_from_world = camera.clip_from_view * camera.view_from_world;
  double worst = 0.0;
  for (std::size_t i = 0; i < render.depth.size(); ++i) {
    if (render.depth[i] > 1e9f) continue;
    const glm::dvec4 clip = clip_from_world * glm::dvec4(render.At(i), 1.0);
    ASSERT_LE(std::fabs(clip.z), clip.w) << "between the near and the far plane";
    const glm::dvec2 found(0.5 * truth.width * (1 + clip.x / clip.w), 0.5 * truth.height * (1 - clip.y / clip.w));
    worst = std::max(worst, glm::length(found - truth.Project(render.At(i))));
  }
  EXPECT_LT(worst, pixels);
}

TEST(SolveCamera, PerspectiveFromAnySide) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    TrueCamera camera;
    camera.view_from_world = RandomRotation(seed);
    camera.origin = 20.0 * glm::dvec3(Uniform(seed, 4) - 0.5, Uniform(seed, 5) - 0.5, Uniform(seed, 6) - 0.5);
    camera.scale = 60.0 + 1500.0 * Uniform(seed, 7);
    if (seed % 2) camera.shift = {400.0 * Uniform(seed, 8) - 200.0, 200.0 * Uniform(seed, 9) - 100.0};
    if (seed % 3 == 0) std::swap(camera.width, camera.height);
    SCOPED_TRACE(seed);
    ExpectSolved(camera, 0.001, 0.002);
  }
}

TEST(SolveCamera, OrthographicFromAnySide) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    TrueCamera camera;
    camera.orthographic = true;
    camera.view_from_world = RandomRotation(seed);
    camera.scale = 5.0 + 200.0 * Uniform(seed, 7);
    if (seed % 2) camera.shift = {40.0 * Uniform(seed, 8), -30.0 * Uniform(seed, 9)};
    if (seed % 3 == 0) std::swap(camera.width, camera.height);
    SCOPED_TRACE(seed);
    ExpectSolved(camera, 0.001, 0.002);
  }
}

TEST(SolveCamera, FarFromTheOriginOfTheWorld) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    TrueCamera camera;
    camera.view_from_world = RandomRotation(seed);
    camera.origin = {1e4, -7e3, 9e3};  // floats are 1 mm apart there, 0.08 px at this distance
    camera.orthographic = seed % 2;
    if (camera.orthographic) camera.scale = 80.0;
    SCOPED_TRACE(seed);
    ExpectSolved(camera, 0.01, 0.01);
  }
}

TEST(SolveCamera, LargeAndSmallWorlds) {
  for (const double unit : {1e-4, 1e-2, 1e3, 1e6}) {
    TrueCamera camera;
    camera.view_from_world = RandomRotation(3);
    camera.depth = [unit](double u, double v) { return unit * (5.0 + std::sin(0.05 * u) + std::cos(0.08 * v)); };
    SCOPED_TRACE(unit);
    ExpectSolved(camera, 0.001, 0.002);
  }
}

TEST(SolveCamera, PositionsScatteredAroundPixelCentres) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    TrueCamera camera;
    camera.view_from_world = RandomRotation(seed);
    camera.shift = {20.0 * Uniform(seed, 8), 0.0};
    camera.jitter = [seed](int x, int y) {
      glm::dvec2 offset(0.0);
      for (int k = 0; k < 4; ++k) {
        offset += glm::dvec2(UnitFloat(Hash(seed, x, y, k)), UnitFloat(Hash(seed, x, y, k + 9))) - 0.5;
      }
      return 0.75 * offset;
    };
    camera.orthographic = seed % 3 == 0;
    if (camera.orthographic) camera.scale = 80.0;
    SCOPED_TRACE(seed);
    ExpectSolved(camera, 0.02, 0.03, true);
  }
}

TEST(SolveCamera, RefusesWhatNoCameraExplains) {
  const auto refuse = [](const TrueCamera& camera, const std::vector<std::string>& words) {
    const auto solved = Render(camera).Solve();
    auto all = words;
    all.insert(all.end(), {"shot.exr", "Blender render", "--camera FILE"});
    ExpectRefusal(solved, all);
  };
  for (const bool orthographic : {false, true}) {
    TrueCamera camera;
    camera.orthographic = orthographic;
    if (orthographic) camera.scale = 80.0;
    camera.view_from_world = RandomRotation(5);
    TrueCamera wrong = camera;
    wrong.depth = [](double, double) { return 4.0; };
    refuse(wrong, {"in one plane"});
    if (!orthographic) {
      wrong.depth = [&](double u, double v) { return 4.0 / (1.0 + 0.2 * u / 400.0 - 0.4 * v / 400.0); };
      refuse(wrong, {"in one plane"});
    }
    wrong = camera;
    wrong.pixel_width = 1.1;
    refuse(wrong, {"pixels are not square", "1.1"});
    wrong = camera;
    wrong.view_from_world = glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1) * camera.view_from_world;
    refuse(wrong, {"mirrored"});
    wrong = camera;  // barrel distortion, 1 px at the corner
    wrong.jitter = [](int x, int y) {
      const glm::dvec2 p((x - 160) / 160.0, (y - 90) / 160.0);
      return glm::length(p) * glm::length(p) * p;
    };
    refuse(wrong, {"distorted"});
    wrong = camera;  // depth of field
    wrong.jitter = [](int x, int y) {
      return 12.0 * glm::dvec2(Uniform(1, x * 999 + y) - 0.5, Uniform(2, x * 999 + y) - 0.5);
    };
    refuse(wrong, {"depth of field"});
    wrong = camera;
    wrong.width = wrong.height = 7;
    refuse(wrong, {"pixels show anything", "64"});
  }
}

TEST(SolveCamera, RefusesDepthThatIsThePathsLength) {
  TrueCamera camera;
  camera.scale = 200.0;
  Render render(camera);
  for (std::size_t i = 0; i < render.depth.size(); ++i) {
    if (render.depth[i] < 1e9f) render.depth[i] = static_cast<float>(glm::length(render.At(i)));
  }
  ExpectRefusal(render.Solve(), {"not planar", "panoramic", "--camera FILE"});
  render = Render(camera);
  for (float& depth : render.depth) depth *= depth < 1e9f ? 2.0f : 1.0f;
  ExpectRefusal(render.Solve(), {"2.0000 m a metre"});
}

TEST(SolveCamera, SurvivesAnyNumbers) {
  constexpr float kOdd[] = {0.0f,
                            -1.0f,
                            1e30f,
                            -1e30f,
                            1e-30f,
                            std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN(),
                            3.0f,
                            1e8f};
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    TrueCamera camera;
    camera.width = 24, camera.height = 16;
    Render render(camera);
    for (std::size_t k = 0; k < render.depth.size(); ++k) {
      if (Hash(seed, k) % 3 == 0) render.depth[k] = kOdd[Hash(seed, k, 1) % 9];
      for (auto& plane : render.position) {
        if (Hash(seed, k, &plane - render.position, 2) % 3 == 0) plane[k] = kOdd[Hash(seed, k, 3) % 9];
      }
    }
    ExpectRefusal(render.Solve(), {"shot.exr"});
  }
}

}  // namespace
}  // namespace scumble
