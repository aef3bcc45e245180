// Where rays of light start: surfaces do not shade themselves, and no light comes through closed walls, at any scale,
// place, size of triangle and angle of light. The truth needs no ray: a convex object shades no lit part of itself, and
// a closed one is dark inside.
//
// A ray is decided in float. Its origin lies 16 u C above the surface, u = 2^-24 and C the largest coordinate before
// the camera; why that is enough is derived beside kRoundingPerCoordinate. How low a light may stand over what it
// grazes is derived beside PromiseOf.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "core/image/hash.h"
#include "guidegen/light/direct_light.h"
#include "guidegen/rays/ray_offset.h"
#include "guidegen/surface/bsdf.h"
#include "tests/support/exact_rays.h"
#include "tests/support/light_path_scenes.h"

namespace scumble::testing {
namespace {

constexpr double kScales[] = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6};  // m
constexpr double kPlaces[] = {0.0, 1.0, 1e3, 1e7};  // m from the world's origin
constexpr int kStages = 52;                         // every scale at every place
double ScaleOf(int stage) { return kScales[stage % 13]; }
constexpr double kUnit = 0x1p-24;
const LayerSet kLight = {Layer::kLuminance, Layer::kShadow};

double Chance(int a, int b) { return UnitFloat(Hash(std::uint64_t(a), std::uint64_t(b))); }

glm::dvec3 AnyDirection(int seed) {
  const double z = 2.0 * Chance(seed, 1) - 1.0, angle = 2.0 * kPi * Chance(seed, 2), ring = std::sqrt(1.0 - z * z);
  return {ring * std::cos(angle), ring * std::sin(angle), z};
}

double LongestEdge(const glm::dvec3 (&c)[3]) {
  return std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
}

// Whether a triangle is higher than a float's step is long; lower ones have no inside.
bool IsThere(const glm::dvec3 (&c)[3]) {
  const double longest = LongestEdge(c);
  return glm::length(glm::cross(c[1] - c[0], c[2] - c[0])) > kUnit * longest * longest;
}

// The arithmetic's guarantee for an object seen from `distance` of its sizes.
struct Promise {
  bool height_is_enough = true;
  double lowest_sun = 1e-9;  // radians over any of its triangles
};

// Of the height of 16 u C, 2√3 C are lost to corners and origin, 5 L + 4 L / sine to the triangle's own arithmetic (L
// its longest edge, `sine` the least between two of them; see kRoundingPerCoordinate). What is left must be above 0:
// then Embree finds the origin above the triangle. Which side a sun is on: the direction's part across the triangle is
// off by 1 u (its own rounding), 3 u (the three products with the normal) and 4 u / sine (the normal), so above (4 + 4
// / sine) u the side is right. Below, a ray may seem to come down from what is left of the height, by (4 + 4 / sine) u
// a metre at most: that takes longer than the triangle is where 12.5 C is more than 9 L + 8 L / sine, and then any sun
// will do.
Promise PromiseOf(const Mesh& mesh, double distance) {
  Promise promise;
  for (const glm::uvec3& triangle : mesh.triangles) {
    glm::dvec3 c[3];
    for (int k = 0; k < 3; ++k) c[k] = mesh.positions[triangle[k]];
    if (!IsThere(c)) continue;
    const double longest = LongestEdge(c), area = glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
    double sine = 1.0, from_middle = glm::length(c[0] + c[1] + c[2]) / 3.0;  // of the nearest place that is looked at
    for (int k = 0; k < 3; ++k) {
      from_middle = std::min(from_middle, 0.5 * glm::length(c[k] + c[(k + 1) % 3]));
      sine = std::min(sine, area / (glm::length(c[(k + 1) % 3] - c[k]) * glm::length(c[(k + 2) % 3] - c[k])));
    }
    const double coordinate = distance - from_middle;  // its farthest corner is at least so far
    promise.height_is_enough &= 12.5 * coordinate > 5.0 * longest + 4.0 * longest / sine;
    if (12.5 * coordinate > 9.0 * longest + 8.0 * longest / sine) continue;
    promise.lowest_sun = std::max(promise.lowest_sun, (4.0 + 4.0 / sine) * kUnit);
  }
  return promise;
}

// Every triangle with corners and a normal of its own; those that are not there are left out.
Mesh Faceted(const Mesh& mesh) {
  Mesh result;
  for (const glm::uvec3& triangle : mesh.triangles) {
    glm::dvec3 c[3];
    for (int k = 0; k < 3; ++k) c[k] = mesh.positions[triangle[k]];
    if (!IsThere(c)) continue;
    const glm::dvec3 area = glm::cross(c[1] - c[0], c[2] - c[0]);
    const unsigned first = unsigned(result.positions.size());
    for (const glm::dvec3& corner : c) {
      result.positions.push_back(corner);
      result.normals.push_back(glm::normalize(area));
    }
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

// The square of QuadMesh, cut so that its triangles are the smaller the nearer they are to its middle: sides from 1 to
// 4^-`power` of it.
Mesh GradedSquare(int power) {
  constexpr int kCuts = 16;
  const auto at = [&](int i) {
    const double t = 2.0 * i / kCuts - 1.0;
    return float(std::copysign(std::pow(std::abs(t), power), t));
  };
  Mesh mesh;
  for (int row = 0; row <= kCuts; ++row) {
    for (int column = 0; column <= kCuts; ++column) mesh.positions.push_back({at(column), at(row), 0});
  }
  for (unsigned row = 0; row < kCuts; ++row) {
    for (unsigned column = 0; column < kCuts; ++column) {
      const unsigned a = row * (kCuts + 1) + column, b = a + kCuts + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  }
  return Faceted(mesh);
}

// Two triangles back to back, each `aspect` times as long as high, its third corner near the middle of its long edge.
Mesh FlatCaps(float aspect) {
  Mesh mesh;
  mesh.positions = {{-1, 0, 0}, {1, 0, 0}, {0.1f, 2.0f / aspect, 0}, {0.1f, -2.0f / aspect, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
  return Faceted(mesh);
}

// Two hundred needles from one corner, each 40,000 times as long as wide.
Mesh Needles() {
  Mesh mesh;
  mesh.positions = {{0, -1, 0}};
  for (int i = 0; i <= 200; ++i) mesh.positions.push_back({0.01f * (float(i) / 200.0f - 0.5f), 1, 0});
  for (unsigned i = 1; i <= 200; ++i) mesh.triangles.push_back({0, i + 1, i});
  return Faceted(mesh);
}

Mesh Tetrahedron() {
  Mesh mesh;
  mesh.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  return Faceted(mesh);
}

// A closed tent lying on its side: two of its walls meet at `degrees`.
Mesh Tent(double degrees) {
  const float high = float(2.0 * std::tan(glm::radians(0.5 * degrees)));
  Mesh mesh;
  for (const float z : {-1.0f, 1.0f}) {
    for (const glm::vec3 corner : {glm::vec3(-1, 0, z), {1, -high, z}, {1, high, z}}) mesh.positions.push_back(corner);
  }
  mesh.triangles = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  return Faceted(mesh);
}

// A cube in a slightly larger one.
Mesh ThinWalls(float thickness) {
  Mesh mesh = CubeMesh();
  const Mesh outer = CubeMesh();
  const unsigned first = unsigned(mesh.positions.size());
  for (const glm::vec3& position : outer.positions) mesh.positions.push_back(position * (1.0f + thickness));
  mesh.normals.insert(mesh.normals.end(), outer.normals.begin(), outer.normals.end());
  for (const glm::uvec3& triangle : outer.triangles) mesh.triangles.push_back(triangle + first);
  return mesh;
}

// On one thread: for thousands of small pictures, waking more takes longer than they save.
GuidegenOptions SmallPicture() {
  GuidegenOptions options = Sized(40, 40, kLight);
  options.threads = 1;
  return options;
}

Light SunFrom(const glm::dvec3& direction) {
  glm::dvec3 x, y;
  MakeFrame(direction, x, y);
  Light sun = Above(LightType::kSun, 0.0, 1.0);
  for (int row = 0; row < 3; ++row) {
    sun.world_from_light[0][row] = x[row];
    sun.world_from_light[1][row] = y[row];
    sun.world_from_light[2][row] = direction[row];
  }
  return sun;
}

glm::dmat4 Placed(double scale, const glm::dvec3& place, int turn) {
  const glm::dmat4 turned =
      glm::rotate(glm::translate(glm::dmat4(1.0), place), 6.0 * Chance(turn, 9), AnyDirection(turn + 100));
  return glm::scale(turned, glm::dvec3(scale));
}

glm::dvec3 At(const glm::dmat4& matrix, const glm::dvec3& local) { return glm::dvec3(matrix * glm::dvec4(local, 1.0)); }

struct Named {
  const char* name;
  Mesh mesh;
  bool is_flat = false;
};

std::vector<Named> ConvexThings() {
  return {{"ball of 8 rings", Faceted(BallMesh(8))},
          {"ball of 64 rings", Faceted(BallMesh(64))},
          {"smooth ball", BallMesh(64)},
          {"cube", CubeMesh()},
          {"tetrahedron", Tetrahedron()},
          {"square", QuadMesh(), true},
          {"square, graded", GradedSquare(4), true},
          {"caps 100", FlatCaps(100.0f), true},
          {"caps 1000", FlatCaps(1000.0f), true},
          {"needles", Needles(), true}};
}

struct Stage {
  Scene scene;
  Camera camera;
};

// A thing, suns all about and grazing its XY plane, two lights; a camera `distance` scales away.
Stage LitFromOutside(const Named& thing, double scale, double place, double distance, int turn) {
  const glm::dvec3 middle = AnyDirection(77) * place;
  const glm::dmat4 matrix = Placed(scale, middle, turn);
  Stage stage{SceneOf(thing.mesh, matrix), {}};
  const glm::dvec3 up = glm::normalize(glm::dvec3(matrix[2]));
  glm::dvec3 x, y;
  MakeFrame(up, x, y);
  for (int i = 0; i < 4; ++i) stage.scene.lights.push_back(SunFrom(AnyDirection(1000 * turn + i)));
  const double lowest = PromiseOf(thing.mesh, distance).lowest_sun;
  for (const double wanted : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0.0}) {
    const double elevation = std::max(wanted, lowest);
    const double azimuth = 2.0 * kPi * Chance(turn, int(1e7 * wanted));
    const glm::dvec3 along = x * std::cos(azimuth) + y * std::sin(azimuth);
    stage.scene.lights.push_back(SunFrom(along * std::cos(elevation) + up * std::sin(elevation)));
  }
  for (const double away : {3.0, 20.0}) {
    const glm::dvec3 lamp = middle + AnyDirection(31 * turn + int(away)) * (away * scale);
    stage.scene.lights.push_back(PointLight(lamp, scale * scale));
  }
  const glm::dvec3 view =
      glm::normalize(up * (0.1 + Chance(turn, 4)) + x * (Chance(turn, 5) - 0.5) + y * (Chance(turn, 6) - 0.5));
  stage.camera = LookingAt(middle + view * (distance * scale), middle, glm::degrees(2.0 * std::atan(1.3 / distance)));
  return stage;
}

struct Count {
  std::size_t rays = 0;   // towards lights
  std::size_t wrong = 0;  // pixels

  void Add(const GuidegenResult& result, Layer layer) {
    rays += result.rays.shadow;
    for (const float value : result.guides.Plane(layer)) wrong += value != 0.0f;
  }
};

// Expected: not one. A light above a convex thing's facet has nothing in its way, so `shadow` is 0 to the last bit:
// both of its sums hold the same terms in the same order. Slivers seen from so near that the height is not enough for
// them by the formula get no promise, and are counted by themselves; of them, too, none is met. From 1000 sizes away
// only what is flat: of the others the silhouettes are then float's to choose.
TEST(SelfShadow, ConvexThingsDoNotShadeThemselves) {
  std::size_t rays = 0;
  for (const Named& thing : ConvexThings()) {
    for (const double distance : {4.0, 100.0, 1000.0}) {
      if (distance == 1000.0 && !thing.is_flat) continue;
      Count count;
      for (int turn = 0; turn < kStages; ++turn) {
        const double scale = ScaleOf(turn);
        Stage stage = LitFromOutside(thing, scale, kPlaces[turn % 4], distance, turn);
        count.Add(Render(stage.scene, stage.camera, SmallPicture()), Layer::kShadow);
        stage.camera.orthographic = true;
        stage.camera.ymag = 1.3 * scale;
        count.Add(Render(stage.scene, stage.camera, SmallPicture()), Layer::kShadow);
      }
      if (!PromiseOf(thing.mesh, distance).height_is_enough) {
        EXPECT_EQ(count.wrong, 0u) << thing.name << " from " << distance << " sizes, " << count.rays << " rays";
        RecordProperty(std::string(thing.name) + " from " + std::to_string(int(distance)),
                       std::to_string(count.wrong) + " of " + std::to_string(count.rays));
        continue;
      }
      EXPECT_EQ(count.wrong, 0u) << thing.name << " from " << distance << " sizes, " << count.rays << " rays";
      rays += count.rays;
    }
  }
  EXPECT_GT(rays, 4'000'000u);
  RecordProperty("rays", std::to_string(rays));
}

// From so far that a float's step is a visible part of the thing, the picture's own silhouettes are float's to choose;
// a false shadow is one where the plain caster in double is sure which facet is seen. Expected: none of those.
TEST(SelfShadow, FromAfarOnlySilhouettesAreUndecided) {
  std::size_t rays = 0, undecided = 0;
  for (const Named& thing : {Named{"cube", CubeMesh()}, Named{"tetrahedron", Tetrahedron()}}) {
    for (const double distance : {1e4, 1e5}) {
      for (const double scale : {1e-3, 1.0, 1e3}) {
        for (const int turn : {0, 1, 2}) {
          Stage stage = LitFromOutside(thing, scale, 1e3, distance, turn);
          stage.camera.orthographic = true;
          stage.camera.ymag = 1.3 * scale;
          const auto result = Render(stage.scene, stage.camera, Sized(48, 48, kLight));
          rays += result.rays.shadow;
          for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 48; ++x) {
              if (result.guides.Plane(Layer::kShadow)[result.guides.Index(x, y)] == 0.0f) continue;
              const ExactRay ray = PixelRay(stage.camera, 48, 48, x, y);
              EXPECT_TRUE(MeetExactly(stage.scene, stage.camera, ray).Undecided()) << x << ", " << y;
              ++undecided;
            }
          }
        }
      }
    }
  }
  EXPECT_GT(rays, 200'000u);
  RecordProperty("rays", std::to_string(rays));
  RecordProperty("undecided", std::to_string(undecided));
}

// --- What lies on a ground ------------------------------------------------------------------------------------------

constexpr int kTurns = 12;
constexpr double kEyeToSquare = 4.0;  // m

// A square of 2 m in the middle of a ground `width` times as wide, or `gap` metres above it; suns and lights overhead
// and slanted. The eye looks down on it at an angle, and all is turned, so that corners have every digit.
Stage SquareOnAGround(double width, double gap, int turn) {
  const glm::dmat4 matrix = Placed(1.0, glm::dvec3(0.0), turn);
  const glm::dvec3 x(matrix[0]), y(matrix[1]), up(matrix[2]);
  Stage stage{SceneOf(QuadMesh(), glm::scale(matrix, glm::dvec3(width, width, 1.0))), {}};
  AddObject(stage.scene, "square", QuadMesh(), glm::translate(glm::dmat4(1.0), up * gap) * matrix);
  for (const double degrees : {90.0, 45.0, 10.0}) {
    const double elevation = glm::radians(degrees);
    const glm::dvec3 direction = y * std::cos(elevation) + up * std::sin(elevation);
    stage.scene.lights.push_back(SunFrom(direction));
    stage.scene.lights.push_back(PointLight(direction * 5.0, 25.0));
  }
  const glm::dvec3 view = glm::normalize(up + x * 0.8 + y * 0.3);
  stage.camera = LookingAt(view * kEyeToSquare, glm::dvec3(0.0), 40.0);
  return stage;
}

// By how much float may raise that ground under a ray, and no more, as derived beside kRoundingPerCoordinate: its
// corners are √2 `width` from the middle, its longest edge is 2√2 `width`, and the least sine √½.
double RoundingOfGround(double width) {
  const double coordinate = std::sqrt(2.0) * width + kEyeToSquare, longest = 2.0 * std::sqrt(2.0) * width;
  return kUnit * (2.0 * std::sqrt(3.0) * coordinate + 5.0 * longest + 4.0 * std::sqrt(2.0) * longest);
}

struct GroundCount {
  std::size_t rays = 0;          // towards lights
  std::size_t seen = 0;          // pixels that show the square
  std::size_t wrong = 0;         // of those, in a shadow
  std::size_t wrong_beside = 0;  // pixels of the ground in a shadow that is none of the square's

  std::string ToString() const {
    return std::to_string(wrong) + " of " + std::to_string(seen) + " pixels, beside it " + std::to_string(wrong_beside);
  }
};

// Nothing stands above the square, so every shadow on it is false. Its own falls on the ground: where it is no more
// than 1 mm high, and no light is lower than 10 degrees, no farther than 6 mm.
void CountShadows(const Stage& stage, GroundCount& count) {
  GuidegenOptions options = SmallPicture();
  options.layers.Add(Layer::kPosition);
  const auto result = Render(stage.scene, stage.camera, options);
  const float square = float(IdsForNames(std::vector<std::string>{"thing", "square"})[1]);
  const glm::dmat4 square_from_world = glm::inverse(stage.scene.instances[1].world_from_object);
  count.rays += result.rays.shadow;
  for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
    const bool on_square = result.guides.Plane(Layer::kObject)[i] == square;
    const bool shaded = result.guides.Plane(Layer::kShadow)[i] != 0.0f;
    const glm::dvec3 at = At(square_from_world, glm::dvec3(result.guides.Vec3(Layer::kPosition, i)));
    const bool beside = std::max(std::abs(at.x), std::abs(at.y)) > 1.01;
    count.seen += on_square;
    count.wrong += shaded && on_square;
    count.wrong_beside += shaded && !on_square && beside;
  }
}

// A ray of light from the square starts above the square by the square's own height, while float may raise the ground
// by the ground's rounding, which is the larger the larger the ground is. Where the square lies higher than that
// rounding the ground stays below. Expected: every picture shows the square, all of it lit.
TEST(SelfShadow, WhatLiesHigherThanAGroundsRoundingIsNotShadedByIt) {
  for (const double width : {10.0, 1e2, 1e3, 1e4, 1e5}) {
    GroundCount count;
    for (const double times : {1.0, 2.0}) {
      for (int turn = 0; turn < kTurns; ++turn) {
        CountShadows(SquareOnAGround(width, times * RoundingOfGround(width), turn), count);
      }
    }
    EXPECT_EQ(count.wrong, 0u) << "a ground " << width << " times as wide: " << count.ToString();
    EXPECT_GT(count.seen, 2u * kTurns * 400u) << width;  // the square is a third of the picture
  }
}

// The square in the ground itself, and so low above it that rounding may be larger: a decal. Float chooses whether it
// shows the square or the ground there, but nothing blocks any light. Expected: no shadow.
TEST(SelfShadow, WhatLiesInAGroundIsNotShadedByIt) {
  for (const double width : {10.0, 30.0, 1e2, 1e3, 1e4, 1e5}) {
    for (const double gap : {0.0, 1e-6, 1e-5, 1e-4, 1e-3}) {
      GroundCount count;
      for (int turn = 0; turn < kTurns; ++turn) CountShadows(SquareOnAGround(width, gap, turn), count);
      EXPECT_EQ(count.wrong + count.wrong_beside, 0u)
          << "a ground " << width << " times as wide, " << gap << " m below: " << count.ToString();
      EXPECT_GT(count.rays, kTurns * 1600u * 4u);
      std::printf("a square on a ground %g times as wide, %g m above it: in false shadow %s\n", width, gap,
                  count.ToString().c_str());
    }
  }
}

std::vector<Named> ClosedThings() {
  return {{"cube", CubeMesh()},
          {"walls of 0.1", ThinWalls(0.1f)},
          {"walls of 1e-5", ThinWalls(1e-5f)},
          {"ball", Faceted(BallMesh(64))},
          {"smooth ball", BallMesh(64)},
          {"tetrahedron", Tetrahedron()},
          {"tent of 20 degrees", Tent(20.0)},
          {"tent of 2 degrees", Tent(2.0)}};
}

// An eye inside a closed thing looks at one of its corners from near and from afar, down to a tenth of a degree.
Stage SeenFromInside(const Mesh& mesh, double scale, double place, int turn, double share, double degrees) {
  const glm::dvec3 middle = AnyDirection(77) * place;
  const glm::dmat4 matrix = Placed(scale, middle, turn);
  Stage stage{SceneOf(mesh, matrix), {}};
  for (int i = 0; i < 6; ++i) stage.scene.lights.push_back(SunFrom(AnyDirection(1000 * turn + i)));
  for (const double away : {4.0, 20.0}) {
    const glm::dvec3 lamp = middle + AnyDirection(31 * turn + int(away)) * (away * scale);
    stage.scene.lights.push_back(PointLight(lamp, scale * scale));
  }
  const glm::dvec3 corner(mesh.positions[std::size_t(turn) * 5 % mesh.positions.size()]);
  stage.camera = LookingAt(At(matrix, corner * share), At(matrix, corner), degrees);
  return stage;
}

// Seen from within: the walls turn their faces to the eye.
Mesh Inward(Mesh mesh) {
  for (glm::uvec3& triangle : mesh.triangles) std::swap(triangle.y, triangle.z);
  for (glm::vec3& normal : mesh.normals) normal = -normal;
  return mesh;
}

// What the sides of surfaces may do to rays that only meet fronts: nothing here, where only fronts are seen.
enum class Sides { kDouble, kDoubleBesideASingle, kSingle };

Stage OfSides(const Mesh& mesh, Sides sides, double scale, double place, int turn, double share, double degrees) {
  Stage stage = SeenFromInside(sides == Sides::kSingle ? Inward(mesh) : mesh, scale, place, turn, share, degrees);
  stage.scene.materials[0].double_sided = sides != Sides::kSingle;
  if (sides == Sides::kDoubleBesideASingle) {
    Mesh far = QuadMesh();
    Material single;
    single.double_sided = false;
    far.material = AddMaterial(stage.scene, single);
    const glm::dvec3 away = AnyDirection(77) * place + glm::dvec3(500.0 * scale, 0.0, 0.0);
    AddObject(stage.scene, "far", far, glm::scale(glm::translate(glm::dmat4(1.0), away), glm::dvec3(scale)));
  }
  return stage;
}

// Expected: not one lit pixel. Every way out crosses a wall. Light hits both sides of single-sided walls, and far
// objects, whatever their sides, have no effect.
TEST(LightLeaks, ClosedThingsAreDarkInside) {
  for (const Sides sides : {Sides::kDouble, Sides::kDoubleBesideASingle, Sides::kSingle}) {
    std::size_t rays = 0;
    for (const Named& thing : ClosedThings()) {
      Count count;
      for (int turn = 0; turn < kStages; ++turn) {
        for (const double degrees : {100.0, 5.0, 0.1}) {
          if (sides != Sides::kDouble && degrees != 5.0) continue;  // where the most light came in
          const double share = turn % 2 == 0 ? 0.0 : 0.9;
          const Stage stage = OfSides(thing.mesh, sides, ScaleOf(turn), kPlaces[turn % 4], turn, share, degrees);
          count.Add(Render(stage.scene, stage.camera, SmallPicture()), Layer::kLuminance);
        }
      }
      EXPECT_EQ(count.wrong, 0u) << thing.name << ", sides " << int(sides) << ", " << count.rays << " rays";
      rays += count.rays;
    }
    EXPECT_GT(rays, 2'000'000u) << int(sides);
    RecordProperty("rays_" + std::to_string(int(sides)), std::to_string(rays));
  }
}

GuidegenResult PathsInside(const Named& thing, Sides sides, double scale, int turn) {
  Stage stage = OfSides(thing.mesh, sides, scale, 1e7, turn, 0.5, 60.0);
  const bool double_sided = stage.scene.materials[0].double_sided;
  stage.scene.materials[0] = Painted(Bsdf::kMetallicRoughness, 0.9f, 0.3f);
  stage.scene.materials[0].double_sided = double_sided;
  stage.scene.world_radiance = glm::vec3(1.0f);
  return Render(stage.scene, stage.camera, Paths(24, {Layer::kLpeFull}, 8));
}

std::size_t LitPixels(const GuidegenResult& result) {
  std::size_t lit = 0;
  for (const float value : result.guides.Plane(Layer::kLpeFull, 1)) lit += value != 0.0f;
  return lit;
}

// The same for paths: a reflection continues from its hit, however flat it came in. Each of the 576 pixels sends 8
// paths, and each path at least one ray to a light or onward.
TEST(LightLeaks, NoPathFindsAWayOut) {
  for (const Sides sides : {Sides::kDouble, Sides::kDoubleBesideASingle, Sides::kSingle}) {
    for (const Named& thing : ClosedThings()) {
      for (const double scale : {1e-6, 1.0, 1e6}) {
        for (const int turn : {1, 2}) {
          if (sides != Sides::kDouble && turn == 2) continue;
          const auto result = PathsInside(thing, sides, scale, turn);
          EXPECT_EQ(LitPixels(result), 0u) << thing.name << ", " << scale << " m, sides " << int(sides);
          EXPECT_GE(result.rays.shadow + result.rays.bounce, 576u * 8u) << thing.name << ", " << scale << " m";
        }
      }
    }
  }
}

// What they would find: without the wall at +Z, straight ahead of half the pictures, the sky's light comes in.
TEST(LightLeaks, PathsFindTheWayOutOfAnOpenBox) {
  Mesh open = CubeMesh();
  open.triangles.resize(open.triangles.size() - 2);
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (const int turn : {1, 2}) EXPECT_GT(LitPixels(PathsInside({"open", open}, Sides::kDouble, scale, turn)), 250u);
  }
}

// A box whose near walls are cut away for the viewer still keeps the light out. Here the way back to the eye is clear
// as far as halfway to the last wall that it passes, and the rest of the height h = 2^-20 C goes straight up.
// Expected: no lit pixel but beside a second wall. The origin is past that wall only where half of the distance to it
// is less than what goes straight up and the wall's own rounding, h each: where the pixel is within 4 h of it. From a
// million sizes away that is more than the box, and nothing is promised.
TEST(LightLeaks, CutAwayWallsKeepTheLightOut) {
  const Mesh inward = Inward(CubeMesh());
  for (const double distance : {3.0, 10.0, 100.0, 1e4}) {
    std::size_t rays = 0, lit = 0;
    for (int turn = 0; turn < kStages; ++turn) {
      const double scale = ScaleOf(turn);
      const glm::dmat4 matrix = Placed(scale, glm::dvec3(0.0), turn);
      Stage stage = SeenFromInside(inward, scale, 0.0, turn, 0.5, 60.0);
      stage.scene.materials[0].double_sided = false;
      stage.camera = LookingAt(AnyDirection(turn + 7) * (distance * scale), glm::dvec3(0.0),
                               glm::degrees(2.0 * std::atan(1.6 / distance)));
      LayerSet layers = kLight;
      const auto result = Render(stage.scene, stage.camera, Sized(64, 64, layers.Add(Layer::kPosition)));
      rays += result.rays.shadow;
      for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
        if (result.guides.Plane(Layer::kLuminance)[i] == 0.0f) continue;
        ++lit;
        const glm::dvec3 local = At(glm::inverse(matrix), glm::dvec3(result.guides.Vec3(Layer::kPosition, i)));
        double off[3];
        for (int axis = 0; axis < 3; ++axis) off[axis] = std::abs(1.0 - std::abs(local[axis]));
        std::sort(off, off + 3);
        EXPECT_LE(off[1], (distance + std::sqrt(3.0)) * 0x1p-18);
      }
    }
    EXPECT_GT(rays, 50'000u) << "from " << distance << " sizes";
    RecordProperty("lit_from_" + std::to_string(int(distance)), std::to_string(lit) + " by " + std::to_string(rays));
  }
}

// What the counts above would say if nothing cast a shadow, or everything did.
TEST(LightLeaks, AnOpenBoxIsLitAndALidClosesIt) {
  Mesh open = CubeMesh();
  open.triangles.resize(open.triangles.size() - 2);  // the wall at +Z is the last
  for (const double scale : kScales) {
    for (const bool lid : {false, true}) {
      Scene scene = SceneOf(open, glm::scale(glm::dmat4(1.0), glm::dvec3(scale)));
      if (lid) AddObject(scene, "lid", QuadMesh(), glm::scale(Moved(0, 0, scale), glm::dvec3(scale)));
      scene.lights = {SunFrom({0, 0, 1})};
      const Camera camera = LookingAt({0, -0.5 * scale, 0}, {0, 0, -scale}, 30.0);
      const auto result = Render(scene, camera, Sized(16, 16, kLight));
      for (std::size_t i = 0; i < 256; ++i) {
        EXPECT_EQ(result.guides.Plane(Layer::kShadow)[i], lid ? 1.0f : 0.0f);
        EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[i], lid ? 0.0 : 1.0 / kPi, 0x1p-26);  // half a float's step
      }
    }
  }
}

// Height above the plane, by its definition, to double's rounding of the coordinates themselves.
TEST(ShadowRayOrigin, StandsAtItsHeightOnTheRayOffset) {
  for (const double coordinate : {1e-3, 1.0, 1e7}) {
    SurfacePoint point;
    point.position = glm::dvec3(0.3, -0.2, -0.9) * coordinate;
    point.facing = glm::normalize(glm::dvec3(1, 2, 3));
    point.largest_coordinate = coordinate;
    const double height = coordinate * kRoundingPerCoordinate, rounding = std::ldexp(coordinate, -50);
    const auto up = [&] { return glm::dot(ShadowRayOrigin(point) - point.position, point.facing); };
    EXPECT_NEAR(up(), height, rounding);
    glm::dvec3 x, y;
    MakeFrame(point.facing, x, y);
    for (const double cosine : {1.0, 0.5, 0.02}) {
      const glm::dvec3 way = point.facing * cosine + x * std::sqrt(1.0 - cosine * cosine);
      point.max_ray_offset = way * (2.0 * coordinate);
      EXPECT_NEAR(up(), height, rounding) << cosine;
      const glm::dvec3 moved = ShadowRayOrigin(point) - point.position;
      EXPECT_LE(glm::length(moved - way * (height / cosine)), 2.0 * rounding) << cosine;
    }
    // Flatter, and with less room than that: at the same height still, never past where the ray came from.
    point.max_ray_offset = x * coordinate;
    EXPECT_NEAR(up(), height, rounding);
    point.max_ray_offset = point.facing * (0.25 * height);
    EXPECT_NEAR(up(), height, rounding);
  }
}

}  // namespace
}  // namespace scumble::testing
