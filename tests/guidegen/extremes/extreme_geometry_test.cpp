// The ray caster on scenes at the ends of every scale, on triangles that are hardly any, and on surfaces in one place.
// What is expected follows from the formulas of exact_rays.h and from how floats round; nothing here was fitted.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "tests/support/exact_rays.h"
#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"
#include "tests/support/light_path_scenes.h"
#include "tests/support/numbers.h"

namespace scumble::testing {
namespace {

LayerSet Everything() { return {Layer::kPosition, Layer::kPref, Layer::kAlbedo, Layer::kLuminance, Layer::kShadow}; }

// A sphere mesh before a leaning wall, and a light that throws the one's shadow on the other.
Scene SmallScene(double scale) {
  const glm::dmat4 sized = glm::scale(glm::dmat4(1.0), glm::dvec3(scale));
  Scene scene = SceneOf(BallMesh(12), sized);
  AddObject(scene, "wall", QuadMesh(),
            sized * glm::scale(glm::rotate(Moved(0, 0, -1.5), 0.4, glm::dvec3(0, 1, 0)), glm::dvec3(3.0)));
  scene.lights = {PointLight(glm::dvec3(2, 3, 4) * scale, 5.0 * scale * scale)};
  return scene;
}

Camera SmallSceneCamera(double scale) { return LookingAt(glm::dvec3(1, 2, 6) * scale, {0, 0, 0}); }

// The same in light of every kind that has extent: a light whose radius is below a nanometre at 2^-20, an area light, a
// sun, a panel that shines, and a sky.
Scene SoftScene(double scale) {
  Scene scene = SmallScene(scale);
  scene.materials[0].roughness = 0.4f;
  scene.lights[0].radius = 0.001 * scale;
  Light area = PointLight({}, 2.0), sun = PointLight({}, 1.0);
  area.type = LightType::kArea, area.size_x = 1.5 * scale, area.size_y = 0.5 * scale;
  area.world_from_light = LookingAt(glm::dvec3(-3, 2, 2) * scale, {0, 0, 0}).world_from_camera;
  sun.type = LightType::kSun, sun.angle_degrees = 3.0;
  sun.world_from_light = LookingAt(glm::dvec3(1, 5, 2) * scale, {0, 0, 0}).world_from_camera;
  scene.lights.insert(scene.lights.end(), {area, sun});
  Material glow = Painted(Bsdf::kDiffuse, 0.2f);
  glow.emission = {3.0f, 2.0f, 1.0f};
  Mesh panel = QuadMesh();
  panel.material = AddMaterial(scene, glow);
  AddObject(scene, "panel", panel,
            glm::scale(glm::dmat4(1.0), glm::dvec3(scale)) *
                glm::scale(glm::rotate(Moved(2.2, 0, 1), -1.2, glm::dvec3(0, 1, 0)), glm::dvec3(0.7)));
  scene.world_radiance = glm::vec3(0.1f, 0.1f, 0.2f);
  return scene;
}

// --- Scale ----------------------------------------------------------------------------------------------

// A product with a power of two rounds nothing, and every sum and quotient of such products is the same one times a
// power of two. So not one bit of a guide may change but the exponents of depths and positions: a length in metres that
// somebody wrote into the code would show.
void ExpectNoBitChanges(Scene (*scene_at)(double scale), const GuidegenOptions& options) {
  const auto plain = Render(scene_at(1.0), SmallSceneCamera(1.0), options);
  for (const int power : {-20, -19, -10, -1, 1, 10, 19, 20}) {
    const double scale = std::ldexp(1.0, power);
    auto scaled = Render(scene_at(scale), SmallSceneCamera(scale), options);
    for (float& depth : scaled.guides.Plane(Layer::kDepth)) depth = std::ldexp(depth, -power);
    for (int axis = 0; axis < 3; ++axis) {
      for (float& value : scaled.guides.Plane(Layer::kPosition, axis)) value = std::ldexp(value, -power);
    }
    EXPECT_TRUE(SameBytes(plain.guides, scaled.guides)) << "2^" << power;
    EXPECT_EQ(plain.rays.shadow, scaled.rays.shadow);
    EXPECT_EQ(plain.rays.bounce, scaled.rays.bounce);
  }
}

TEST(ExtremeScale, PowersOfTwoChangeNoBit) {
  GuidegenOptions options = Sized(61, 47, Everything());
  options.aa = 2;
  ExpectNoBitChanges(SmallScene, options);
}

// Irradiance is strength over squared distance, a light's strength grows with the square of the scale, and radiances do
// not; chance is hashed by pixel. So light with extent, wherever it is reflected, has the same bits too.
TEST(ExtremeScale, PowersOfTwoChangeNoBitOfAreaLight) {
  GuidegenOptions options = Sized(24, 18, Everything().Add(kAllPaths));
  options.samples = 4;
  ExpectNoBitChanges(SoftScene, options);
}

// Powers of ten round the matrices, so here the truth is worked out anew at each scale.
TEST(ExtremeScale, EveryDecadeFromAMicrometreToAThousandKilometresIsTheFormulas) {
  for (int power = -6; power <= 6; ++power) {
    SCOPED_TRACE("1e" + std::to_string(power));
    const double scale = std::pow(10.0, power);
    const ExactCount count = ExpectExactGuides(SmallScene(scale), SmallSceneCamera(scale), 41, 31);
    EXPECT_GT(count.covered, 41 * 31 / 2);
    // Float's sight is 1e-6 of 10 m to either side of edges that are 1,300 pixels of 0.15 m long in all: 0.17 centres
    // are expected, and none is there.
    EXPECT_EQ(count.undecided, 0);
  }
}

// --- Triangles that are hardly any --------------------------------------------------------------------------------

// A triangle 2 m long and 2 m / aspect high, at random before the eye. The middle of nine rays is aimed at it and, by
// less than float's blur, beside it; the others pass 3e-5 m and more beside that one. Where the plain caster is
// decided, rays meet the triangle as it says. Wherever it is met, what is shown lies on the ray, and the normal is the
// triangle's own: it comes from corners in double, each a sum of four products below 2 m: two of them are off by 16
// steps of 2^-52, over the height.
TEST(Slivers, OfAnyAspectAreShownWhereTheRayPassesThem) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> spread(-1.0, 1.0);
  const auto vector = [&] { return glm::dvec3(spread(random), spread(random), spread(random)); };
  const double three_apart = glm::degrees(2.0 * std::atan(1.5 * 3e-5 / 5.0));  // of the picture, from 5 m
  GuidegenOptions options = Sized(3, 3, {Layer::kPosition});
  options.threads = 1;
  for (const double aspect : {1e2, 1e3, 2e3, 1e4, 1e5, 1e6, 1e7, 1e8}) {
    SCOPED_TRACE("aspect " + std::to_string(aspect));
    const double height = 2.0 / aspect;
    int met = 0, must_meet = 0, must_miss = 0;
    for (int trial = 0; trial < 400; ++trial) {
      Mesh mesh;
      mesh.positions = {{-1, 0, 0}, {1, 0, 0}, {0.3, height, 0}};
      mesh.triangles = {{0, 1, 2}};
      if (trial % 2 == 0) mesh.normals.assign(3, {0, 0, 1});
      const glm::dvec3 at = vector(), axis = vector();
      const glm::dmat4 placed = glm::rotate(Moved(at.x, at.y, at.z), 3.0 * spread(random), axis);
      const glm::dvec3 beside = 3e-7 * vector();
      const glm::dvec3 aim(placed * glm::dvec4(0.7 * spread(random), 0.1 * height + beside.y, beside.z, 1.0));
      const Scene scene = SceneOf(mesh, placed);
      const Camera camera = LookingAt({0, 0, 5}, aim, three_apart);
      const GuideSet guides = Render(scene, camera, options).guides;
      const glm::dvec3 normal = glm::dmat3(guides.camera->view_from_world) * glm::dvec3(placed[2]);
      for (std::size_t i = 0; i < 9; ++i) {
        const bool middle = i == 4, covered = guides.Plane(Layer::kCoverage)[i] == 1.0f;
        const ExactRay ray = PixelRay(camera, 3, 3, double(i % 3), double(i / 3));
        const ExactHit hit = MeetExactly(scene, camera, ray);
        if (!hit.Undecided()) {
          must_meet += middle && hit.instance >= 0;
          must_miss += !middle && hit.instance < 0;
          EXPECT_EQ(covered, hit.instance >= 0) << "trial " << trial << ", ray " << i << ", clear " << hit.clearance;
        }
        if (!covered) continue;
        met += middle;
        const glm::dvec3 from_eye = glm::dvec3(guides.Vec3(Layer::kPosition, i)) - glm::dvec3(0, 0, 5);
        EXPECT_LE(ray.DistanceTo(from_eye), 7.0 * kFloatSight);
        const glm::dvec3 seen(guides.Vec3(Layer::kNormal, i));
        EXPECT_LE(std::min(glm::distance(seen, normal), glm::distance(seen, -normal)),
                  2.0 * kRounded + 16.0 * 0x1p-52 / height);
      }
    }
    // Aimed from 3e-7 m below to as much above, one ray in thirty meets the 2e-8 m of the thinnest: 13 of 400, ten
    // fewer in a run of a few hundred.
    EXPECT_GT(met, 3);
    // The middle ray passes a tenth of the height above the long edge, and as it sees it that is the cosine less of an
    // angle that may be any: more than float's sight of some 6 m for four in five at 1e4, and nearly all below.
    if (aspect <= 1e4) {
      EXPECT_GT(must_meet, 300);
    }
    // The eight others are off the line of what is thinner than float's sight by that much as seldom as any angle's
    // sine is below a fifth: one in eight.
    if (aspect >= 1e5) {
      EXPECT_GT(must_miss, 2400);
    }
  }
}

// Where slivers are part of a surface no ray falls between them and their neighbours: corners that are shared are
// rounded alike, however many of them fall into one place.
TEST(Slivers, LeaveNoCracks) {
  Mesh mesh;
  const std::array<float, 5> heights = {-1.0f, 0.0f, 2e-8f, 4e-8f, 1.0f};
  for (const float y : heights) {
    for (const float x : {-1.0f, 1.0f}) mesh.positions.push_back({x, y, 0.3f * x});
  }
  for (unsigned row = 0; row + 1 < heights.size(); ++row) {
    const unsigned a = 2 * row;
    mesh.triangles.push_back({a, a + 1, a + 3});
    mesh.triangles.push_back({a, a + 3, a + 2});
  }
  mesh.normals.assign(mesh.positions.size(), glm::normalize(glm::vec3(-0.3f, 0.0f, 1.0f)));
  for (const double turn : {0.0, 0.1, 0.7, 1.3}) {
    const glm::dmat4 placed = glm::rotate(Moved(0.1, 0.05, 0), turn, glm::dvec3(0.3, 0.5, 1));
    const Scene scene = SceneOf(mesh, placed);
    // The slivers' line runs through the middle of the picture, along its rows where nothing is turned.
    const Camera camera = LookingAt(glm::dvec3(placed[3]) + glm::dvec3(0, 0, 6), glm::dvec3(placed[3]), 12.0);
    const GuideSet guides = Render(scene, camera, Sized(201, 201)).guides;
    const glm::dvec3 normal =
        glm::dmat3(guides.camera->view_from_world) * glm::dmat3(placed) * glm::normalize(glm::dvec3(-0.3, 0.0, 1.0));
    // What the outline covers, as one piece.
    Scene whole = scene;
    whole.meshes[0].triangles = {{0, 1, 9}, {0, 9, 8}};
    int covered = 0;
    for (int pixel = 0; pixel < 201 * 201; ++pixel) {
      const ExactRay ray = PixelRay(camera, 201, 201, pixel % 201, pixel / 201);
      const ExactHit hit = MeetExactly(whole, camera, ray);
      const glm::dvec3 at = glm::transpose(glm::dmat3(placed)) *
                            (ray.At(hit.depth) + glm::dvec3(camera.world_from_camera[3]) - glm::dvec3(placed[3]));
      if (hit.instance < 0 || std::max(std::abs(at.x), std::abs(at.y)) > 0.99) continue;
      ++covered;
      ASSERT_EQ(guides.Plane(Layer::kCoverage)[pixel], 1.0f) << "pixel " << pixel << ", turn " << turn;
      ASSERT_LE(glm::distance(glm::dvec3(guides.Vec3(Layer::kNormal, pixel)), normal), 3.0 * kRounded);
    }
    EXPECT_GT(covered, 201 * 201 / 2);
  }
}

// Points and lines have no area, so no ray meets them but by rounding: all pixels whose ray stays clear of them show
// the wall behind, and the others what lies on their ray.
TEST(NoArea, HidesNothing) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> spread(-1.0f, 1.0f);
  Scene scene = SceneOf(QuadMesh(), glm::scale(glm::dmat4(1.0), glm::dvec3(3.0)));
  Mesh nothing;
  for (unsigned i = 0; i < 200; ++i) {
    const glm::vec3 a(spread(random), spread(random), 1.0f + spread(random));
    const glm::vec3 way = i % 3 == 0 ? glm::vec3(0.0f) : glm::vec3(spread(random), spread(random), spread(random));
    for (const float step : {0.0f, 1.0f, i % 2 == 0 ? 0.5f : 2.0f}) nothing.positions.push_back(a + way * step);
    nothing.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  nothing.normals.assign(nothing.positions.size(), {0, 0, 1});
  AddObject(scene, "nothing", nothing, glm::dmat4(1.0));
  const ExactCount count = ExpectExactGuides(scene, FrontCamera(5.0, 30.0), 64, 64);
  EXPECT_EQ(count.covered, count.decided);
  EXPECT_GT(count.covered, 4000);
  EXPECT_GT(ExpectExactGuides(scene, FlatCamera(5.0, 1.0), 64, 64).covered, 4000);
}

// --- Surfaces in one place ----------------------------------------------------------------------------------------

std::set<std::string> SeenIn(const GuideSet& guides) {
  std::set<std::string> names;
  for (const float id : guides.Plane(Layer::kObject)) {
    if (id != 0.0f) names.insert(guides.object_names.at(unsigned(id)));
  }
  return names;
}

// Of exact copies the last in the scene's list is seen, all over, as the last coat of paint is. It does not matter how
// many there are, whether they share their mesh, or which instructions trace them; otherwise the hierarchy would choose
// another one from pixel to pixel.
TEST(OnePlace, OfExactCopiesTheLastIsSeen) {
  for (const int copies : {2, 3, 5, 9, 40, 200}) {
    Scene scene = SceneOf(BallMesh(8));
    for (int i = 1; i < copies; ++i) {
      if (i % 4 == 0) scene.meshes.push_back(scene.meshes[0]);
      scene.instances.push_back({"copy" + std::to_string(i), int(scene.meshes.size()) - 1, glm::dmat4(1.0)});
    }
    GuidegenOptions options = Sized(50, 50);
    const std::set<std::string> last = {scene.instances.back().object};
    for (const char* isa : {"sse2", "avx2", "avx512"}) {
      options.isa = isa;
      const auto result = RenderGuides(scene, LookingAt({1, 1.5, 3}, {0, 0, 0}), options);
      if (!result) continue;  // not on this machine
      EXPECT_EQ(SeenIn(result->guides), last) << copies << " copies, " << isa;
    }
  }
}

// What the last copy lets through is seen: holes, and backs that are culled.
TEST(OnePlace, ACopyThatCanBeSeenThroughHidesNothing) {
  Scene scene = SceneOf(QuadMesh());
  scene.materials.resize(2);
  Mesh upper = QuadMesh();
  upper.material = 1;
  AddObject(scene, "upper", upper, glm::dmat4(1.0));
  const Camera front = FlatCamera(3.0, 0.9);
  EXPECT_EQ(SeenIn(Render(scene, front, Sized(20, 20)).guides), (std::set<std::string>{"upper"}));
  scene.materials[1].alpha_mode = AlphaMode::kMask;
  scene.materials[1].base_color.a = 0.1f;
  EXPECT_EQ(SeenIn(Render(scene, front, Sized(20, 20)).guides), (std::set<std::string>{"thing"}));
  scene.materials[1] = {};
  scene.materials[1].double_sided = false;
  Camera behind = LookingAt({0, 0, -3}, {0, 0, 0});
  behind.orthographic = true;
  behind.ymag = 0.9;
  EXPECT_EQ(SeenIn(Render(scene, behind, Sized(20, 20)).guides), (std::set<std::string>{"thing"}));
  scene.materials[0].double_sided = false;
  EXPECT_EQ(SeenIn(Render(scene, front, Sized(20, 20)).guides), (std::set<std::string>{"upper"}));
  ExpectEmpty(Render(scene, behind, Sized(20, 20)).guides);
}

// Shapes in one plane that are no copies: which of them a pixel shows is float's choice, but depth and normal are the
// plane's whoever wins, nothing shows through, and the choice is the same on any number of threads.
TEST(OnePlace, SurfacesInOnePlaneHaveItsDepthAndAreTheSameForAnyThreads) {
  for (const double lean : {0.0, 0.3, 1.2, 1.55}) {
    const glm::dmat4 plane = glm::rotate(glm::dmat4(1.0), lean, glm::dvec3(0.2, 1.0, 0.0));
    Scene scene = SceneOf(QuadMesh(), plane);
    for (const double turn : {0.5, 1.1}) {
      scene.instances.push_back({"turned" + std::to_string(turn), 0, glm::rotate(plane, turn, glm::dvec3(0, 0, 1))});
    }
    const Camera camera = FrontCamera(3.0);
    GuidegenOptions options = Sized(80, 80);
    options.threads = 1;
    const auto one = Render(scene, camera, options);
    for (const int threads : {2, 3, 7}) {
      options.threads = threads;
      EXPECT_TRUE(SameBytes(one.guides, Render(scene, camera, options).guides)) << threads << " threads";
    }
    const glm::dvec3 normal(plane[2]);
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 80; ++x) {
        const std::size_t i = one.guides.Index(x, y);
        const ExactRay ray = PixelRay(camera, 80, 80, x, y);
        const ExactHit hit = MeetExactly(scene, camera, ray);
        const bool clear = hit.clearance > hit.farthest * kFloatSight;
        if (!clear) continue;
        ASSERT_EQ(one.guides.Plane(Layer::kCoverage)[i] == 1.0f, hit.instance >= 0);
        if (hit.instance < 0) continue;
        const double depth = glm::dot(normal, glm::dvec3(0, 0, -3)) / glm::dot(normal, ray.direction);
        // Each rotation is rounded by some 2^-52 of a metre: leaning, that is as much more depth as the cosine is
        // small.
        ASSERT_NEAR(one.guides.Plane(Layer::kDepth)[i], depth, std::ldexp(depth, -24) + 0x1p-48 / hit.facing);
        ASSERT_LE(glm::distance(glm::dvec3(one.guides.Vec3(Layer::kNormal, i)), normal * (normal.z < 0 ? -1.0 : 1.0)),
                  2.0 * kRounded);
      }
    }
  }
}

// Twice the same triangles in one mesh, once with leaning normals: one object whoever wins, its depth is theirs, and a
// pixel shows one of the two normals, never a mixture, the same one on any number of threads.
TEST(OnePlace, TrianglesThatAMeshHoldsTwiceAreOneSurface) {
  Scene scene = SceneOf(QuadMesh());
  Mesh& mesh = scene.meshes[0];
  const glm::vec3 leaning(0.6f, 0.0f, 0.8f);
  for (unsigned i = 0; i < 4; ++i) {
    mesh.positions.push_back(glm::vec3(mesh.positions[i]));
    mesh.normals.push_back(leaning);
    mesh.uvs[0].push_back(glm::vec2(mesh.uvs[0][i]));
  }
  mesh.triangles.insert(mesh.triangles.end(), {{4, 5, 6}, {4, 6, 7}});
  GuidegenOptions options = Sized(40, 40);
  options.threads = 1;
  const auto one = Render(scene, FlatCamera(3.0, 1.0), options);
  for (std::size_t i = 0; i < 1600; ++i) {
    EXPECT_EQ(one.guides.Plane(Layer::kDepth)[i], 3.0f);
    const glm::vec3 normal = one.guides.Vec3(Layer::kNormal, i);
    EXPECT_TRUE(normal == glm::vec3(0, 0, 1) || glm::distance(normal, leaning) < float(2.0 * kRounded));
  }
  for (const int threads : {2, 3, 7}) {
    options.threads = threads;
    EXPECT_TRUE(SameBytes(one.guides, Render(scene, FlatCamera(3.0, 1.0), options).guides)) << threads << " threads";
  }
}

// Two planes, one a little before the other. The nearer one is seen in every pixel as soon as the gap along the ray is
// larger than float's blur of a depth; the gaps tried are just above that.
TEST(OnePlace, TheNearerOfTwoPlanesIsSeenOnceTheyAreFartherApartThanFloatsBlur) {
  for (const double distance : {1.0, 30.0, 1000.0}) {
    for (const double lean : {0.0, 0.5, 1.0}) {
      const double farthest = distance * 1.5;
      const double gap = 1.01 * farthest * kFloatSight;
      const glm::dmat4 plane =
          glm::scale(glm::rotate(glm::dmat4(1.0), lean, glm::dvec3(0, 1, 0)), glm::dvec3(distance / 4));
      Scene scene = SceneOf(QuadMesh(), plane);
      const glm::dvec3 towards = glm::dvec3(glm::normalize(plane[2])) * gap;
      scene.instances.push_back({"nearer", 0, Moved(towards.x, towards.y, towards.z) * plane});
      scene.instances.push_back({"farther", 0, Moved(-towards.x, -towards.y, -towards.z) * plane});
      const GuideSet guides = Render(scene, FrontCamera(distance, 10.0), Sized(60, 60)).guides;
      EXPECT_EQ(SeenIn(guides), (std::set<std::string>{"nearer"})) << distance << " m, lean " << lean;
    }
  }
}

// --- Normals without a length -------------------------------------------------------------------------------------

// A loader promises unit normals; the ray caster looks anyway. A length of 1e-30 is what cancelling floats leave, not a
// direction, so the triangle's own normal stands in, as for 0, NaN and infinity; where one corner of three is good and
// the others are 0, it is that corner's that counts.
TEST(ExtremeNormals, TheRayCasterTakesTheTrianglesOwnForWhatHasNoDirection) {
  const glm::dmat4 placed = glm::rotate(glm::dmat4(1.0), 0.5, glm::dvec3(0, 1, 0));
  const auto normal_with = [&](const std::vector<glm::vec3>& normals) {
    Scene scene = SceneOf(QuadMesh(), placed);
    scene.meshes[0].normals = normals;
    scene.lights = {PointLight({0, 0, 5}, 1.0)};
    const auto result = Render(scene, FlatCamera(3.0, 0.4), Sized(6, 6, Everything()));
    for (std::size_t i = 1; i < 36; ++i) {
      EXPECT_LE(glm::distance(result.guides.Vec3(Layer::kNormal, i), result.guides.Vec3(Layer::kNormal, 0)),
                float(2.0 * kRounded));
      EXPECT_GT(result.guides.Plane(Layer::kLuminance)[i], 0.0f);
    }
    return glm::dvec3(result.guides.Vec3(Layer::kNormal, 0));
  };
  const glm::dvec3 own(std::sin(0.5), 0.0, std::cos(0.5));
  for (const glm::vec3 bad : {glm::vec3(0.0f), glm::vec3(0, 1e-30f, 0), glm::vec3(0, 1e-45f, 0), glm::vec3(kNan),
                              glm::vec3(0, kNan, 1), glm::vec3(0, kInfinity, 0), glm::vec3(-kInfinity, kInfinity, 0)}) {
    EXPECT_LE(glm::distance(normal_with({bad, bad, bad, bad}), own), 2.0 * kRounded)
        << bad.x << " " << bad.y << " " << bad.z;
  }
  const glm::vec3 good(0, 0.6f, 0.8f);
  const glm::dvec3 turned = glm::dmat3(placed) * glm::dvec3(good);
  const glm::vec3 none(0.0f), less(0, 1e-30f, 0);
  EXPECT_LE(glm::distance(normal_with({good, none, less, none}), turned), 3.0 * kRounded);
  // Far too long is as good as any length.
  for (const float length : {1e-3f, 1e10f, 1e30f}) {
    EXPECT_LE(glm::distance(normal_with(std::vector<glm::vec3>(4, good * length)), turned), 3.0 * kRounded) << length;
  }
}

// --- Grazing, dust and planets ------------------------------------------------------------------------------------

// A depth is the plane's distance over the cosine. The distance is good to 2^-50 m, so at 89.999°, cosine 1.7e-5, the
// depth is still good to 5e-11 of a metre, far below a float's step: grazing costs nothing.
TEST(Grazing, DepthsAreTheFormulasUpTo89999ThousandthsOfADegree) {
  for (const double angle : {80.0, 89.0, 89.9, 89.99, 89.999}) {
    SCOPED_TRACE(angle);
    const double lean = glm::radians(angle);
    const glm::dmat4 placed = glm::scale(glm::rotate(glm::dmat4(1.0), lean, glm::dvec3(1, 0, 0)), glm::dvec3(100.0));
    const Scene scene = SceneOf(QuadMesh(), placed);
    // Seen flat on, the plane is as high as the cosine leaves it: that height is spread over the picture.
    for (const bool orthographic : {true, false}) {
      Camera camera = FlatCamera(200.0, 120.0 * std::cos(lean));
      camera.orthographic = orthographic;
      camera.yfov_degrees = 2.0 * glm::degrees(std::atan(camera.ymag / 200.0));
      const ExactCount count = ExpectExactGuides(scene, camera, 31, 33);
      EXPECT_GT(count.covered, 31 * 33 / 3);
      const GuideSet guides = Render(scene, camera, Sized(31, 33)).guides;
      const glm::dvec3 normal(0.0, -std::sin(lean), std::cos(lean));
      int covered = 0;
      for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
        if (guides.Plane(Layer::kCoverage)[i] == 0.0f) continue;
        ++covered;
        const glm::dvec3 seen(guides.Vec3(Layer::kNormal, i));
        // In perspective the upper rays may meet the other side.
        EXPECT_LE(std::min(glm::distance(seen, normal), orthographic ? 2.0 : glm::distance(seen, -normal)),
                  2.0 * kRounded);
      }
      EXPECT_GE(covered, count.covered);
    }
  }
}

// A sphere mesh a thousandth of a pixel across is a point. A ray through it sees it and its normal; subsamples beside
// it do not, so its coverage is that of the one subsample, and moved between the subsamples it is gone.
TEST(Dust, ABallOfAThousandthOfAPixelIsSeenByTheRayThatMeetsItAndByNoOther) {
  for (const double distance : {1.0, 1e3, 1e6}) {
    SCOPED_TRACE(distance);
    const double pixel = 2.0 * distance * std::tan(glm::radians(20.0)) / 32.0;
    const auto seen_at = [&](double x, double y, int aa) {  // in pixels from the picture's middle, y down
      const glm::dmat4 placed = glm::scale(Moved(x * pixel, -y * pixel, 0.0), glm::dvec3(0.0005 * pixel));
      GuidegenOptions options = Sized(32, 32, {Layer::kPosition});
      options.aa = aa;
      return Render(SceneOf(BallMesh(16), placed), FrontCamera(distance, 40.0), options).guides;
    };
    const GuideSet centre = seen_at(3.5, -5.5, 1);
    for (std::size_t i = 0; i < 1024; ++i) {
      EXPECT_EQ(centre.Plane(Layer::kCoverage)[i], i == centre.Index(19, 10) ? 1.0f : 0.0f);
    }
    const std::size_t at = centre.Index(19, 10);
    EXPECT_NEAR(centre.Plane(Layer::kDepth)[at], distance - 0.0005 * pixel, distance * kFloatSight + 0.0005 * pixel);
    EXPECT_EQ(seen_at(3.5 + 1.0 / 32, -5.5 + 1.0 / 32, 16).Plane(Layer::kCoverage)[at], 1.0f / 256);
    ExpectEmpty(seen_at(3.5 + 2.0 / 32, -5.5 + 1.0 / 32, 16));
    ExpectEmpty(seen_at(3.5 + 1.0 / 32, -5.5, 1));
    EXPECT_EQ(seen_at(3.5, -5.5, 16).Plane(Layer::kCoverage)[at], 1.0f / 256);  // a centre that is hit is never empty
  }
}

// The same sphere mesh, turned so that the middle of a facet faces the eye. On a sphere mesh interpolated normals are
// the facet's places themselves, so the ray through its middle sees the normal that points back along it: to the
// rounding of corners, normals and the result to floats, two of them over the facet's height above the sphere mesh's
// middle, which is 0.9 at least. The facet's own normal, at whose place it would be the wrong one, is another by more
// than that wherever facets are not regular.
TEST(Dust, ItsNormalIsTheOneUnderTheRay) {
  const Mesh ball = BallMesh(4);
  const glm::uvec3& facet = ball.triangles[10];
  glm::dvec3 corners[3];
  for (int c = 0; c < 3; ++c) corners[c] = glm::dvec3(ball.positions[facet[c]]);
  // A place clear of the facet's edges by far more than float's sight, and not its own normal's.
  const glm::dvec3 place = glm::normalize(0.5 * corners[0] + 0.25 * corners[1] + 0.25 * corners[2]);
  const glm::dvec3 own = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  for (const double distance : {1.0, 1e3, 1e6}) {
    SCOPED_TRACE(distance);
    const Camera camera = FrontCamera(distance, 40.0);
    const double pixel = 2.0 * distance * std::tan(glm::radians(20.0)) / 32.0;
    const glm::dvec3 to_eye = -glm::normalize(PixelRay(camera, 32, 32, 19, 10).direction);
    const glm::dmat4 turned =
        glm::rotate(glm::dmat4(1.0), std::acos(glm::dot(place, to_eye)), glm::normalize(glm::cross(place, to_eye)));
    const glm::dmat4 placed = glm::scale(Moved(3.5 * pixel, 5.5 * pixel, 0.0), glm::dvec3(0.0005 * pixel)) * turned;
    const GuideSet guides = Render(SceneOf(ball, placed), camera, Sized(32, 32)).guides;
    const glm::dvec3 seen(guides.Vec3(Layer::kNormal, guides.Index(19, 10)));
    const double limit = 3.0 * kRounded / 0.9;
    EXPECT_LE(glm::distance(seen, to_eye), limit);
    EXPECT_GT(glm::distance(glm::dvec3(turned * glm::dvec4(own, 0.0)), to_eye), 1e5 * limit);
  }
}

// A sphere mesh ten thousand times as wide as the picture. Its facets are larger than the picture too; each pixel shows
// the facet that the plain caster finds, and the normal points away from the sphere mesh's middle, because on a sphere
// mesh interpolated normals are the facet's places themselves.
TEST(Planet, ABallTenThousandTimesThePictureIsExactUnderTheEye) {
  for (const double radius : {1.0, 6.4e6}) {
    for (const double degrees : {0.0, 45.0, 85.0}) {
      SCOPED_TRACE(std::to_string(radius) + " m, seen at " + std::to_string(degrees));
      const Scene scene = SceneOf(BallMesh(24), glm::scale(glm::dmat4(1.0), glm::dvec3(radius)));
      const glm::dvec3 up = glm::normalize(glm::dvec3(0.31, 0.9, 0.2));
      const glm::dvec3 level = glm::normalize(glm::cross(up, glm::dvec3(0.3, 0.1, 1.0)));
      const double angle = glm::radians(degrees);
      const glm::dvec3 eye = up * (1.001 * radius);
      Camera camera = LookingAt(eye, eye + (level * std::sin(angle) - up * std::cos(angle)) * radius);
      camera.orthographic = true;
      camera.ymag = radius / 1e4;
      const GuideSet guides = Render(scene, camera, Sized(24, 24, {Layer::kPosition})).guides;
      const ExactCount count = ExpectExact(scene, camera, guides);
      EXPECT_GT(count.covered, 500);
      const glm::dmat3 view_from_world(guides.camera->view_from_world);
      for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
        const glm::dvec3 outward = view_from_world * glm::normalize(glm::dvec3(guides.Vec3(Layer::kPosition, i)));
        EXPECT_LE(glm::distance(glm::dvec3(guides.Vec3(Layer::kNormal, i)), outward), 4.0 * kRounded);
      }
    }
  }
}

}  // namespace
}  // namespace scumble::testing
