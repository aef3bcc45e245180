// The ray caster on broken and empty scenes, on any number of threads, and its refusals. Scenes at the ends of every
// scale are extreme_geometry_test.cpp's, those far away extreme_place_test.cpp's, and agreement of Embree's instruction
// sets is instruction_sets_test.cpp's.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/image/check.h"
#include "core/image/hash.h"
#include "guidegen/guidegen.h"
#include "guidegen/light/direct_light.h"
#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"
#include "tests/support/numbers.h"

namespace scumble::testing {
namespace {

LayerSet Everything() { return {Layer::kPosition, Layer::kPref, Layer::kAlbedo, Layer::kLuminance, Layer::kShadow}; }

// Spheres that overlap each other exactly, walls in one plane, masks, mirrors, lights.
Scene CrowdedScene() {
  Scene scene = SceneOf(BallMesh(24));
  scene.materials.emplace_back();
  scene.materials[1].alpha_mode = AlphaMode::kMask;
  scene.materials[1].base_color_texture.texture = 0;
  Picture picture(16, 16);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) picture.rgba[i] = std::uint16_t(Hash(i));
  scene.textures.push_back(picture);
  Mesh wall = QuadMesh();
  wall.material = 1;
  scene.meshes.push_back(wall);
  for (int i = 0; i < 30; ++i) {
    const glm::dvec3 place(UnitFloat(Hash(i, 1)) * 4 - 2, UnitFloat(Hash(i, 2)) * 4 - 2, UnitFloat(Hash(i, 3)) * -2);
    scene.instances.push_back({"ball" + std::to_string(i / 2), 0, Moved(place.x, place.y, place.z)});
    scene.instances.push_back({"twin" + std::to_string(i / 2), 0, Moved(place.x, place.y, place.z)});
    scene.instances.push_back({"wall" + std::to_string(i), 1, Moved(place.x, place.y, 0.5)});
  }
  scene.lights = {PointLight({2, 3, 4}, 5.0), PointLight({-4, 3, 4}, 2.0)};
  return scene;
}

TEST(Determinism, ThreadsDoNotChangeAByte) {
  const Scene scene = CrowdedScene();
  const Camera camera = LookingAt({1, 1, 7}, {0, 0, 0}, 50.0);
  GuidegenOptions options = Sized(150, 101, Everything());
  options.aa = 3;
  for (const char* isa : {"", "sse2"}) {
    options.isa = isa;
    options.threads = 1;
    const auto one = Render(scene, camera, options);
    for (const int threads : {2, 16, 0}) {
      options.threads = threads;
      const auto many = Render(scene, camera, options);
      EXPECT_TRUE(SameBytes(one.guides, many.guides)) << threads << " threads, isa " << isa;
      EXPECT_EQ(one.rays.shadow, many.rays.shadow);
      EXPECT_EQ(one.rays.coverage, many.rays.coverage);
    }
  }
}

TEST(Determinism, LargeMeshesBuildTheSameTree) {
  // Above some ten thousand triangles Embree builds in parallel; doubled geometry makes every hit a tie.
  Scene scene = SceneOf(BallMesh(200));
  // One rounding larger than the first, in double: no exact copy, but equal for Embree.
  scene.instances.push_back({"twin", 0, glm::scale(glm::dmat4(1.0), glm::dvec3(1.0 + 0x1p-52))});
  GuidegenOptions options = Sized(200, 200);
  options.threads = 1;
  const auto one = Render(scene, FrontCamera(3.5), options);
  options.threads = 16;
  for (int repeat = 0; repeat < 3; ++repeat) {
    EXPECT_TRUE(SameBytes(one.guides, Render(scene, FrontCamera(3.5), options).guides));
  }
}

TEST(Isa, EveryOneThisMachineHasWorksAndIsRecorded) {
  const Scene scene = SceneOf(CubeMesh());
  GuidegenOptions options = Sized(40, 30, {Layer::kPosition});
  const Camera camera = LookingAt({2, 3, 5}, {0, 0, 0});
  const auto best = Render(scene, camera, options);
  EXPECT_TRUE(best.guides.attributes.count("scumble:isa"));
  int works = 0;
  for (const char* isa : {"sse2", "sse4.2", "avx", "avx2", "avx512"}) {
    options.isa = isa;
    const auto result = RenderGuides(scene, camera, options);
    if (!result) {
      EXPECT_EQ(result.error().kind, ErrorKind::kUsage);
      continue;
    }
    ++works;
    EXPECT_EQ(result->guides.attributes.at("scumble:isa"), isa);
    if (best.guides.attributes.at("scumble:isa") == isa) {
      EXPECT_TRUE(SameBytes(best.guides, result->guides));
    }
  }
  EXPECT_GE(works, 1);
  options.isa = "mmx";
  const auto result = RenderGuides(scene, camera, options);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::kUsage);
  EXPECT_NE(result.error().message.find("avx2"), std::string::npos);
}

TEST(Robustness, NothingToSeeIsAnEmptyPicture) {
  ExpectEmpty(Render(Scene{}, FrontCamera(3.0), Sized(17, 5, Everything())).guides);
  Scene hollow = SceneOf(Mesh{});
  ExpectEmpty(Render(hollow, FrontCamera(3.0), Sized(8, 8, Everything())).guides);
  ExpectEmpty(Render(SceneOf(CubeMesh()), FrontCamera(-3.0), Sized(8, 8, Everything())).guides);
}

TEST(Robustness, CameraInsideAMeshSeesItsInside) {
  const auto result = Render(SceneOf(CubeMesh()), FrontCamera(0.0, 60.0), Sized(9, 9, {Layer::kPosition}));
  for (std::size_t i = 0; i < 81; ++i) {
    EXPECT_EQ(result.guides.Plane(Layer::kDepth)[i], 1.0f);
    EXPECT_EQ(result.guides.Vec3(Layer::kNormal, i), glm::vec3(0, 0, 1));
  }
}

TEST(Robustness, CameraOnASurfaceGivesFiniteGuides) {
  const auto result = Render(SceneOf(QuadMesh()), FrontCamera(0.0), Sized(9, 9, {Layer::kPosition}));
  for (const float depth : result.guides.Plane(Layer::kDepth)) EXPECT_FALSE(std::isnan(depth));
}

TEST(Robustness, SmallestPictures) {
  const Scene scene = SceneOf(CubeMesh());
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 37}, {37, 1}}) {
    GuidegenOptions options = Sized(width, height, Everything());
    options.aa = 2;
    const auto result = Render(scene, FlatCamera(3.0, height > 1 ? 2.0 : 0.5), options);
    const std::size_t middle = result.guides.Index(width / 2, height / 2);
    EXPECT_EQ(result.guides.Plane(Layer::kDepth)[middle], 2.0f) << width << "x" << height;
  }
}

TEST(Robustness, DegenerateTrianglesAreHarmless) {
  Scene scene = SceneOf(QuadMesh());
  Mesh& mesh = scene.meshes[0];
  mesh.triangles.push_back({0, 0, 0});
  mesh.triangles.push_back({0, 1, 1});
  mesh.positions.push_back({0, 0, 1});  // with two corners below it, a line that the middle rays run along
  mesh.positions.push_back({0, 0, 2});
  mesh.positions.push_back({kNan, 0, 1});
  mesh.positions.push_back({std::numeric_limits<float>::infinity(), 0, 1});
  mesh.positions.push_back({0, 3e38f, 1});
  for (auto* attribute : {&mesh.normals}) attribute->resize(mesh.positions.size(), {0, 0, 1});
  mesh.uvs[0].resize(mesh.positions.size());
  for (unsigned bad = 5; bad < 9; ++bad) mesh.triangles.push_back({4, 0, bad});
  const auto result = Render(scene, FlatCamera(3.0, 1.0), Sized(9, 9, Everything()));
  EXPECT_EQ(result.guides.Plane(Layer::kDepth)[result.guides.Index(8, 8)], 3.0f);
}

TEST(Robustness, SpoiltNormalsGiveWayToTheGeometricOne) {
  for (const glm::vec3 spoilt : {glm::vec3(kNan), glm::vec3(0.0f), glm::vec3(kNan, 0, 1)}) {
    Scene scene = SceneOf(QuadMesh());
    scene.meshes[0].normals.assign(4, spoilt);
    scene.lights = {PointLight({0, 0, 5}, 1.0)};
    const auto result = Render(scene, FlatCamera(3.0, 0.5), Sized(4, 4, Everything()));
    for (std::size_t i = 0; i < 16; ++i) {
      EXPECT_EQ(result.guides.Vec3(Layer::kNormal, i), glm::vec3(0, 0, 1));
      EXPECT_GT(result.guides.Plane(Layer::kLuminance)[i], 0.0f);
    }
  }
  Scene opposed = SceneOf(QuadMesh());
  opposed.meshes[0].normals = {{1, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {-1, 0, 0}};
  Render(opposed, FlatCamera(3.0, 1.0), Sized(64, 64));
  Scene bare = SceneOf(QuadMesh());
  bare.meshes[0].normals.clear();
  EXPECT_EQ(Render(bare, FlatCamera(3.0, 0.5), Sized(1, 1)).guides.Vec3(Layer::kNormal, 0), glm::vec3(0, 0, 1));
}

TEST(Robustness, SpoiltTextureCoordinatesReadTheFirstTexel) {
  Scene scene = SceneOf(QuadMesh());
  scene.meshes[0].uvs[0] = {{kNan, kNan}, {1e30f, -1e30f}, {1e38f, 0}, {-1e9f, 7.3f}};
  scene.textures.emplace_back(3, 2);
  scene.materials[0].base_color_texture.texture = 0;
  scene.materials[0].normal_texture.texture = 0;
  for (const TextureWrap wrap : {TextureWrap::kRepeat, TextureWrap::kMirror, TextureWrap::kClamp}) {
    scene.materials[0].base_color_texture.wrap_u = scene.materials[0].base_color_texture.wrap_v = wrap;
    const auto result = Render(scene, FlatCamera(3.0, 1.0), Sized(16, 16, {Layer::kAlbedo}));
    for (const float value : result.guides.Plane(Layer::kAlbedo)) EXPECT_EQ(value, 0.0f);
  }
}

TEST(Robustness, FlattenedInstancesKeepANormal) {
  const glm::dmat4 flat = glm::scale(glm::dmat4(1.0), glm::dvec3(1.0, 1.0, 0.0));
  const auto result = Render(SceneOf(BallMesh(16), flat), FlatCamera(3.0, 1.0), Sized(15, 15));
  EXPECT_EQ(result.guides.Plane(Layer::kDepth)[112], 3.0f);
  EXPECT_EQ(glm::abs(result.guides.Vec3(Layer::kNormal, 112)), glm::vec3(0, 0, 1));
  const glm::dmat4 point = glm::scale(glm::dmat4(1.0), glm::dvec3(0.0));
  ExpectEmpty(Render(SceneOf(BallMesh(16), point), FlatCamera(3.0, 1.0), Sized(4, 4)).guides);
}

TEST(Refusal, OptionsThatMakeNoSense) {
  const Scene scene = SceneOf(CubeMesh());
  const auto refuse = [&](const GuidegenOptions& options, ErrorKind kind, const std::string& word) {
    const auto result = RenderGuides(scene, FrontCamera(3.0), options);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, kind);
    EXPECT_NE(result.error().message.find(word), std::string::npos) << result.error().message;
  };
  refuse(Sized(0, 5), ErrorKind::kUsage, "0x5");
  refuse(Sized(5, kMaxImageSide + 1), ErrorKind::kUsage, "32768");
  for (const int aa : {0, 17, -1}) {
    GuidegenOptions options = Sized(5, 5);
    options.aa = aa;
    refuse(options, ErrorKind::kUsage, "aa " + std::to_string(aa));
  }
  GuidegenOptions options = Sized(5, 5);
  options.threads = -1;
  refuse(options, ErrorKind::kUsage, "threads");
  refuse(Sized(5, 5, {Layer::kMotion}), ErrorKind::kUnavailable, "motion");
}

TEST(Refusal, CamerasThatSeeNothingByTheirNumbers) {
  const auto refuse = [](const Camera& camera) {
    const auto result = RenderGuides(SceneOf(CubeMesh()), camera, Sized(4, 4));
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, ErrorKind::kInput);
    EXPECT_NE(result.error().message.find("front"), std::string::npos) << result.error().message;
  };
  for (const double angle : {0.0, -5.0, 180.0, double(kNan)}) refuse(FrontCamera(3.0, angle));
  for (const double ymag : {0.0, -1.0, double(kNan)}) refuse(FlatCamera(3.0, ymag));
  Camera camera = FrontCamera(3.0);
  camera.z_near = 5.0;
  camera.z_far = 4.0;
  refuse(camera);
  camera = FrontCamera(3.0);
  camera.aspect = 0.0;
  refuse(camera);
  camera = FrontCamera(3.0);
  camera.world_from_camera = glm::dmat4(0.0);
  refuse(camera);
  camera.world_from_camera = glm::dmat4(kNan);
  refuse(camera);
}

TEST(Robustness, LightTooBrightForFloatsIsTheLargestFloat) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  const auto brightest = [](const std::vector<Light>& lights) {
    Scene scene = SceneOf(QuadMesh());
    scene.lights = lights;
    const auto result = Render(scene, FlatCamera(3.0, 0.5), Sized(4, 4, {Layer::kLuminance, Layer::kShadow}));
    for (const float shadow : result.guides.Plane(Layer::kShadow)) EXPECT_EQ(shadow, 0.0f);
    const auto plane = result.guides.Plane(Layer::kLuminance);
    for (const float luminance : plane) EXPECT_TRUE(std::isfinite(luminance) && luminance >= 0.0f) << luminance;
    return *std::max_element(plane.begin(), plane.end());
  };
  EXPECT_EQ(brightest({PointLight({0, 0, 2}, 1e40)}), kLargest);
  EXPECT_EQ(brightest({PointLight({0, 0, 2}, 1e308)}), kLargest);
  EXPECT_EQ(brightest({PointLight({0, 0, 2}, 2.5e39), PointLight({0, 0, 2}, 2.5e39), PointLight({0, 0, 2}, 2.5e39)}),
            kLargest);
  EXPECT_EQ(brightest({PointLight({0.125, 0.125, 1e-160}, 1.0)}), 0.0f);
  Light sun = PointLight({0, 0, 2}, 1e300);
  sun.type = LightType::kSun;
  EXPECT_EQ(brightest({sun, sun}), kLargest);
  Light spot = PointLight({0, 0, 1e-3}, 1e308);
  spot.type = LightType::kSpot;
  EXPECT_EQ(brightest({spot}), 0.0f);  // its cone misses the centres of all pixels
}

TEST(DirectLight, NeverNaNAtTheLampItself) {
  SurfacePoint point;
  point.normal = point.facing = {0, 0, 1};
  PlacedLight lamp;
  lamp.position = {0, 0, 1e-170};
  for (const double intensity : {0.0, 1e-320, 1.0, 1e308}) {
    lamp.intensity = intensity;
    for (const LightType type : {LightType::kPoint, LightType::kSpot}) {
      lamp.type = type;
      lamp.cone_offset = type == LightType::kSpot ? -1.0 : 1.0;
      EXPECT_TRUE(std::isfinite(float(SampleLight(lamp, point).luminance))) << intensity;
    }
  }
}

TEST(Refusal, LightsThatAreNotNumbersMatterOnlyWhereLightIsAskedFor) {
  Scene scene = SceneOf(CubeMesh());
  scene.lights = {PointLight({0, 0, 3}, double(kNan))};
  Render(scene, FrontCamera(3.0), Sized(4, 4));
  const auto result = RenderGuides(scene, FrontCamera(3.0), Sized(4, 4, {Layer::kShadow}));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::kInput);
  EXPECT_NE(result.error().message.find("lamp"), std::string::npos);
  scene.lights = {PointLight({0, 0, 3}, 1.0)};
  scene.lights[0].type = LightType::kSun;
  scene.lights[0].world_from_light = glm::dmat4(0.0);
  EXPECT_FALSE(RenderGuides(scene, FrontCamera(3.0), Sized(4, 4, {Layer::kLuminance})));
}

TEST(Refusal, BrokenPromisesOfALoaderAreOurFault) {
  Scene scene = SceneOf(QuadMesh());
  scene.meshes[0].triangles[0].x = 4;
  EXPECT_THROW((void)RenderGuides(scene, FrontCamera(3.0), Sized(4, 4)), InternalError);
  scene = SceneOf(QuadMesh());
  scene.meshes[0].normals.pop_back();
  EXPECT_THROW((void)RenderGuides(scene, FrontCamera(3.0), Sized(4, 4)), InternalError);
  scene = SceneOf(QuadMesh());
  scene.meshes[0].material = 1;
  EXPECT_THROW((void)RenderGuides(scene, FrontCamera(3.0), Sized(4, 4)), InternalError);
}

TEST(ProgressReport, RisesFromZeroToOneAndIsNeverEnteredTwice) {
  std::vector<double> shares;
  std::atomic<int> inside{0};
  bool twice = false;
  GuidegenOptions options = Sized(400, 300);
  options.threads = 8;
  options.progress = [&](double share) {
    twice |= inside.fetch_add(1) != 0;
    shares.push_back(share);
    inside.fetch_sub(1);
    return true;
  };
  Render(SceneOf(CubeMesh()), FrontCamera(3.0), options);
  EXPECT_FALSE(twice);
  ASSERT_GE(shares.size(), 3u);
  EXPECT_EQ(shares.front(), 0.0);
  EXPECT_EQ(shares.back(), 1.0);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
}

TEST(ProgressReport, StopsWhenAsked) {
  for (const double until : {0.0, 0.1, 1.0}) {
    GuidegenOptions options = Sized(400, 300);
    options.progress = [&](double share) { return share < until; };
    const auto result = RenderGuides(SceneOf(CubeMesh()), FrontCamera(3.0), options);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, ErrorKind::kCancelled);
  }
}

TEST(Plan, ListsLayersWithReasonAndCost) {
  Scene scene = SceneOf(QuadMesh());
  GuidegenOptions options = Sized(4, 4);
  const auto plain = PlanGuides(scene, options);
  ASSERT_EQ(plain.size(), 5u);
  EXPECT_EQ(plain[0].layer, "A");
  EXPECT_EQ(plain[1].layer, "normal");
  for (const PlanItem& item : plain) EXPECT_EQ(item.reason, "always written");

  scene.lights.resize(2);
  scene.materials[0].alpha_mode = AlphaMode::kMask;
  options.layers = {Layer::kLuminance, Layer::kAlbedo};
  options.aa = 4;
  const auto full = PlanGuides(scene, options);
  ASSERT_EQ(full.size(), 9u);
  EXPECT_EQ(full[0].cost, "16 coverage rays per pixel");
  EXPECT_EQ(full[5].layer, "albedo");
  EXPECT_EQ(full[5].reason, "asked for");
  EXPECT_EQ(full[7].layer, "shadow rays");
  EXPECT_EQ(full[7].cost.substr(0, 13), "2 shadow rays");
  EXPECT_EQ(full[8].layer, "alpha test");
  scene.lights.clear();
  EXPECT_EQ(PlanGuides(scene, options)[6].cost.substr(0, 4), "none");
}

}  // namespace
}  // namespace scumble::testing
