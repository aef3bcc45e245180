// Code that all scene loaders share, and the simple formats: normals, polygons, OBJ, PLY, framing.
#include "guidegen/load_scene.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/image/color.h"
#include "core/io/picture_file.h"
#include "guidegen/framing.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/load/mesh_normals.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/numbers.h"

namespace scumble {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class LoadText : public LoaderTest {
 protected:
  Scene Load(const std::string& name, const std::string& text) {
    Expected<Scene> scene = LoadScene(Write(name, text));
    EXPECT_TRUE(scene.ok()) << scene.error().message;
    return scene ? std::move(*scene) : Scene{};
  }
};

void ExpectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

// The cube from -1 to 1. Each bit of `diagonals` chooses the diagonal along which a face is cut.
Mesh Cube(unsigned diagonals) {
  Mesh mesh;
  for (unsigned i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  const unsigned faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (unsigned f = 0; f < 6; ++f) {
    const unsigned turn = diagonals >> f & 1;
    const auto at = [&](unsigned i) { return faces[f][(i + turn) % 4]; };
    mesh.triangles.emplace_back(at(0), at(1), at(2));
    mesh.triangles.emplace_back(at(0), at(2), at(3));
  }
  return mesh;
}

TEST(MeshNormals, ACubeDoesNotDependOnItsDiagonals) {
  for (unsigned diagonals = 0; diagonals < 64; ++diagonals) {
    Mesh mesh = Cube(diagonals);
    EXPECT_EQ(FillNormals(mesh), 0u);
    for (std::size_t i = 0; i < 8; ++i) {
      ExpectNear(mesh.normals[i], glm::dvec3(mesh.positions[i]) / std::sqrt(3.0), 1e-6);
    }
  }
}

TEST(MeshNormals, ASphereWithASeamIsSmooth) {
  // Latitude and longitude, with the first meridian there twice and the poles once for every meridian.
  constexpr int kColumns = 48, kRows = 24;
  Mesh mesh;
  for (int r = 0; r <= kRows; ++r) {
    for (int c = 0; c <= kColumns; ++c) {
      const double theta = kPi * r / kRows, phi = 2 * kPi * (c % kColumns) / kColumns;
      const double ring = r == 0 || r == kRows ? 0.0 : std::sin(theta);
      mesh.positions.emplace_back(ring * std::sin(phi), std::cos(theta), ring * std::cos(phi));
    }
  }
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      const unsigned a = r * (kColumns + 1) + c, b = a + kColumns + 1;
      mesh.triangles.emplace_back(a, b, b + 1);
      mesh.triangles.emplace_back(a, b + 1, a + 1);
    }
  }
  FillNormals(mesh);
  double worst = 0.0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const double cosine = glm::dot(glm::dvec3(mesh.normals[i]), glm::normalize(glm::dvec3(mesh.positions[i])));
    worst = std::max(worst, std::acos(std::min(cosine, 1.0)));
    EXPECT_NEAR(glm::length(mesh.normals[i]), 1.0f, 1e-6f);
  }
  EXPECT_LT(worst * 180.0 / kPi, 0.5);
  EXPECT_EQ(mesh.normals[0], mesh.normals[7]);
}

TEST(MeshNormals, DegenerateMeshesGetUnitNormals) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 5, 5}};
  mesh.triangles = {{0, 1, 2}, {1, 1, 1}};
  FillNormals(mesh);
  for (const glm::vec3& normal : mesh.normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
  // A sheet with both sides modelled: each side keeps its own.
  Mesh sheet;
  sheet.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {3, 5, 4}};
  FillNormals(sheet);
  EXPECT_EQ(sheet.normals[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(sheet.normals[4], glm::vec3(0, 0, -1));
  // Extreme sizes stay finite.
  for (const float scale : {1e-18f, 1e18f}) {
    Mesh cube = Cube(0);
    for (glm::vec3& p : cube.positions) p *= scale;
    FillNormals(cube);
    for (const glm::vec3& normal : cube.normals) EXPECT_NEAR(glm::length(normal), 1.0f, 1e-5f);
  }
}

double Area(const std::vector<glm::vec3>& p, const std::vector<glm::uvec3>& triangles) {
  double area = 0.0;
  for (const glm::uvec3& t : triangles) area += 0.5 * glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]).z;
  return area;
}

TEST(Polygons, ConcaveOnesAreCoveredOnce) {
  // A U: a fan from any corner would cover its notch.
  std::vector<glm::vec3> u = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
  for (std::size_t start = 0; start < u.size(); ++start) {
    std::vector<glm::uvec3> triangles;
    TriangulatePolygon(u, triangles);
    ASSERT_EQ(triangles.size(), 6u);
    EXPECT_NEAR(Area(u, triangles), 7.0, 1e-6);
    for (const glm::uvec3& t : triangles) EXPECT_GT(Area(u, {t}), 0.0);
    std::rotate(u.begin(), u.begin() + 1, u.end());
  }
  std::reverse(u.begin(), u.end());
  std::vector<glm::uvec3> triangles;
  TriangulatePolygon(u, triangles);
  EXPECT_NEAR(Area(u, triangles), -7.0, 1e-6);
  // Without area there is still a triangle for all but two corners, and no endless loop.
  for (std::size_t corners : {4u, 100u, 5000u}) {
    triangles.clear();
    TriangulatePolygon(std::vector<glm::vec3>(corners, glm::vec3(1.0f)), triangles);
    EXPECT_EQ(triangles.size(), corners - 2);
  }
}

TEST_F(LoadText, ObjShapesAndMaterials) {
  Picture picture(1, 1);
  picture.rgba = {65535, 32896, 0, 65535};
  ASSERT_TRUE(WritePicture(Path("wood.png"), picture).ok());
  Write("lib.mtl",
        std::string(
            "newmtl red\nKd 1 0 0\nd 0.5\nnewmtl wood\nKd 0 0 0\nmap_Kd -s 2 3 1 -o 0.25 0.5 0 -clamp on wood.png\n"
            "newmtl lost\nKd 0 0 1\nmap_Kd gone.png\n"));
  const Scene scene = Load("scene.obj",
                           "mtllib lib.mtl\no Box\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0.25\nvn 0 0 2\n"
                           "usemtl red\nf 1//1 2//1 3//1 4//1\nusemtl wood\nf 1/1/1 2/2/1 3/2/1\n"
                           "o Lid\nusemtl nothing\nf 1 2 3\n");
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.instances[0].object, "Box");
  EXPECT_EQ(scene.instances[1].object, "Box");
  EXPECT_EQ(scene.instances[2].object, "Lid");
  ASSERT_EQ(scene.materials.size(), 4u);
  EXPECT_EQ(scene.materials[0].base_color, glm::vec4(1, 0, 0, 0.5));
  EXPECT_EQ(scene.materials[0].alpha_mode, AlphaMode::kBlend);
  EXPECT_EQ(scene.materials[2].base_color, glm::vec4(0, 0, 1, 1));
  EXPECT_EQ(scene.materials[2].base_color_texture.texture, -1);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
  EXPECT_EQ(scene.meshes[0].normals[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(scene.meshes[2].material, 3);
  const Material& wood = scene.materials[1];
  EXPECT_EQ(wood.base_color, glm::vec4(1.0f));
  EXPECT_EQ(wood.base_color_texture.texture, 0);
  EXPECT_EQ(wood.base_color_texture.wrap_u, TextureWrap::kClamp);
  ASSERT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(scene.textures[0].rgba, picture.rgba);
  EXPECT_TRUE(scene.textures[1].empty());
  // (1, 0.25) in the file is (2.25, 1.25) in its picture with v up, so (2.25, -0.25) with v down.
  ASSERT_EQ(scene.meshes[1].uvs[0].size(), 3u);
  EXPECT_EQ(scene.meshes[1].uvs[0][1], glm::vec2(1, 0.75));
  ExpectNear(wood.base_color_texture.uv_transform * glm::vec3(scene.meshes[1].uvs[0][1], 1), {2.25, -0.25, 1}, 1e-6);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("in no library"), HasSubstr("are solid"), HasSubstr("gone.png")));
}

TEST_F(LoadText, ObjWithoutItsMaterialLibrary) {
  const Scene scene = Load("a.obj", "mtllib away.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n");
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].object, "shape_0");
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("away.mtl")));
}

// As Blender 3.4 reads its own exporter's files and others'.
TEST_F(LoadText, ObjMaterialsAnswerLightAsBlenderReadsThem) {
  Picture picture(1, 1);
  picture.rgba = {65535, 65535, 65535, 65535};
  ASSERT_TRUE(WritePicture(Path("glow.png"), picture).ok());
  Write("lib.mtl", std::string("newmtl chalk\nKd 0.5 0.5 0.5\n"
                               "newmtl chalk0\nKd 0.5 0.5 0.5\nKs 0 0 0\nNs 250\nillum 1\n"
                               "newmtl plastic\nKd 1 0 0\nKs 0.5 0.5 0.5\nNs 250\nKa 1 1 1\nillum 2\n"
                               "newmtl steel\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNs 640\nKa 1 1 1\nillum 3\n"
                               "newmtl chrome\nKd 0 0 0\nKs 0.9 0.8 2\nNs 1000\nd 0.25\n"
                               "newmtl pbr\nKd 0.8 0.8 0.8\nPr 0.25\nPm 0.75\n"
                               "newmtl lamp\nKd 0 0 0\nKe 2 3 4\n"
                               "newmtl panel\nKd 0 0 0\nKe 2 3 4\nmap_Ke glow.png\n"
                               "newmtl odd\nKd 1 1 1\nKs 1 1 1\nNs 1e30\nKe -1 0 0\nPm 7\n"));
  const Scene scene = Load("a.obj", "mtllib lib.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl chalk\nf 1 2 3\n");
  ASSERT_EQ(scene.materials.size(), 9u);
  const auto expect = [&](int index, Bsdf bsdf, double roughness, double metallic) {
    const Material& material = scene.materials[std::size_t(index)];
    EXPECT_EQ(material.bsdf, bsdf) << material.name;
    EXPECT_NEAR(material.roughness, roughness, 1e-6) << material.name;
    EXPECT_NEAR(material.metallic, metallic, 1e-6) << material.name;
  };
  expect(0, Bsdf::kDiffuse, 1.0, 0.0);
  expect(1, Bsdf::kDiffuse, 1.0, 0.0);
  expect(2, Bsdf::kMetallicRoughness, 0.5, 0.0);
  expect(3, Bsdf::kMetallicRoughness, 0.2, 1.0);
  expect(4, Bsdf::kGlossy, 0.0, 0.0);
  EXPECT_EQ(scene.materials[4].base_color, glm::vec4(0.9f, 0.8f, 1.0f, 0.25f));
  expect(5, Bsdf::kMetallicRoughness, 0.25, 0.75);
  EXPECT_EQ(scene.materials[5].emission, glm::vec3(0.0f));
  expect(6, Bsdf::kDiffuse, 1.0, 0.0);
  EXPECT_EQ(scene.materials[6].emission, glm::vec3(2, 3, 4));
  EXPECT_EQ(scene.materials[7].emission, glm::vec3(1.0f));
  EXPECT_EQ(scene.materials[7].emission_texture.texture, 0);
  expect(8, Bsdf::kMetallicRoughness, 0.0, 1.0);
  EXPECT_EQ(scene.materials[8].emission, glm::vec3(0.0f));
}

// A missing material does not mean a varnish.
TEST_F(LoadText, FacesWithoutAMaterialAreMatt) {
  const std::string face = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto expect_matt = [](const Scene& scene, const glm::vec4& color) {
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Material& material = scene.materials[std::size_t(scene.meshes[0].material)];
    EXPECT_EQ(material.name, "default");
    EXPECT_EQ(material.bsdf, Bsdf::kDiffuse);
    EXPECT_EQ(material.base_color, color);
  };
  const glm::vec4 grey(0.8f, 0.8f, 0.8f, 1.0f);
  expect_matt(Load("a.obj", face), grey);
  expect_matt(Load("b.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n"), glm::vec4(1.0f));
  const auto ply = [](const std::string& properties, const std::string& values) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
           properties + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0" + values +
           "\n1 0 0" + values + "\n0 1 0" + values + "\n3 0 1 2\n";
  };
  expect_matt(Load("a.ply", ply("", "")), grey);
  expect_matt(Load("b.ply", ply("property uchar red\nproperty uchar green\nproperty uchar blue\n", " 255 0 9")),
              glm::vec4(1.0f));
  // A library's own "default" keeps its name, and two shapes without a material share one.
  Write("lib.mtl", std::string("newmtl default\nKd 1 0 0\n"));
  const Scene scene = Load("c.obj", "mtllib lib.mtl\no A\n" + face + "o B\nf 3 2 1\no C\nusemtl default\nf 1 2 3\n");
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.materials[1].name, "default#2");
  EXPECT_EQ(scene.meshes[0].material, 1);
  EXPECT_EQ(scene.meshes[1].material, 1);
  EXPECT_EQ(scene.meshes[2].material, 0);
}

TEST_F(LoadText, ObjVertexColorsAreEncoded) {
  const Scene scene = Load("a.obj", "v 0 0 0 1 0 0.5\nv 1 0 0 1 0 0.5\nv 0 1 0 1 0 0.5\nf 1 2 3\n");
  ASSERT_EQ(scene.meshes[0].colors.size(), 3u);
  EXPECT_EQ(scene.meshes[0].colors[0], glm::vec4(1, 0, SrgbToLinear(0.5f), 1));
  EXPECT_THAT(Load("b.obj", "v 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nf 1 2 3\n").meshes[0].colors, IsEmpty());
}

TEST_F(LoadText, ObjNormalsAreSmoothAcrossMaterialsAndInsideGroups) {
  const std::string roof = "v 0 0 0\nv 1 1 0\nv 0 0 -1\nv 1 1 -1\nv 2 0 0\nv 2 0 -1\n";
  const std::string left = "f 1 2 4 3\n", right = "f 2 5 6 4\n";
  const double half = std::sqrt(0.5);
  Scene scene = Load("a.obj", roof + "s 1\ng L\n" + left + "g R\n" + right);
  ASSERT_EQ(scene.meshes.size(), 2u);
  ExpectNear(scene.meshes[0].normals[1], {0, 1, 0}, 1e-6);
  ExpectNear(scene.meshes[1].normals[0], {0, 1, 0}, 1e-6);
  scene = Load("b.obj", roof + "s 1\n" + left + "s 2\n" + right);
  EXPECT_EQ(scene.meshes[0].positions.size(), 8u);
  for (int i = 0; i < 4; ++i) ExpectNear(scene.meshes[0].normals[i], {-half, half, 0}, 1e-6);
  scene = Load("c.obj", roof + "s 1\n" + left + "s off\n" + right);
  for (int i = 4; i < 8; ++i) ExpectNear(scene.meshes[0].normals[i], {half, half, 0}, 1e-6);
}

// The cap of a cylinder, as modellers leave it.
TEST_F(LoadText, ObjFacesOfManyCorners) {
  std::string text;
  const int corners = 600;
  for (int i = 0; i < corners; ++i) {
    const double turn = 2.0 * kPi * i / corners;
    text += "v " + std::to_string(std::cos(turn)) + " " + std::to_string(std::sin(turn)) + " 0\n";
  }
  text += "o Leaf\nf 1 2 3\nf 1 2\no Cap\nf 1 2 3 4\nf";
  for (int i = 1; i <= corners; ++i) text += " " + std::to_string(i);
  text += "\nf 4 5 6 \t\r\n";
  const Scene scene = Load("caps.obj", text);
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 1u);
  ASSERT_EQ(scene.meshes[1].triangles.size(), std::size_t(2 + corners - 2 + 1));
  double area = 0.0;
  for (const glm::uvec3& t : scene.meshes[1].triangles) {
    const auto& p = scene.meshes[1].positions;
    area += 0.5 * glm::length(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]));
  }
  EXPECT_NEAR(area, kPi, 0.001);
}

TEST_F(LoadText, ObjWithoutContent) {
  const Scene scene = Load("a.obj", "# nothing\n");
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("no geometry")));
}

TEST_F(LoadText, PlyOfEveryKindIsTheSameMesh) {
  const std::string header =
      "comment made by hand\nobj_info none\nelement vertex 4\nproperty float x\nproperty double y\nproperty short z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\nproperty float t\n"
      "element strange 1\nproperty list uchar float odd\nelement face 2\nproperty uchar flags\n"
      "property list uchar int vertex_indices\nend_header\n";
  const std::string text =
      "0 0 0 255 0 128 0 1\n1 0 0 255 0 128 1 1\n1 1 0 255 0 128 1 0\n0 1 0 255 0 128 0 0\n3 1 2 3\n7 3 0 1 2\n9 3 0 2 "
      "3\n";
  const Scene ascii = Load("mesh.ply", "ply\r\nformat ascii 1.0\r\n" + header + text);
  ASSERT_EQ(ascii.instances.size(), 1u);
  EXPECT_EQ(ascii.instances[0].object, "mesh");
  EXPECT_EQ(ascii.meshes[0].triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(ascii.meshes[0].colors[3], glm::vec4(1, 0, SrgbToLinear(128 / 255.0f), 1));
  EXPECT_EQ(ascii.meshes[0].uvs[0][2], glm::vec2(1, 1));
  EXPECT_EQ(ascii.meshes[0].normals[2], glm::vec3(0, 0, 1));
  EXPECT_THAT(ascii.warnings, ElementsAre(HasSubstr("strange")));
  for (const bool big : {false, true}) {
    std::string body;
    const auto put = [&](auto value) {
      char raw[sizeof value];
      std::memcpy(raw, &value, sizeof value);
      if (big) std::reverse(raw, raw + sizeof value);
      body.append(raw, sizeof value);
    };
    for (int i = 0; i < 4; ++i) {
      const float x = i == 1 || i == 2, y = i >= 2;
      put(x), put(double(y)), put(std::int16_t(0));
      put(std::uint8_t(255)), put(std::uint8_t(0)), put(std::uint8_t(128)), put(x), put(1.0f - y);
    }
    put(std::uint8_t(1)), put(3.0f);
    for (int f = 0; f < 2; ++f) {
      put(std::uint8_t(7)), put(std::uint8_t(3));
      for (int i : {0, 1 + f, 2 + f}) put(std::int32_t(i));
    }
    const std::string format = big ? "binary_big_endian" : "binary_little_endian";
    const Scene binary = Load("mesh.ply", "ply\nformat " + format + " 1.0\n" + header + body);
    EXPECT_EQ(binary.meshes[0].positions, ascii.meshes[0].positions) << format;
    EXPECT_EQ(binary.meshes[0].triangles, ascii.meshes[0].triangles) << format;
    EXPECT_EQ(binary.meshes[0].colors, ascii.meshes[0].colors) << format;
    EXPECT_EQ(binary.meshes[0].uvs[0], ascii.meshes[0].uvs[0]) << format;
  }
}

// The cube from -1 to 1, stretched and moved.
Scene StretchedCube() {
  Scene scene;
  scene.name = "cube.glb";
  Mesh mesh = Cube(0);
  FillNormals(mesh);
  scene.meshes.push_back(mesh);
  glm::dmat4 world(1.0);
  world[0][0] = 3.0, world[1][1] = 0.5, world[3] = glm::dvec4(1e6, -7.0, 2.0, 1.0);
  scene.instances.push_back({"Cube", 0, world});
  DefaultMaterial(scene);
  return scene;
}

TEST(Framing, TheBoundingSphereFitsWithAMargin) {
  const Scene scene = StretchedCube();
  const glm::dvec3 center(1e6, -7, 2);
  const double radius = std::sqrt(9.0 + 0.25 + 1.0);
  for (const double aspect : {0.4, 1.0, 2.5}) {
    for (const double elevation : {-90.0, 0.0, 20.0, 90.0}) {
      const Camera camera = FramingCamera(scene, {.azimuth = 35, .elevation = elevation}, aspect);
      const glm::dmat4& world = camera.world_from_camera;
      EXPECT_NEAR(glm::determinant(glm::dmat3(world)), 1.0, 1e-12);
      const glm::dvec3 eye(world[3]), back(world[2]);
      const double distance = glm::length(eye - center);
      ExpectNear(glm::normalize(eye - center), back, 1e-9);
      EXPECT_NEAR(back.y, std::sin(elevation * kPi / 180), 1e-12);
      EXPECT_GE(world[1][1], -1e-12);
      // Half the picture against the sphere's outline on the picture plane.
      const double half_y = std::tan(0.5 * camera.yfov_degrees * kPi / 180);
      const double outline = std::tan(std::asin(radius / distance));
      EXPECT_NEAR(std::min(half_y, half_y * aspect) / outline, 1.1, 1e-6);
    }
  }
}

TEST(Framing, AzimuthTurnsFromTowardsTheViewerToTheRight) {
  const Scene scene = StretchedCube();
  const Camera front = FramingCamera(scene, {.azimuth = 0, .elevation = 0}, 1.0);
  ExpectNear(glm::dvec3(front.world_from_camera[2]), {0, 0, 1}, 1e-15);
  const Camera right = FramingCamera(scene, {.azimuth = 90, .elevation = 0, .distance = 5}, 1.0);
  ExpectNear(glm::dvec3(right.world_from_camera[2]), {1, 0, 0}, 1e-15);
  ExpectNear(glm::dvec3(right.world_from_camera[3]), {1e6 + 5, -7, 2}, 1e-9);
  Camera top = FramingCamera(scene, {.azimuth = 0, .elevation = 90}, 1.0);
  ExpectNear(glm::dvec3(top.world_from_camera[1]), {0, 0, -1}, 1e-15);
}

TEST(Framing, ScenesWithoutExtent) {
  Scene scene;
  EXPECT_GT(FramingCamera(scene, {}, 1.5).world_from_camera[3].z, 1.0);
  Mesh mesh;
  mesh.positions.assign(3, glm::vec3(4, 5, 6));
  mesh.triangles = {{0, 1, 2}};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"Dot", 0, glm::dmat4(1.0)});
  const Camera camera = FramingCamera(scene, {.azimuth = 0, .elevation = 0}, 1.0);
  EXPECT_GT(camera.world_from_camera[3].z, 7.0);
  EXPECT_EQ(camera.world_from_camera[3].x, 4.0);
}

TEST(Framing, AnOrbitStandsWhereItsCameraStands) {
  const Scene scene = StretchedCube();
  const SceneSphere sphere = SphereAround(scene);
  const auto same = [&](const Camera& camera, double aspect) {
    const Camera orbit = FramingCamera(scene, OrbitOf(sphere, camera, aspect), aspect);
    for (const int column : {2, 3}) {
      ExpectNear(glm::dvec3(orbit.world_from_camera[column]), glm::dvec3(camera.world_from_camera[column]), 1e-9);
    }
    return orbit.yfov_degrees;
  };
  for (const double elevation : {-90.0, -35.0, 0.0, 70.0, 90.0}) {
    const ViewAngles view{.azimuth = 130, .elevation = elevation, .distance = 9, .right = 1.5, .up = -2, .fov = 50};
    const Camera camera = FramingCamera(scene, view, 1.5);
    EXPECT_NEAR(same(camera, 1.5), 50.0, 1e-9);
    EXPECT_NEAR(OrbitOf(sphere, camera, 1.5).right, 1.5, 1e-9);
  }
  Camera wide = FramingCamera(scene, {}, 2.0);
  wide.fit = CameraFit::kHorizontal, wide.yfov_degrees = 90;
  EXPECT_NEAR(same(wide, 2.0), 2.0 * std::atan(0.5) * 180 / kPi, 1e-9);
  Camera flat = FramingCamera(scene, {}, 2.0);
  flat.orthographic = true, flat.ymag = 3.0;
  const ViewAngles far_away = OrbitOf(sphere, flat, 2.0);
  EXPECT_NEAR(far_away.distance * std::tan(0.5 * far_away.fov * kPi / 180), 3.0, 1e-9) << "shows as much";
}

TEST(Framing, TheKeyLightComesFromTheUpperLeftOfTheView) {
  const Camera camera = FramingCamera(StretchedCube(), {.azimuth = 130, .elevation = -35}, 1.0);
  const Light light = KeyLight(camera);
  EXPECT_EQ(light.type, LightType::kSun);
  EXPECT_DOUBLE_EQ(light.intensity, kPi);
  const glm::dvec3 towards =
      glm::transpose(glm::dmat3(camera.world_from_camera)) * glm::dvec3(light.world_from_light[2]);
  const double a = -40 * kPi / 180, e = 40 * kPi / 180;
  ExpectNear(towards, {std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e)}, 1e-12);
  EXPECT_LT(towards.x, 0.0);
  EXPECT_GT(towards.y, 0.0);
  EXPECT_GT(towards.z, 0.0);
}

TEST(PrepareView, ChoosesCameraAndLight) {
  Scene scene = StretchedCube();
  auto view = PrepareView(scene, "", std::nullopt, 1.5, false);
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view->camera.name, "framing");
  EXPECT_THAT(view->notes, ElementsAre(HasSubstr("cube.glb has no camera")));
  EXPECT_TRUE(scene.lights.empty());
  view = PrepareView(scene, "", std::nullopt, 1.5, true);
  EXPECT_EQ(scene.lights.size(), 1u);
  EXPECT_THAT(view->notes, ElementsAre(HasSubstr("no camera"), HasSubstr("no light")));

  // A surface that emits is a lamp; a lantern whose texture shows where it glows is none.
  const Material matt = scene.materials[0];
  scene.materials[0].emission = glm::vec3(1.0f);
  scene.lights.clear();
  EXPECT_THAT(PrepareView(scene, "", std::nullopt, 1.5, true)->notes, ElementsAre(HasSubstr("no camera")));
  EXPECT_TRUE(scene.lights.empty());
  scene.materials[0].emission_texture.texture = 0;
  EXPECT_THAT(PrepareView(scene, "", std::nullopt, 1.5, true)->notes,
              ElementsAre(HasSubstr("no camera"), HasSubstr("no light but textures that glow: lit by a sun")));
  EXPECT_EQ(scene.lights.size(), 1u);
  scene.materials[0].bsdf = Bsdf::kEmission;
  scene.lights.clear();
  EXPECT_THAT(PrepareView(scene, "", std::nullopt, 1.5, true)->notes, ElementsAre(HasSubstr("no camera")));
  scene.materials[0] = matt;
  scene.lights.resize(1);

  Camera camera;
  camera.name = "A";
  scene.cameras.push_back(camera);
  view = PrepareView(scene, "", std::nullopt, 1.5, true);
  EXPECT_EQ(view->camera.name, "A");
  EXPECT_THAT(view->notes, IsEmpty());
  EXPECT_EQ(scene.lights.size(), 1u);
  camera.name = "B";
  scene.cameras.push_back(camera);
  EXPECT_THAT(PrepareView(scene, "", std::nullopt, 1.5, true)->notes, ElementsAre(HasSubstr("'A', 'B'")));
  EXPECT_EQ(PrepareView(scene, "B", std::nullopt, 1.5, true)->camera.name, "B");
  EXPECT_EQ(PrepareView(scene, "", ViewAngles{.azimuth = 10}, 1.5, true)->camera.name, "framing");
  view = PrepareView(scene, "C", std::nullopt, 1.5, true);
  ASSERT_FALSE(view.ok());
  EXPECT_EQ(view.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(view.error().message, HasSubstr("there are: 'A', 'B'"));
  EXPECT_EQ(PrepareView(scene, "B", ViewAngles{}, 1.5, true).error().kind, ErrorKind::kUsage);

  // Another camera than the active one is nobody's wish.
  scene.lost_camera = "'Round' is panoramic";
  view = PrepareView(scene, "", std::nullopt, 1.5, true);
  ASSERT_FALSE(view.ok());
  EXPECT_EQ(view.error().kind, ErrorKind::kInput);
  EXPECT_THAT(view.error().message,
              HasSubstr("active camera 'Round' is panoramic: give --camera NAME, of 'A', 'B', or --view"));
  EXPECT_EQ(PrepareView(scene, "B", std::nullopt, 1.5, true)->camera.name, "B");
  EXPECT_EQ(PrepareView(scene, "", ViewAngles{.azimuth = 10}, 1.5, true)->camera.name, "framing");
}

}  // namespace
}  // namespace scumble
