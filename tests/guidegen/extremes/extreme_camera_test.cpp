// The ray caster with lenses and cameras at the ends of their ranges, against spheres and planes in closed form and
// against exact_rays.h's plain caster.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "guidegen/framing.h"
#include "guidegen/load_scene.h"
#include "guidegen/rays/camera_rays.h"
#include "tests/support/exact_rays.h"
#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"

namespace scumble::testing {
namespace {

constexpr float kNoDepth = std::numeric_limits<float>::infinity();
constexpr int kRings = 96;
// A facet of BallMesh spans half a degree's worth of rings both ways, so its diagonal sees half a step times √2 from
// the middle: no place of it lies deeper under the unit sphere than this.
const double kInset = 1.0 - std::cos(glm::pi<double>() / kRings / std::sqrt(2.0));

// A sphere mesh of radius 1 about `centre`, seen along one ray: how far the ray passes from the centre, and where it
// enters and leaves the sphere.
struct SphereView {
  SphereView(const ExactRay& ray, const glm::dvec3& centre) {
    const double squared = glm::dot(ray.direction, ray.direction);
    const double middle = glm::dot(centre - ray.origin, ray.direction) / squared;
    passes_by = ray.DistanceTo(centre);
    const double half = std::sqrt(std::max(0.0, 1.0 - passes_by * passes_by) / squared);
    enters = middle - half;
    leaves = middle + half;
  }
  double passes_by, enters, leaves;
};

// The normals of a sphere mesh against the sphere's. On a sphere mesh of radius 1 the interpolated normal is the
// facet's place, made a unit: what a ray sees at the radius r has the angle asin(b / r) to the ray, b being how far the
// ray passes from the centre, while the sphere itself has asin(b). Facets have r between 1 − inset and 1. To that come
// 4 roundings to float: of the vertices, their normals, the weights and the result, each of 2^-24 in three coordinates.
int ExpectBall(const GuideSet& guides, const Camera& camera, const glm::dvec3& centre, bool from_inside) {
  const glm::dmat3 view_from_world(guides.camera->view_from_world);
  constexpr double kRounding = 4.0 * 1.7320508 / (1 << 24);
  int checked = 0;
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      SCOPED_TRACE("pixel " + std::to_string(x) + ", " + std::to_string(y));
      const std::size_t i = guides.Index(x, y);
      const ExactRay ray = PixelRay(camera, guides.width(), guides.height(), x, y);
      const SphereView view(ray, centre);
      const double blur = (1.0 + glm::length(centre)) * kFloatSight;
      const bool covered = guides.Plane(Layer::kCoverage)[i] == 1.0f;
      const bool must_miss = !from_inside && view.passes_by > 1.0 + blur;
      const bool must_meet = from_inside || view.passes_by < 1.0 - kInset - blur;
      EXPECT_TRUE(covered ? !must_miss : !must_meet);
      const double deepest = view.passes_by / (1.0 - kInset);
      if (!covered || deepest >= 1.0) continue;
      ++checked;
      const glm::dvec3 outward = glm::normalize(ray.At(from_inside ? view.leaves : view.enters) - centre);
      const glm::dvec3 truth = view_from_world * outward * (from_inside ? -1.0 : 1.0);
      const double angle = std::asin(deepest) - std::asin(view.passes_by);
      EXPECT_LE(glm::distance(glm::dvec3(guides.Vec3(Layer::kNormal, i)), truth), angle + kRounding);
      // The facet's place on the ray is under the sphere's by what the same two radii leave of the chord.
      const double chord = std::sqrt(1.0 - view.passes_by * view.passes_by);
      const double inner = std::sqrt((1.0 - kInset) * (1.0 - kInset) - view.passes_by * view.passes_by);
      const double depth = from_inside ? view.leaves : view.enters;
      EXPECT_NEAR(guides.Plane(Layer::kDepth)[i], depth, chord - inner + std::ldexp(depth + 1.0, -23));
      if (::testing::Test::HasFailure()) return checked;
    }
  }
  return checked;
}

// --- Field of view ------------------------------------------------------------------------------------------------

// From 0.1° to 175° the same sphere mesh fills the same part of the picture, from as far as that takes. Through the
// longest lens it is 2 km away: a float's step there is 0.1 mm, a double's is nothing.
TEST(FieldOfView, ABallHasTheSpheresNormalsFromATenthOfADegreeTo175) {
  for (const double degrees : {0.1, 1.0, 10.0, 40.0, 90.0, 120.0, 150.0, 170.0, 175.0}) {
    SCOPED_TRACE(degrees);
    const double half = glm::radians(degrees / 2.0);
    // Tangents from the eye to the sphere mesh make this angle with the axis.
    const double distance = 1.0 / std::sin(std::atan(std::tan(half) * 0.8));
    const Camera camera = LookingAt(glm::dvec3(0.36, 0.48, 0.8) * distance, {0, 0, 0}, degrees);
    const GuideSet guides = Render(SceneOf(BallMesh(kRings)), camera, Sized(60, 60)).guides;
    const int checked = ExpectBall(guides, camera, glm::dvec3(camera.world_from_camera[2]) * -distance, false);
    EXPECT_GT(checked, 1400);  // a disc of 0.8 of the picture's width has half of its 3600 pixels
  }
}

// A wall across the view has one depth and one normal in every pixel, however wide the lens; where it is seen grows
// with the tangent. In the eye's own frame its normal is the mirror image of the direction to the eye, and never
// beyond.
TEST(FieldOfView, AWallHasOneDepthAndOneNormalUpTo1799Tenths) {
  for (const double degrees : {1e-3, 0.1, 30.0, 90.0, 150.0, 175.0, 179.0, 179.9}) {
    SCOPED_TRACE(degrees);
    const double tangent = std::tan(glm::radians(degrees / 2.0));
    const double size = std::max(1.0, 8.0 * tangent);
    const Scene scene = SceneOf(QuadMesh(), glm::scale(glm::dmat4(1.0), glm::dvec3(size)));
    const Camera camera = FrontCamera(3.0, degrees);
    GuidegenOptions options = Sized(31, 21, {Layer::kPosition});
    const GuideSet guides = Render(scene, camera, options).guides;
    options.normal_frame = NormalFrame::kEye;
    const GuideSet eye_frame = Render(scene, camera, options).guides;
    for (int y = 0; y < 21; ++y) {
      for (int x = 0; x < 31; ++x) {
        const std::size_t i = guides.Index(x, y);
        ASSERT_EQ(guides.Plane(Layer::kDepth)[i], 3.0f);
        ASSERT_EQ(guides.Vec3(Layer::kNormal, i), glm::vec3(0, 0, 1));
        const ExactRay ray = PixelRay(camera, 31, 21, x, y);
        const glm::dvec3 at = ray.At(3.0) + glm::dvec3(0, 0, 3);
        for (int axis = 0; axis < 3; ++axis) {
          // One rounding to float, and double's along a wall of this size.
          ASSERT_NEAR(guides.Plane(Layer::kPosition, axis)[i], at[axis],
                      std::ldexp(std::abs(at[axis]), -24) + std::ldexp(size, -50));
        }
        const glm::dvec3 to_eye = -glm::normalize(ray.direction);
        ASSERT_LE(glm::distance(glm::dvec3(eye_frame.Vec3(Layer::kNormal, i)), {-to_eye.x, -to_eye.y, to_eye.z}),
                  kRounded);
      }
    }
  }
}

// --- Parallel rays ------------------------------------------------------------------------------------------------

// The picture's extent and the scene's, one size: by exact_rays.h the same pixels at every scale.
TEST(Orthographic, ABallHasTheSpheresNormalsFromAMicrometreToAThousandKilometres) {
  for (int power = -6; power <= 6; ++power) {
    SCOPED_TRACE("1e" + std::to_string(power));
    const double scale = std::pow(10.0, power);
    Camera camera = LookingAt(glm::dvec3(1, 2, 4) * scale, {0, 0, 0});
    camera.orthographic = true;
    camera.ymag = 1.25 * scale;
    const auto sized = glm::scale(glm::dmat4(1.0), glm::dvec3(scale));
    const auto result = Render(SceneOf(BallMesh(kRings), sized), camera, Sized(50, 50));
    // The sphere mesh's own scale, for the formulas of a sphere mesh of radius 1.
    GuideSet guides = result.guides;
    for (float& depth : guides.Plane(Layer::kDepth)) depth = float(depth / scale);
    Camera unit = camera;
    unit.world_from_camera[3] = glm::dvec4(1, 2, 4, 1);
    unit.ymag = 1.25;
    EXPECT_GT(ExpectBall(guides, unit, {-1, -2, -4}, false), 1200);
  }
}

// A picture two micrometres high of a thing two metres wide. In its middle there is nothing but the thing. Where its
// edge runs through the picture, float's sight at 3 m is 2.9e-6 m: up to there all pixels are float's to choose, and
// what it shows lies on their rays; in pictures larger than that the edge is where it belongs but for that blur. The
// cause is Embree's: corners 2 m away step by 1e-7 m, and its robust test widens a triangle by as much, so that no
// crack can open. Depths have no such blur.
TEST(Orthographic, AMicrometreOfAMetreWideThing) {
  const glm::dmat4 leaning = glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(0.2, 0.9, 0.1));
  for (const glm::dmat4& placed : {glm::dmat4(1.0), leaning}) {
    const Scene scene = SceneOf(QuadMesh(), placed);
    for (const double ymag : {1e-6, 1e-5, 1e-4, 1e-3}) {
      SCOPED_TRACE(ymag);
      const auto looking_at = [&](double x) {
        const glm::dvec3 target(placed * glm::dvec4(x, 0.25, 0.0, 1.0));
        Camera camera = LookingAt(target + glm::dvec3(0, 0, 2), target);
        camera.orthographic = true;
        camera.ymag = ymag;
        return camera;
      };
      EXPECT_EQ(ExpectExactGuides(scene, looking_at(0.5), 20, 20).covered, 400);
      const ExactCount edge = ExpectExactGuides(scene, looking_at(1.0), 20, 20);
      EXPECT_EQ(edge.decided > 0, ymag > 2e-6);
      if (ymag > 1e-4) {
        EXPECT_EQ(edge.undecided, 0);
      }
    }
  }
}

// The other end: a picture two thousand kilometres high. A thing of a metre is dust that the pixel's one ray meets if
// it is there, at its depth.
TEST(Orthographic, AThousandKilometresOfAMetreWideThing) {
  const Camera camera = FlatCamera(5.0, 1e6);
  const double pixel = 2e6 / 20;
  const Scene scene = SceneOf(QuadMesh(), Moved(4.5 * pixel, -2.5 * pixel, 0.0));
  const GuideSet guides = Render(scene, camera, Sized(20, 20, {Layer::kPosition})).guides;
  for (std::size_t i = 0; i < 400; ++i) {
    EXPECT_EQ(guides.Plane(Layer::kDepth)[i], i == guides.Index(14, 12) ? 5.0f : kNoDepth);
  }
}

// --- Near and far planes ------------------------------------------------------------------------------------------

// A plane that cuts a face leaves exactly the pixels whose depth by the formula lies behind it, but for float's
// rounding of the two depths: 2^-22 of them. What is cut away shows what is behind it.
TEST(NearPlane, CutsThroughAFaceWhereTheFormulaSays) {
  for (const bool orthographic : {false, true}) {
    for (const double lean : {0.2, 0.8, 1.4}) {
      const glm::dmat4 placed = glm::scale(glm::rotate(glm::dmat4(1.0), lean, glm::dvec3(0.3, 1, 0)), glm::dvec3(4.0));
      Scene scene = SceneOf(QuadMesh(), placed);
      AddObject(scene, "behind", QuadMesh(), glm::scale(Moved(0, 0, -6), glm::dvec3(20.0)));
      Camera camera = FrontCamera(6.0, 50.0);
      camera.orthographic = orthographic;
      camera.ymag = 2.5;
      camera.z_near = 5.7;
      camera.z_far = 11.9;  // and the wall behind is cut away, too
      for (int planes = 0; planes < 2; ++planes) {
        const GuideSet guides = Render(scene, camera, Sized(50, 40)).guides;
        int cut = 0, left = 0;
        for (int y = 0; y < 40; ++y) {
          for (int x = 0; x < 50; ++x) {
            const ExactRay ray = PixelRay(camera, 50, 40, x, y);
            Camera open = camera;
            open.z_near = 0.0;
            open.z_far = std::numeric_limits<double>::infinity();
            const ExactHit uncut = MeetExactly(scene, open, ray);
            const ExactHit hit = MeetExactly(scene, camera, ray);
            if (std::abs(uncut.depth - camera.z_near) <= uncut.depth * 0x1p-22 || uncut.Undecided()) continue;
            if (hit.instance >= 0 && std::abs(hit.depth - camera.z_far) <= hit.depth * 0x1p-22) continue;
            cut += uncut.depth < camera.z_near;
            left += uncut.instance == 0 && uncut.depth > camera.z_near;
            const double depth = guides.Plane(Layer::kDepth)[guides.Index(x, y)];
            if (hit.instance < 0) {
              ASSERT_EQ(depth, kNoDepth);
            } else {
              // Beside float's rounding: corners less than 32 from the middle are placed by a turn, a stretch and the
              // camera, no more than 16 roundings of a double's 2^-53, and what they are off counts along the ray.
              ASSERT_NEAR(depth, hit.depth, std::ldexp(hit.depth, -24) + 16.0 * 32.0 * 0x1p-53 / hit.facing);
            }
          }
        }
        EXPECT_GT(cut, 200) << lean;
        EXPECT_GT(left, 100) << lean;
        camera.z_far = std::numeric_limits<double>::infinity();
      }
    }
  }
}

// --- Beyond what Embree takes ---------------------------------------------------------------------------------------

// A ray's largest part is the half width of what is seen, at a distance of 1 in perspective. Expected: up to
// kLargestInRay a picture, of nothing or of what stands in the middle; beyond it kInput, where Embree may end the
// process.
TEST(FarOut, CamerasThatSeeBeyondEmbreesRangeAreRefused) {
  const Scene scene = SceneOf(CubeMesh());
  Camera camera = LookingAt({0, 0, 5}, {0, 0, 0}, 60.0);
  const auto expect = [&](int width, bool drawn) {
    const auto result = RenderGuides(scene, camera, Sized(width, 1, {Layer::kPosition}));
    ASSERT_EQ(bool(result), drawn) << width;
    if (drawn) return;
    EXPECT_EQ(result.error().kind, ErrorKind::kInput);
    EXPECT_NE(result.error().message.find(camera.name), std::string::npos) << result.error().message;
  };
  camera.aspect = 1e30;
  camera.fit = CameraFit::kVertical;
  expect(4, false);
  camera.aspect.reset();
  camera.yfov_degrees = glm::degrees(3.14159265358979);  // tangent of half of it 6.2e14
  expect(4, true);
  expect(kMaxImageSide, false);
  camera.shift_x = 1e4;
  expect(4, false);
  camera.shift_x = 0.0;
  camera.orthographic = true;
  for (const double half : {1e15, 1e18, 0.25 * kLargestInRay, 0.2500001 * kLargestInRay, 1e19, 1e300}) {
    camera.ymag = half;
    expect(1, half <= kLargestInRay);
    expect(4, 4.0 * half <= kLargestInRay);
  }
  camera.ymag = 1e15;
  expect(kMaxImageSide, false);
}

// --- Inside -------------------------------------------------------------------------------------------------------

// From any place inside a sphere mesh every ray meets its inside once, with the normal turned towards the eye; the
// sphere in closed form says where. Backs that are culled leave nothing.
TEST(Inside, ABallSeenFromWithinIsTheSphereTurnedInward) {
  for (const glm::dvec3 eye :
       {glm::dvec3(0.0), glm::dvec3(0.5, 0.2, -0.3), glm::dvec3(0.0, 0.0, 0.9), glm::dvec3(0.57, 0.57, 0.57)}) {
    for (const double degrees : {20.0, 90.0, 175.0}) {
      const glm::dvec3 target = eye + glm::dvec3(0.3, 0.1, -1.0);
      const Camera camera = LookingAt(eye, target, degrees);
      Scene scene = SceneOf(BallMesh(kRings));
      EXPECT_GT(ExpectBall(Render(scene, camera, Sized(40, 40)).guides, camera, -eye, true), 1000) << degrees;
      scene.materials[0].double_sided = false;
      ExpectEmpty(Render(scene, camera, Sized(40, 40)).guides);
    }
  }
}

// A micrometre from a wall of a box, and on it. From a micrometre away every ray still meets what it should. In the
// plane of the wall, on its edge and on its corner a ray begins on a surface: that surface is seen at depth 0, or what
// lies across the box where it belongs, and nothing else.
TEST(Inside, AMicrometreFromAWallAndOnIt) {
  const Scene scene = SceneOf(CubeMesh());
  for (const double gap : {1e-3, 1e-6}) {
    for (const double degrees : {60.0, 150.0}) {
      const ExactCount count =
          ExpectExactGuides(scene, LookingAt({1.0 - gap, 0.1, 0.2}, {-0.3, 0.2, -0.4}, degrees), 40, 40);
      EXPECT_EQ(count.covered, count.decided);
      EXPECT_GT(count.covered, 1500);
      // With the wall right before the eye.
      const GuideSet close = Render(scene, FrontCamera(-1.0 + gap, degrees), Sized(9, 9)).guides;
      for (std::size_t i = 0; i < 81; ++i) {
        // Embree's wall may be a float's step of 1 m off, which does not affect the depth.
        EXPECT_NEAR(close.Plane(Layer::kDepth)[i], gap, std::ldexp(gap, -24) + 0x1p-52);
        EXPECT_EQ(close.Vec3(Layer::kNormal, i), glm::vec3(0, 0, 1));
      }
    }
  }
  // The way across a box from a place of its surface, by its six planes.
  const auto across = [](const glm::dvec3& eye, const glm::dvec3& direction) {
    double way = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      way = std::min(way, ((direction[axis] < 0.0 ? -1.0 : 1.0) - eye[axis]) / direction[axis]);
    }
    return way;
  };
  // Also where corners are so far from their object's own origin that they are sums of large numbers.
  for (const float baked : {0.0f, 1024.0f, 65536.0f}) {
    Mesh mesh = CubeMesh();
    for (glm::vec3& corner : mesh.positions) corner += baked;
    const Scene far_box = SceneOf(mesh);
    for (const glm::dvec3 eye : {glm::dvec3(1, 0, 0), glm::dvec3(1, 1, 0), glm::dvec3(1, 1, 1)}) {
      const Camera camera = LookingAt(eye + double(baked), glm::dvec3(-0.5, -0.3, -1.0) + double(baked), 40.0);
      const GuideSet guides = Render(far_box, camera, Sized(21, 21)).guides;
      const glm::dvec3 view = -glm::dvec3(camera.world_from_camera[2]);
      int here = 0;
      for (int pixel = 0; pixel < 441; ++pixel) {
        EXPECT_EQ(guides.Plane(Layer::kCoverage)[pixel], 1.0f);
        EXPECT_NEAR(glm::length(glm::dvec3(guides.Vec3(Layer::kNormal, pixel))), 1.0, kRounded);
        const glm::dvec3 direction = PixelRay(camera, 21, 21, pixel % 21, pixel / 21).direction;
        for (int axis = 0; axis < 3; ++axis) ASSERT_TRUE(eye[axis] < 1.0 || direction[axis] < 0.0) << "out of the box";
        const double depth = guides.Plane(Layer::kDepth)[pixel];
        const double expected = across(eye, direction) * glm::dot(direction, view);
        const bool is_here = depth < 0.5 * expected;
        here += is_here;
        // Float's rounding, and double's: on the surface where the eye is nothing else is left.
        EXPECT_NEAR(depth, is_here ? 0.0 : expected,
                    (is_here ? 0.0 : std::ldexp(expected, -24)) + (1.0 + baked) * 0x1p-50)
            << pixel;
      }
      RecordProperty("seen_here_" + std::to_string(int(eye.y + eye.z)) + "_of_" + std::to_string(int(baked)), here);
    }
  }
}

// --- Up -----------------------------------------------------------------------------------------------------------

// A matrix whose up is parallel to the view does not determine the picture's rotation, and is refused by name. One
// whose up is barely off the view does: the view is kept exactly, and the small remaining part of up determines the
// rotation.
TEST(UpVector, ParallelToTheViewIsRefusedAndBarelyBesideItIsEnough) {
  const Scene scene = SceneOf(QuadMesh());
  const auto with_up = [](const glm::dvec3& up) {
    Camera camera = FrontCamera(3.0);
    camera.world_from_camera[1] = glm::dvec4(up, 0.0);
    return camera;
  };
  for (const glm::dvec3 up : {glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -2), glm::dvec3(0, 0, 1e-3)}) {
    const auto result = RenderGuides(scene, with_up(up), Sized(4, 4));
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, ErrorKind::kInput);
    EXPECT_NE(result.error().message.find("\"front\""), std::string::npos);
    EXPECT_NE(result.error().message.find("parallel"), std::string::npos) << result.error().message;
  }
  const auto upright = Render(scene, FrontCamera(3.0), Sized(20, 20));
  for (const double beside : {1.0, 1e-3, 1e-6, 1e-8}) {
    const auto result = Render(scene, with_up({0.0, beside, 1.0}), Sized(20, 20));
    EXPECT_TRUE(SameBytes(upright.guides, result.guides)) << beside;
    // A quarter turn: up is the world's +X. One ulp of 1 over `beside` is how far that direction is off; places are
    // less than 1 from the middle and rounded to floats.
    const GuideSet turned = Render(scene, with_up({beside, 0.0, 1.0}), Sized(20, 20, {Layer::kPosition})).guides;
    const std::size_t top = turned.Index(10, 8);
    EXPECT_GT(turned.Plane(Layer::kPosition, 0)[top], 0.1f);
    EXPECT_NEAR(std::abs(turned.Plane(Layer::kPosition, 1)[top]), turned.Plane(Layer::kPosition, 0)[top] / 3,
                0x1p-24 + 0x1p-52 / beside);
  }
}

// Straight up and straight down: the framing camera uses its angles, not a world's up, so these need no special case;
// the azimuth then determines the picture's rotation.
TEST(UpVector, ViewsFromStraightAboveAndBelowStandAsTheAzimuthSays) {
  const Scene scene = SceneOf(BallMesh(16));
  for (const double elevation : {90.0, -90.0}) {
    for (const double azimuth : {0.0, 35.0, 90.0, 200.0}) {
      const Camera camera = FramingCamera(scene, {azimuth, elevation, 0.0}, 1.0);
      const glm::dmat3 axes(camera.world_from_camera);
      const glm::dmat3 product = glm::transpose(axes) * axes;
      for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) EXPECT_NEAR(product[column][row], column == row ? 1.0 : 0.0, 1e-15);
      }
      EXPECT_NEAR(axes[2].y, elevation > 0.0 ? 1.0 : -1.0, 1e-15);
      const double angle = glm::radians(azimuth);
      const glm::dvec3 towards(std::sin(angle), 0.0, std::cos(angle));  // where the camera stood at elevation 0
      EXPECT_LE(glm::distance(axes[1], elevation > 0.0 ? -towards : towards), 1e-15);
      EXPECT_GT(ExpectExactGuides(scene, camera, 24, 24).covered, 200);
    }
  }
}

}  // namespace
}  // namespace scumble::testing
