// Surveyors' coordinates in a file that also lists a vertex at 0: vertices outside all faces have no effect, and
// objects too far apart for one origin have several. Scenes far from the origin but at one place are in
// extreme_place_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "guidegen/framing.h"
#include "guidegen/load_scene.h"
#include "tests/support/exact_rays.h"
#include "tests/support/guidegen_scenes.h"
#include "tests/support/temporary_folder.h"

namespace scumble::testing {
namespace {

using Places = std::vector<glm::dvec3>;

// A place in a UTM zone. Floats step by 1/32 m there to the east and by 0.5 m to the north.
constexpr double kEast = 5e5, kNorth = 5e6;

Places WallAt(double x, double y) {
  return {
      {x - 0.95, y - 1.05, 0.25}, {x + 1.05, y - 1.05, 0.25}, {x + 1.05, y + 0.95, 0.25}, {x - 0.95, y + 0.95, 0.25}};
}

std::string Words(const glm::dvec3& v) {
  return std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
}

// One face of all corners.
std::string ObjObject(const std::string& name, const Places& corners, const std::string& color = "") {
  std::string text = "o " + name + "\n", face = "f";
  for (std::size_t i = 0; i < corners.size(); ++i) {
    text += "v " + Words(corners[i]) + color + "\n";
    face += " " + std::to_string(int(i) - int(corners.size()));
  }
  return text + face + "\n";
}

// One face of all corners, behind a vertex that nothing uses.
std::string Ply(const Places& corners, const std::string& unused = "0 0 0") {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(corners.size() + 1) +
                     "\nproperty double x\nproperty double y\nproperty double z\nelement face 1\n" +
                     "property list uchar int vertex_indices\nend_header\n" + unused + "\n";
  std::string face = std::to_string(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    text += Words(corners[i]) + "\n";
    face += " " + std::to_string(i + 1);
  }
  return text + face + "\n";
}

const Instance& Find(const Scene& scene, const std::string& object) {
  const auto is_it = [&](const Instance& instance) { return instance.object == object; };
  return *std::find_if(scene.instances.begin(), scene.instances.end(), is_it);
}

const Mesh& MeshOf(const Scene& scene, const std::string& object) {
  return scene.meshes[std::size_t(Find(scene, object).mesh)];
}

glm::dvec3 OriginIn(const Scene& scene, const std::string& object) {
  return glm::dvec3(Find(scene, object).world_from_object[3]);
}

// Each place is a corner of the object. What is stored is the place relative to the object's origin, rounded to a float
// once: 2^-24 of it. Reading the digits and subtracting leave a few roundings of a double, 2^-49 of the place.
void ExpectCorners(const Scene& scene, const std::string& object, const Places& places) {
  const glm::dvec3 origin = OriginIn(scene, object);
  for (const glm::dvec3& place : places) {
    const auto is_there = [&](const glm::vec3& position) {
      for (int axis = 0; axis < 3; ++axis) {
        const double from_origin = place[axis] - origin[axis];
        const double bound = std::abs(from_origin) * 0x1p-24 + std::abs(place[axis]) * 0x1p-49;
        if (!(std::abs(double(position[axis]) - from_origin) <= bound)) return false;
      }
      return true;
    };
    const std::vector<glm::vec3>& positions = MeshOf(scene, object).positions;
    EXPECT_TRUE(std::any_of(positions.begin(), positions.end(), is_there)) << object << ": " << Words(place);
  }
}

class ExtremeSurvey : public ::testing::Test {
 protected:
  Scene Load(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    Expected<Scene> scene = LoadScene(folder_ / name);
    EXPECT_TRUE(scene.ok()) << scene.error().message;
    return scene ? std::move(*scene) : Scene{};
  }

  // The wall, relative to its own middle in whole metres, and seen as it stands.
  static void ExpectWall(const Scene& scene) {
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(OriginIn(scene, "wall"), glm::dvec3(kEast, kNorth, 0.0));
    ExpectCorners(scene, "wall", WallAt(kEast, kNorth));
    for (const glm::uvec3& triangle : scene.meshes[0].triangles) {
      for (int i = 0; i < 3; ++i) EXPECT_EQ(scene.meshes[0].normals[triangle[i]], glm::vec3(0, 0, 1));
    }
    const Camera camera = LookingAt({kEast + 1, kNorth, 4}, {kEast, kNorth, 0});
    EXPECT_GT(ExpectExactGuides(scene, camera, 30, 30).covered, 300);
  }

 private:
  const TemporaryFolder folder_;
};

TEST_F(ExtremeSurvey, ObjVerticesThatNoFaceUsesMoveNothing) {
  ExpectWall(Load("wall.obj", "v 0 0 0\n" + ObjObject("wall", WallAt(kEast, kNorth))));
}

// All vertices of a mesh are framed. The wall's bounding sphere has a radius of 1.42 m, so that it fills the view from
// 5.2 m; with a vertex left at 0 the camera would stand 9000 km away.
TEST_F(ExtremeSurvey, PlyVerticesThatNoFaceUsesMoveNothing) {
  const Scene scene = Load("wall.ply", Ply(WallAt(kEast, kNorth)));
  ExpectWall(scene);
  const Camera camera = FramingCamera(scene, ViewAngles{}, 1.0);
  EXPECT_LT(glm::length(glm::dvec3(camera.world_from_camera[3]) - glm::dvec3(kEast, kNorth, 0.25)), 6.0);
}

// An arrowhead of 0.4 m: the one way to cut it is from its tip to its notch, into two triangles of 0.03 m². A fan from
// the first corner covers the notch. Corners are off by 0.4 m · 2^-24, so twice an area is off by less than 1e-6.
TEST_F(ExtremeSurvey, PlyPolygonsAreCutAsTheirCornersStand) {
  Places arrow = {{0, 0, 0}, {0.4, 0.2, 0}, {0, 0.4, 0}, {0.1, 0.2, 0}};
  for (glm::dvec3& corner : arrow) corner += glm::dvec3(kEast, kNorth, 1.0);
  const Scene scene = Load("arrow.ply", Ply(arrow));
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.meshes[0].triangles.size(), 2u);
  const std::vector<glm::vec3>& positions = scene.meshes[0].positions;
  for (const glm::uvec3& triangle : scene.meshes[0].triangles) {
    const glm::dvec3 a(positions[triangle.x]), b(positions[triangle.y]), c(positions[triangle.z]);
    EXPECT_NEAR(glm::cross(b - a, c - a).z, 0.06, 1e-6);
  }
}

// Two walls that meet at right angles, 5000 km from a stone at 0 and 4000 km from a tower, in an order that parts them.
// The walls share an origin, and so a smooth edge. The stone has a corner at the numbers that a corner of theirs has
// relative to that origin, and its normals are its own all the same.
TEST_F(ExtremeSurvey, ObjObjectsTooFarApartHaveOriginsOfTheirOwn) {
  const Places wall = WallAt(kEast, kNorth),
               tower = WallAt(kEast + 1.0, kNorth - 1e6);  // between the others in the order of places
  const double x = kEast + 1.05;
  const Places wing = {
      {x, kNorth - 1.05, 0.25}, {x, kNorth - 1.05, -1.75}, {x, kNorth + 0.95, -1.75}, {x, kNorth + 0.95, 0.25}};
  const Places stone = {{1.05, 0.95, 0.25}, {1.05, 1.95, 0.25}, {1.05, 0.95, 1.25}};
  const Scene scene =
      Load("site.obj", "s 1\n" + ObjObject("wall", wall, " 1 0 0") + ObjObject("tower", tower, " 1 1 0") +
                           ObjObject("stone", stone, " 0 0 1") + ObjObject("wing", wing, " 0 1 0"));
  ASSERT_EQ(scene.instances.size(), 4u);
  EXPECT_EQ(OriginIn(scene, "wall"), glm::dvec3(kEast, kNorth, 0.0));
  EXPECT_EQ(OriginIn(scene, "wing"), OriginIn(scene, "wall"));
  EXPECT_EQ(OriginIn(scene, "tower"), glm::dvec3(kEast + 1.0, kNorth - 1e6, 0.0));
  EXPECT_EQ(Find(scene, "stone").world_from_object, glm::dmat4(1.0));
  ExpectCorners(scene, "wall", wall);
  ExpectCorners(scene, "wing", wing);
  ExpectCorners(scene, "tower", tower);
  ExpectCorners(scene, "stone", stone);
  EXPECT_EQ(MeshOf(scene, "wall").colors[0], glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(MeshOf(scene, "wing").colors[0], glm::vec4(0, 1, 0, 1));
  EXPECT_EQ(MeshOf(scene, "tower").colors[0], glm::vec4(1, 1, 0, 1));
  for (const glm::vec3& normal : MeshOf(scene, "stone").normals) EXPECT_EQ(normal, glm::vec3(1, 0, 0));
  // At the edge each wall has 90° of a corner: the two directions count alike.
  int at_edge = 0;
  for (const char* object : {"wall", "wing"}) {
    const Mesh& mesh = MeshOf(scene, object);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      if (mesh.positions[i].x < 1.0f || mesh.positions[i].z < 0.0f) continue;
      ++at_edge;
      EXPECT_NEAR(mesh.normals[i].x, std::sqrt(0.5), 1e-6);
      EXPECT_NEAR(mesh.normals[i].z, std::sqrt(0.5), 1e-6);
    }
  }
  EXPECT_EQ(at_edge, 4);
}

// A pebble on a meadow, and a handle in a house whose unit is the millimetre: small beside their distance from 0, but
// in ordinary files, which stand at 0 as they always did. Alone, the pebble is all of its file.
TEST_F(ExtremeSurvey, OrdinaryObjFilesKeepOneOrigin) {
  const auto square = [](double x, double half) -> Places {
    return {{x - half, -half, 0}, {x + half, -half, 0}, {x + half, half, 0}, {x - half, half, 0}};
  };
  const auto expect_at_0 = [](const Scene& scene, const Places& large, const Places& small) {
    ASSERT_EQ(scene.instances.size(), 2u);
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(scene.instances[i].world_from_object, glm::dmat4(1.0));
      EXPECT_EQ(scene.meshes[i].positions[0], glm::vec3((i == 0 ? large : small)[0]));
    }
  };
  const Places meadow = square(0, 50), pebble = square(40, 0.25);
  const Places house = square(30000, 30000), handle = square(50000, 50);
  expect_at_0(Load("meadow.obj", ObjObject("meadow", meadow) + ObjObject("pebble", pebble)), meadow, pebble);
  expect_at_0(Load("house.obj", ObjObject("house", house) + ObjObject("handle", handle)), house, handle);
  EXPECT_EQ(OriginIn(Load("pebble.obj", ObjObject("pebble", pebble)), "pebble"), glm::dvec3(40, 0, 0));
}

// From the shape at one end of float's range to the unused vertex at the other is more than a float can say.
TEST_F(ExtremeSurvey, PlyVerticesThatNoFaceUsesStayFinite) {
  const Scene scene = Load("ends.ply", Ply({{3e38, 0, 0}, {3.01e38, 0, 0}, {3e38, 1e36, 0}}, "-3e38 0 0"));
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_GT(OriginIn(scene, "ends").x, 1e38);
  for (const glm::vec3& position : scene.meshes[0].positions) EXPECT_TRUE(std::isfinite(position.x)) << position.x;
}

}  // namespace
}  // namespace scumble::testing
