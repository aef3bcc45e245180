// The ray caster against closed formulas.
#include "guidegen/guidegen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"
#include "tests/support/numbers.h"

namespace scumble::testing {
namespace {

double CoveredArea(const GuideSet& guides) {
  double sum = 0.0;
  for (const float a : guides.Plane(Layer::kCoverage)) sum += a;
  return sum;
}

void ExpectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  EXPECT_LE(glm::length(a - b), tolerance)
      << a.x << " " << a.y << " " << a.z << " against " << b.x << " " << b.y << " " << b.z;
}

// --- Geometry ---------------------------------------------------------------------------------------------------

TEST(Guides, TiltedPlaneHasTheDepthOfTheFormula) {
  const double tilt = glm::radians(50.0);
  const glm::dmat4 placed = glm::scale(glm::rotate(Moved(0.3, -0.2, 0.0), tilt, glm::dvec3(0, 1, 0)), glm::dvec3(20.0));
  const int width = 67;
  const int height = 41;
  const Camera camera = FrontCamera(5.0, 55.0);
  const auto result = Render(SceneOf(QuadMesh(), placed), camera, Sized(width, height, {Layer::kPosition}));
  const GuideSet& guides = result.guides;
  const glm::dvec3 normal(std::sin(tilt), 0.0, std::cos(tilt));
  const double half = std::tan(glm::radians(55.0) / 2.0);
  int covered = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = guides.Index(x, y);
      if (guides.Plane(Layer::kCoverage)[i] == 0.0f) continue;
      ++covered;
      const glm::dvec3 ray(((x + 0.5) / width * 2.0 - 1.0) * half * width / height,
                           (1.0 - (y + 0.5) / height * 2.0) * half, -1.0);
      const double depth = glm::dot(normal, glm::dvec3(0.3, -0.2, -5.0)) / glm::dot(normal, ray);
      EXPECT_NEAR(guides.Plane(Layer::kDepth)[i], depth, 1e-6 * depth);
      const glm::dvec3 position = glm::dvec3(0, 0, 5) + ray * depth;
      ExpectNear(guides.Vec3(Layer::kPosition, i), position, 1e-6 * (glm::length(position) + 1.0));
      ExpectNear(guides.Vec3(Layer::kNormal, i), normal, 1e-6);
    }
  }
  EXPECT_GT(covered, width * height / 2);
}

TEST(Guides, NearPartOfAHugePlaneIsExact) {
  // One metre in front of the eye, corners 100 km away: floats there are 8 mm apart.
  const glm::dmat4 placed = glm::scale(glm::rotate(Moved(0, -1, 0), -kPi / 2.0, glm::dvec3(1, 0, 0)), glm::dvec3(1e5));
  Scene scene = SceneOf(QuadMesh(), placed);
  scene.lights.push_back(PointLight({0, 2, 0}, 1.0));
  const auto result =
      Render(scene, LookingAt({0, 0, 0}, {0, -1, -1}), Sized(32, 32, {Layer::kPosition, Layer::kShadow}));
  for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
    ASSERT_EQ(result.guides.Plane(Layer::kCoverage)[i], 1.0f);
    EXPECT_NEAR(result.guides.Plane(Layer::kPosition, 1)[i], -1.0, 1e-6);
    EXPECT_EQ(result.guides.Plane(Layer::kShadow)[i], 0.0f);
  }
}

TEST(Guides, BallCoversItsDisc) {
  const auto result = Render(SceneOf(BallMesh(256)), FlatCamera(4.0, 1.25), Sized(200, 200));
  const double pixels_per_metre = 80.0;
  EXPECT_NEAR(CoveredArea(result.guides), kPi * pixels_per_metre * pixels_per_metre, 60.0);
  GuidegenOptions aa = Sized(200, 200);
  aa.aa = 4;
  EXPECT_NEAR(CoveredArea(Render(SceneOf(BallMesh(256)), FlatCamera(4.0, 1.25), aa).guides),
              kPi * pixels_per_metre * pixels_per_metre, 15.0);
}

TEST(Guides, NormalsFollowTheInverseTranspose) {
  // An ellipsoid: its normal is the gradient of (x/a)² + (y/b)² + (z/c)².
  const glm::dvec3 radii(1.5, 0.4, -0.8);
  const Camera camera = LookingAt({2, 1.5, 4}, {0, 0, 0});
  const Scene scene = SceneOf(BallMesh(400), glm::scale(glm::dmat4(1.0), radii));
  const auto result = Render(scene, camera, Sized(90, 60, {Layer::kPosition}));
  const glm::dmat3 view_from_world(result.guides.camera->view_from_world);
  int covered = 0;
  for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
    if (result.guides.Plane(Layer::kCoverage)[i] == 0.0f) continue;
    ++covered;
    const glm::dvec3 position = result.guides.Vec3(Layer::kPosition, i);
    const glm::dvec3 expected = view_from_world * glm::normalize(position / (radii * radii));
    // At the silhouette a facet's back may be what the eye meets; elsewhere facets are 0.4° wide.
    if (expected.z < 0.15) continue;
    ExpectNear(result.guides.Vec3(Layer::kNormal, i), expected, 0.01);
  }
  EXPECT_GT(covered, 500);
}

TEST(Guides, BackFacesAreFlippedOrCulled) {
  Scene scene = SceneOf(QuadMesh(), glm::rotate(glm::dmat4(1.0), kPi, glm::dvec3(0, 1, 0)));
  const Camera camera = FlatCamera(3.0, 0.5);
  const auto both = Render(scene, camera, Sized(4, 4));
  for (std::size_t i = 0; i < 16; ++i) ExpectNear(both.guides.Vec3(Layer::kNormal, i), {0, 0, 1}, 1e-6);
  scene.materials[0].double_sided = false;
  ExpectEmpty(Render(scene, camera, Sized(4, 4)).guides);
  // A mirrored instance shows what was its back as its front.
  scene.instances[0].world_from_object = glm::scale(scene.instances[0].world_from_object, glm::dvec3(1.0, 1.0, -1.0));
  const auto mirrored = Render(scene, camera, Sized(4, 4));
  for (std::size_t i = 0; i < 16; ++i) ExpectNear(mirrored.guides.Vec3(Layer::kNormal, i), {0, 0, 1}, 1e-6);
}

TEST(Guides, CulledWallsShowWhatIsBehindThem) {
  Scene scene = SceneOf(QuadMesh(), glm::rotate(glm::dmat4(1.0), kPi, glm::dvec3(0, 1, 0)));
  scene.materials[0].double_sided = false;
  scene.materials.emplace_back().name = "back";
  Mesh behind = QuadMesh();
  behind.material = 1;
  AddObject(scene, "behind", behind, Moved(0, 0, -1));
  const auto result = Render(scene, FlatCamera(3.0, 0.5), Sized(3, 3));
  EXPECT_EQ(result.guides.Plane(Layer::kDepth)[4], 4.0f);
  EXPECT_EQ(result.guides.object_names.at(unsigned(result.guides.Plane(Layer::kObject)[4])), "behind");
  EXPECT_EQ(result.guides.material_names.at(unsigned(result.guides.Plane(Layer::kMaterial)[4])), "back");
}

TEST(Guides, AlphaMasksCutHoles) {
  Scene scene = SceneOf(QuadMesh());
  Picture picture(2, 1);
  for (int i = 0; i < 8; ++i) picture.rgba[i] = 65535;
  picture.At(0, 0)[3] = 0;
  scene.textures.push_back(picture);
  scene.materials[0].base_color_texture.texture = 0;
  scene.materials[0].base_color_texture.nearest = true;
  for (const AlphaMode mode : {AlphaMode::kMask, AlphaMode::kBlend, AlphaMode::kOpaque}) {
    scene.materials[0].alpha_mode = mode;
    GuidegenOptions options = Sized(8, 8);
    options.aa = 3;
    const auto result = Render(scene, FlatCamera(3.0, 1.0), options);
    for (int x = 0; x < 8; ++x) {
      EXPECT_EQ(result.guides.Plane(Layer::kCoverage)[result.guides.Index(x, 3)],
                x < 4 && mode != AlphaMode::kOpaque ? 0.0f : 1.0f);
    }
  }
}

TEST(Guides, AlbedoIsBaseTimesTextureTimesVertexColour) {
  Scene scene = SceneOf(QuadMesh());
  Picture picture(2, 2);
  std::fill(picture.rgba.begin(), picture.rgba.end(), std::uint16_t(65535));
  std::fill(picture.At(1, 0), picture.At(1, 0) + 3, std::uint16_t(48188));  // linear 0.4999
  scene.textures.push_back(picture);
  scene.materials[0].base_color = {0.5f, 0.25f, 1.0f, 1.0f};
  scene.materials[0].base_color_texture.texture = 0;
  scene.materials[0].base_color_texture.nearest = true;
  scene.meshes[0].colors.assign(4, {1.0f, 0.5f, 0.25f, 1.0f});
  const auto result = Render(scene, FlatCamera(3.0, 1.0), Sized(4, 4, {Layer::kAlbedo, Layer::kPref}));
  ExpectNear(result.guides.Vec3(Layer::kAlbedo, result.guides.Index(0, 0)), {0.5, 0.125, 0.25}, 1e-6);
  ExpectNear(result.guides.Vec3(Layer::kAlbedo, result.guides.Index(3, 0)), {0.25, 0.0625, 0.125}, 1e-4);
  ExpectNear(result.guides.Vec3(Layer::kAlbedo, result.guides.Index(3, 3)), {0.5, 0.125, 0.25}, 1e-6);
  ExpectNear(result.guides.Vec3(Layer::kPref, result.guides.Index(3, 0)), {0.75, 0.75, 0.0}, 1e-6);
}

TEST(Guides, NormalMapsBendTheNormal) {
  Scene scene = SceneOf(QuadMesh());
  Picture picture(1, 1);
  const glm::dvec3 stored = glm::normalize(glm::dvec3(1, 2, 2));
  for (int i = 0; i < 3; ++i) picture.rgba[i] = std::uint16_t(std::lround((stored[i] * 0.5 + 0.5) * 65535.0));
  scene.textures.push_back(picture);
  scene.materials[0].normal_texture.texture = 0;
  scene.meshes[0].tangents.assign(4, {1, 0, 0, 1});
  GuidegenOptions options = Sized(2, 2);
  options.raw_normals = true;
  const auto result = Render(scene, FlatCamera(3.0, 0.5), options);
  ExpectNear(result.guides.Vec3(Layer::kNormal, 0), stored, 1e-4);
  // Its mirrored ray would go 6° below the surface.
  const glm::dvec3 bent = Render(scene, FlatCamera(3.0, 0.5), Sized(2, 2)).guides.Vec3(Layer::kNormal, 0);
  EXPECT_NEAR(2.0 * bent.z * bent.z - 1.0, 0.01, 1e-6);
  EXPECT_NEAR(bent.y / bent.x, stored.y / stored.x, 1e-4) << "it is turned straight towards the surface's own normal";
}

TEST(Guides, EyeFrameSeesASphereTheSameEverywhere) {
  // A small sphere far off the axis looks at the viewer in its middle.
  const Scene scene = SceneOf(BallMesh(128), glm::scale(Moved(3, 2, 0), glm::dvec3(0.5)));
  GuidegenOptions options = Sized(301, 201);
  options.normal_frame = NormalFrame::kEye;
  const auto result = Render(scene, FrontCamera(4.0, 80.0), options);
  const double half = std::tan(glm::radians(40.0));
  const int x = int((3.0 / 4.0 / half / (301.0 / 201.0) * 0.5 + 0.5) * 301);
  const int y = int((0.5 - 2.0 / 4.0 / half * 0.5) * 201);
  ExpectNear(result.guides.Vec3(Layer::kNormal, result.guides.Index(x, y)), {0, 0, 1}, 0.08);
  options.normal_frame = NormalFrame::kCamera;
  const auto plain = Render(scene, FrontCamera(4.0, 80.0), options);
  EXPECT_LT(plain.guides.Vec3(Layer::kNormal, plain.guides.Index(x, y)).z, 0.8f);
}

TEST(Guides, EyeFrameIsTheSmallestRotation) {
  // The one that takes the eye's direction e to +Z takes +Z, this plane's normal, to e mirrored about +Z.
  const Scene scene = SceneOf(QuadMesh(), glm::scale(glm::dmat4(1.0), glm::dvec3(100.0)));
  GuidegenOptions options = Sized(20, 10, {Layer::kPosition});
  options.normal_frame = NormalFrame::kEye;
  const auto result = Render(scene, FrontCamera(4.0, 100.0), options);
  for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
    const glm::dvec3 position = result.guides.Vec3(Layer::kPosition, i);
    const glm::dvec3 to_eye = glm::normalize(glm::dvec3(0, 0, 4) - position);
    ExpectNear(result.guides.Vec3(Layer::kNormal, i), {-to_eye.x, -to_eye.y, to_eye.z}, 1e-6);
  }
  EXPECT_EQ(result.guides.attributes.at("scumble:normal_frame"), "eye");
}

TEST(Guides, AspectOfTheFileKeepsTheWiderExtent) {
  Camera camera = FlatCamera(3.0, 1.0);
  const Scene scene = SceneOf(QuadMesh());
  const auto covered_in_row = [&](int width, int height) {
    const auto result = Render(scene, camera, Sized(width, height));
    const auto row = result.guides.Plane(Layer::kCoverage).subspan(std::size_t(height / 2) * width, width);
    return std::count(row.begin(), row.end(), 1.0f);
  };
  EXPECT_EQ(covered_in_row(40, 20), 20);  // the vertical extent fills 20 pixels
  camera.aspect = 1.0;
  EXPECT_EQ(covered_in_row(40, 20), 20);  // a narrower aspect changes nothing
  camera.aspect = 4.0;
  EXPECT_EQ(covered_in_row(40, 20), 10);  // ± 4 m across 40 pixels
}

TEST(Guides, ClipMatrixProjectsPositionsToTheirPixels) {
  for (const bool orthographic : {false, true}) {
    Camera camera = LookingAt({3, 2, 5}, {0, 0, 0});
    camera.orthographic = orthographic;
    camera.ymag = 2.0;
    const auto result = Render(SceneOf(CubeMesh()), camera, Sized(64, 48, {Layer::kPosition}));
    const GuideSet& guides = result.guides;
    const glm::dmat4 clip_from_world = guides.camera->clip_from_view * guides.camera->view_from_world;
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        if (guides.Plane(Layer::kCoverage)[guides.Index(x, y)] == 0.0f) continue;
        const glm::dvec3 position = guides.Vec3(Layer::kPosition, guides.Index(x, y));
        const glm::dvec4 clip = clip_from_world * glm::dvec4(position, 1.0);
        EXPECT_NEAR((clip.x / clip.w * 0.5 + 0.5) * 64, x + 0.5, 1e-3);
        EXPECT_NEAR((0.5 - clip.y / clip.w * 0.5) * 48, y + 0.5, 1e-3);
        const glm::dvec4 view = guides.camera->view_from_world * glm::dvec4(position, 1.0);
        EXPECT_NEAR(-view.z, guides.Plane(Layer::kDepth)[guides.Index(x, y)], 1e-5);
      }
    }
    EXPECT_GT(CoveredArea(guides), 300.0);
  }
}

TEST(Guides, NearAndFarPlanesClip) {
  Scene scene = SceneOf(QuadMesh());
  AddObject(scene, "behind", QuadMesh(), Moved(0, 0, -2));
  Camera camera = FrontCamera(3.0, 20.0);
  camera.z_near = 3.5;
  EXPECT_EQ(Render(scene, camera, Sized(5, 5)).guides.Plane(Layer::kDepth)[12], 5.0f);
  camera.z_far = 4.5;
  ExpectEmpty(Render(scene, camera, Sized(5, 5)).guides);
  camera.z_near = 0.0;
  const auto result = Render(scene, camera, Sized(5, 5));
  for (std::size_t i = 0; i < 25; ++i) EXPECT_EQ(result.guides.Plane(Layer::kDepth)[i], 3.0f);
}

TEST(Guides, InstancesKeepTheirNamesAndIds) {
  Scene scene = SceneOf(QuadMesh(), Moved(-1, 0, 0));
  scene.materials[0].name.clear();
  scene.instances.push_back({"other", 0, Moved(1, 0, 0)});
  const auto result = Render(scene, FlatCamera(3.0, 1.0), Sized(4, 2));
  const std::vector<std::string> names = {"thing", "other"};
  const auto ids = IdsForNames(names);
  EXPECT_EQ(result.guides.Plane(Layer::kObject)[0], float(ids[0]));
  EXPECT_EQ(result.guides.Plane(Layer::kObject)[3], float(ids[1]));
  EXPECT_EQ(result.guides.object_names.at(ids[1]), "other");
  EXPECT_EQ(result.guides.material_names.begin()->second, "material_0");
  EXPECT_EQ(result.guides.attributes.at("scumble:generator"), "guidegen " SCUMBLE_VERSION);
}

// --- Coverage ---------------------------------------------------------------------------------------------------

TEST(Coverage, ThinWiresBetweenPixelCentresAreKept) {
  // 0.1 pixels wide, a quarter pixel off the centres of column 4.
  const glm::dmat4 placed = glm::scale(Moved(0.375, 0, 0), glm::dvec3(0.05, 10.0, 1.0));
  const Scene scene = SceneOf(QuadMesh(), placed);
  const Camera camera = FlatCamera(3.0, 4.0);
  ExpectEmpty(Render(scene, camera, Sized(8, 8)).guides);
  GuidegenOptions options = Sized(8, 8, {Layer::kPosition});
  options.aa = 4;
  const auto result = Render(scene, camera, options);
  for (int y = 0; y < 8; ++y) {
    const std::size_t i = result.guides.Index(4, y);
    EXPECT_EQ(result.guides.Plane(Layer::kCoverage)[i], 0.25f);
    EXPECT_EQ(result.guides.Plane(Layer::kDepth)[i], 3.0f);
    // Of the subsamples at 0.375 across, the two at ± 1/8 down are equally near; the upper row wins.
    EXPECT_NEAR(result.guides.Plane(Layer::kPosition, 0)[i], 0.375, 1e-6);
    EXPECT_NEAR(result.guides.Plane(Layer::kPosition, 1)[i], 4.0 - y - 0.375, 1e-6);
    ExpectBackground(result.guides, result.guides.Index(3, y));
  }
  EXPECT_EQ(result.rays.primary, 64u);
  EXPECT_EQ(result.rays.coverage, 64u * 16u + 8u);
}

TEST(Coverage, AHitCentreIsNeverEmpty) {
  const Scene scene = SceneOf(QuadMesh(), glm::scale(Moved(0.5, 0, 0), glm::dvec3(0.02, 10.0, 1.0)));
  GuidegenOptions options = Sized(8, 8);
  options.aa = 2;
  const auto result = Render(scene, FlatCamera(3.0, 4.0), options);
  EXPECT_EQ(result.guides.Plane(Layer::kCoverage)[4], 0.25f);
  EXPECT_EQ(result.guides.Plane(Layer::kDepth)[4], 3.0f);
}

TEST(Coverage, IsTheShareOfCoveredSubsamples) {
  // The quad's edge stands at 0.6 pixels of column 4: 3 of 5 columns of subsamples, 2 of 4, 10 of 16.
  const Scene scene = SceneOf(QuadMesh(), glm::scale(Moved(-9.4, 0, 0), glm::dvec3(10.0)));
  for (const auto& [aa, share] : {std::pair{1, 1.0f}, {4, 0.5f}, {5, 0.6f}, {16, 0.625f}}) {
    GuidegenOptions options = Sized(8, 8);
    options.aa = aa;
    const auto result = Render(scene, FlatCamera(3.0, 4.0), options);
    EXPECT_FLOAT_EQ(result.guides.Plane(Layer::kCoverage)[4], share) << "aa " << aa;
    EXPECT_EQ(result.guides.Plane(Layer::kCoverage)[3], 1.0f);
    EXPECT_EQ(result.guides.Plane(Layer::kCoverage)[5], 0.0f);
  }
}

TEST(Coverage, InnerPixelsCostNothingAndAreTheSame) {
  // A mask without holes has the same coverage, but every subsample of it must be cast.
  Scene scene = SceneOf(CubeMesh());
  AddObject(scene, "ball", BallMesh(6), Moved(1.5, 0, 0.5));
  const Camera camera = LookingAt({2, 3, 5}, {0, 0, 0});
  GuidegenOptions options = Sized(150, 101);
  options.aa = 5;
  const auto opaque = Render(scene, camera, options);
  scene.materials[0].alpha_mode = AlphaMode::kMask;
  const auto masked = Render(scene, camera, options);
  for (std::size_t i = 0; i < opaque.guides.pixel_count(); ++i) {
    EXPECT_EQ(opaque.guides.Plane(Layer::kCoverage)[i], masked.guides.Plane(Layer::kCoverage)[i]);
  }
  EXPECT_LT(opaque.rays.coverage, masked.rays.coverage * 9 / 10);
}

TEST(Coverage, DataDoNotDependOnIt) {
  GuidegenOptions options = Sized(50, 40);
  const Camera camera = LookingAt({2, 3, 5}, {0, 0, 0});
  const auto plain = Render(SceneOf(CubeMesh()), camera, options);
  options.aa = 3;
  const auto smooth = Render(SceneOf(CubeMesh()), camera, options);
  for (std::size_t i = 0; i < plain.guides.pixel_count(); ++i) {
    if (plain.guides.Plane(Layer::kCoverage)[i] == 0.0f) continue;
    EXPECT_EQ(plain.guides.Plane(Layer::kDepth)[i], smooth.guides.Plane(Layer::kDepth)[i]);
    EXPECT_EQ(plain.guides.Vec3(Layer::kNormal, i), smooth.guides.Vec3(Layer::kNormal, i));
  }
}

// --- Light ------------------------------------------------------------------------------------------------------

TEST(Light, PointLightOnAPlaneFollowsTheFormula) {
  Scene scene = SceneOf(QuadMesh(), glm::scale(glm::dmat4(1.0), glm::dvec3(5.0)));
  const glm::dvec3 lamp(0.5, -0.25, 1.5);
  scene.lights.push_back(PointLight(lamp, 7.0));
  scene.lights[0].color = {0.2f, 0.9f, 0.4f};
  const double intensity = 7.0 * (0.2126 * 0.2 + 0.7152 * 0.9 + 0.0722 * 0.4);
  const auto result =
      Render(scene, FrontCamera(4.0), Sized(40, 30, {Layer::kLuminance, Layer::kShadow, Layer::kPosition}));
  for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
    const glm::dvec3 way = lamp - glm::dvec3(result.guides.Vec3(Layer::kPosition, i));
    const double d = glm::length(way);
    const double expected = intensity * (way.z / d) / (kPi * d * d);
    EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[i], expected, 1e-5 * expected);
    EXPECT_EQ(result.guides.Plane(Layer::kShadow)[i], 0.0f);
  }
}

TEST(Light, SunAndItsCosine) {
  Scene scene = SceneOf(QuadMesh());
  for (const double angle : {0.0, 30.0, 60.0, 89.0, 91.0}) {
    Light sun;
    sun.type = LightType::kSun;
    sun.intensity = kPi;
    sun.world_from_light = glm::rotate(glm::dmat4(1.0), glm::radians(angle), glm::dvec3(1, 0, 0));
    scene.lights = {sun};
    const auto result = Render(scene, FlatCamera(3.0, 0.5), Sized(2, 2, {Layer::kLuminance}));
    EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[0], std::max(0.0, std::cos(glm::radians(angle))), 1e-6);
  }
}

TEST(Light, SpotAttenuatesBetweenItsCones) {
  Scene scene = SceneOf(QuadMesh(), glm::scale(glm::dmat4(1.0), glm::dvec3(10.0)));
  Light spot = PointLight({0, 0, 2}, 3.0);
  spot.type = LightType::kSpot;
  spot.inner_cone_degrees = 20.0;
  spot.outer_cone_degrees = 40.0;
  scene.lights.push_back(spot);
  const auto result = Render(scene, FrontCamera(8.0), Sized(81, 81, {Layer::kLuminance, Layer::kPosition}));
  const double inner = std::cos(glm::radians(20.0));
  const double outer = std::cos(glm::radians(40.0));
  int inside = 0, between = 0, outside = 0;
  for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
    const glm::dvec3 way = glm::dvec3(0, 0, 2) - glm::dvec3(result.guides.Vec3(Layer::kPosition, i));
    const double d = glm::length(way);
    const double cosine = way.z / d;
    const double ramp = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
    const double expected = 3.0 * cosine / (kPi * d * d) * ramp * ramp;
    EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[i], expected, 1e-6);
    ++(ramp == 1.0 ? inside : ramp == 0.0 ? outside : between);
  }
  EXPECT_GT(inside, 20);
  EXPECT_GT(between, 20);
  EXPECT_GT(outside, 20);
}

TEST(Light, CubeThrowsItsShadowWhereGeometrySays) {
  // A sun at 45°: the cube's top edge at height 2 throws its shadow 2 m beyond its side at x = 1.
  Scene scene = SceneOf(CubeMesh(), Moved(0, 1, 0));
  AddObject(scene, "ground", QuadMesh(),
            glm::scale(glm::rotate(glm::dmat4(1.0), -kPi / 2.0, glm::dvec3(1, 0, 0)), glm::dvec3(50.0)));
  Light sun;
  sun.type = LightType::kSun;
  sun.intensity = kPi;
  sun.world_from_light = glm::inverse(glm::lookAt(glm::dvec3(-1, 1, 0), glm::dvec3(0), glm::dvec3(0, 0, 1)));
  scene.lights.push_back(sun);
  const Camera camera = LookingAt({3, 9, 6}, {1, 0, 0});
  const auto result = Render(scene, camera, Sized(160, 120, {Layer::kLuminance, Layer::kShadow, Layer::kPosition}));
  const auto& guides = result.guides;
  int lit = 0, dark = 0;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (guides.object_names.count(unsigned(guides.Plane(Layer::kObject)[i])) == 0) continue;
    if (guides.object_names.at(unsigned(guides.Plane(Layer::kObject)[i])) != "ground") continue;
    const glm::dvec3 p = guides.Vec3(Layer::kPosition, i);
    const bool shadowed = p.x > -1 && p.x < 3 && std::abs(p.z) < 1;
    const double to_edge = std::min(std::abs(p.x - 3), std::abs(std::abs(p.z) - 1));
    if (to_edge < 1e-3) continue;
    EXPECT_EQ(guides.Plane(Layer::kShadow)[i], shadowed ? 1.0f : 0.0f) << p.x << " " << p.z;
    EXPECT_NEAR(guides.Plane(Layer::kLuminance)[i], shadowed ? 0.0 : std::sqrt(0.5), 1e-6);
    ++(shadowed ? dark : lit);
  }
  EXPECT_GT(dark, 500);
  EXPECT_GT(lit, 2000);
}

TEST(Light, TwoLampsShareTheShadow) {
  Scene scene = SceneOf(QuadMesh(), glm::scale(glm::dmat4(1.0), glm::dvec3(5.0)));
  AddObject(scene, "screen", QuadMesh(), glm::scale(Moved(-1.5, 0, 1.5), glm::dvec3(0.5)));
  scene.lights = {PointLight({-3, 0, 3}, 1.0), PointLight({3, 0, 3}, 3.0)};
  // At the origin the screen hides the left light; both lights shine equally obliquely.
  const auto result = Render(scene, LookingAt({0, -6, 3}, {0, 0, 0}, 0.5), Sized(1, 1, {Layer::kShadow}));
  EXPECT_NEAR(result.guides.Plane(Layer::kShadow)[0], 0.25, 1e-6);
}

TEST(Light, LightBehindTheSurfaceDoesNotReachIt) {
  Scene scene = SceneOf(QuadMesh());
  for (glm::vec3& normal : scene.meshes[0].normals) normal = glm::normalize(glm::vec3(1.0f, 0.0f, 0.2f));
  scene.lights = {PointLight({3, 0, -0.5}, 1.0)};  // before the shading normal, behind the surface
  const auto result = Render(scene, FlatCamera(3.0, 0.5), Sized(2, 2, {Layer::kLuminance, Layer::kShadow}));
  EXPECT_EQ(result.guides.Plane(Layer::kLuminance)[0], 0.0f);
  EXPECT_EQ(result.guides.Plane(Layer::kShadow)[0], 0.0f);
  EXPECT_EQ(result.rays.shadow, 0u);
}

TEST(Light, AlphaMasksLetLightThrough) {
  Scene scene = SceneOf(QuadMesh());
  scene.materials.emplace_back();
  scene.materials[1].alpha_mode = AlphaMode::kMask;
  Mesh screen = QuadMesh();
  screen.material = 1;
  AddObject(scene, "screen", screen, Moved(0, 0, 1));
  scene.lights = {PointLight({0, 0, 2}, 1.0)};
  const Camera camera = LookingAt({0, 2, 0.5}, {0, 0, 0}, 5.0);
  EXPECT_EQ(Render(scene, camera, Sized(2, 2, {Layer::kShadow})).guides.Plane(Layer::kShadow)[0], 1.0f);
  scene.materials[1].base_color.a = 0.4f;
  EXPECT_EQ(Render(scene, camera, Sized(2, 2, {Layer::kShadow})).guides.Plane(Layer::kShadow)[0], 0.0f);
}

TEST(Light, SmoothBallsDoNotShadowThemselvesWhereTheyFaceTheLamp) {
  Scene scene = SceneOf(BallMesh(64), Moved(1000, 0, 0));
  scene.lights = {PointLight({1003, 4, 5}, 1.0)};
  const auto result = Render(scene, LookingAt({1000, 0, 6}, {1000, 0, 0}), Sized(80, 80, {Layer::kShadow}));
  for (const float shadow : result.guides.Plane(Layer::kShadow)) EXPECT_EQ(shadow, 0.0f);
}

TEST(Light, NothingIsPaidThatIsNotAskedFor) {
  Scene scene = SceneOf(QuadMesh(), glm::scale(glm::dmat4(1.0), glm::dvec3(9.0)));
  scene.lights = {PointLight({0, 0, 2}, 1.0), PointLight({1, 0, 2}, 1.0)};
  const auto plain = Render(scene, FrontCamera(3.0), Sized(10, 10, {Layer::kPosition, Layer::kAlbedo}));
  EXPECT_EQ(plain.rays.primary, 100u);
  EXPECT_EQ(plain.rays.coverage, 0u);
  EXPECT_EQ(plain.rays.shadow, 0u);
  EXPECT_FALSE(plain.guides.Has(Layer::kLuminance));
  EXPECT_EQ(Render(scene, FrontCamera(3.0), Sized(10, 10, {Layer::kShadow})).rays.shadow, 200u);
  scene.lights.clear();
  const auto dark = Render(scene, FrontCamera(3.0), Sized(10, 10, {Layer::kLuminance, Layer::kShadow}));
  EXPECT_EQ(dark.rays.shadow, 0u);
  for (const float value : dark.guides.Plane(Layer::kLuminance)) EXPECT_EQ(value, 0.0f);
}

}  // namespace
}  // namespace scumble::testing
