// No light comes in through closed walls, at any scale, place and size of triangle. The truth needs no ray: a closed
// object is dark inside.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "tests/guidegen/light/self_shadow_scenes.h"
#include "tests/support/light_path_scenes.h"

namespace scumble::testing {
namespace {

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

}  // namespace
}  // namespace scumble::testing
