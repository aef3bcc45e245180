// Blender scenes, through the real Blender: the loaded export against Blender's own numbers. export_verbs_test.cpp has
// the commands that run the export themselves.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/gtc/matrix_inverse.hpp>
#include <map>
#include <set>
#include <vector>

#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "guidegen/rays/camera_rays.h"
#include "tests/blender/blender_cases.h"
#include "tests/blender/blender_version.h"
#include "tests/blender/cycles_passes.h"
#include "tests/support/numbers.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

const testing::Environment* const kCases = testing::AddGlobalTestEnvironment(new BlenderCases);

Scene Loaded(const std::string& name) {
  Expected<Scene> scene = LoadScene(BlenderCases::File(name + ".glb"));
  EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
  return scene ? std::move(*scene) : Scene();
}

template <class T>
const T& Named(const std::vector<T>& list, const std::string& name) {
  static const T kNone{};
  for (const T& thing : list) {
    if (thing.name == name) return thing;
  }
  ADD_FAILURE() << "there is no " << name;
  return kNone;
}

// Values that went through Blender's floats.
void ExpectClose(double found, double expected, const std::string& what) {
  EXPECT_NEAR(found, expected, 1e-6 * std::max(1.0, std::abs(expected))) << what;
}
void ExpectColor(const glm::vec3& found, const glm::vec3& expected, const std::string& what) {
  for (int i = 0; i < 3; ++i) ExpectClose(found[i], expected[i], what);
}

// What `pref` holds stays where it is while modifiers and shape keys move the vertices.
TEST(BlenderMeshes, RestPositionsDoNotMove) {
  const Scene first = Loaded("deformed"), sixth = Loaded("deformed6");
  const auto mesh = [](const Scene& scene, const std::string& object) {
    for (const Instance& instance : scene.instances) {
      if (instance.object == object) return scene.meshes[std::size_t(instance.mesh)];
    }
    ADD_FAILURE() << "there is no " << object;
    return Mesh();
  };
  EXPECT_TRUE(mesh(first, "Plain").rest_positions.empty());
  for (const std::string object : {"Bent", "Shaped"}) {
    SCOPED_TRACE(object);
    const Mesh a = mesh(first, object), b = mesh(sixth, object);
    ASSERT_EQ(a.rest_positions.size(), a.positions.size());
    // Corner by corner: how vertices are numbered depends on their normals, which move.
    ASSERT_EQ(a.triangles.size(), b.triangles.size());
    for (std::size_t i = 0; i < a.triangles.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(a.rest_positions[a.triangles[i][k]], b.rest_positions[b.triangles[i][k]]) << i << " " << k;
      }
    }
    EXPECT_NE(a.positions, b.positions);
    glm::vec3 low(1e30f), high(-1e30f);
    for (const glm::vec3& place : a.rest_positions) low = glm::min(low, place), high = glm::max(high, place);
    // Cubes of 1 m, three of them side by side; not bent, and not stretched by the object's scale.
    EXPECT_EQ(low, glm::vec3(-0.5f));
    EXPECT_EQ(high, object == "Bent" ? glm::vec3(2.5f, 0.5f, 0.5f) : glm::vec3(0.5f));
  }
  // At value 0 the shape is that of the basis, vertex by vertex: the axes are glTF's.
  EXPECT_EQ(mesh(first, "Shaped").rest_positions, mesh(first, "Shaped").positions);
}

// A flat grid that is plane in the first frame and bent in the second: the export has other vertices in each, because
// corners of equal normals are one vertex.
class TwistedGrid : public testing::Test {
 protected:
  static Scene Alone(const std::string& name) {
    Scene scene = Loaded(name);
    std::erase_if(scene.instances, [](const Instance& instance) { return instance.object != "Twisted"; });
    EXPECT_EQ(scene.instances.size(), 1u);
    return scene;
  }
  static const Mesh& MeshOf(const Scene& scene) { return scene.meshes[std::size_t(scene.instances[0].mesh)]; }

  const Scene first_ = Alone("deformed"), sixth_ = Alone("deformed6");
};

TEST_F(TwistedGrid, HasRestPositions) {
  const Mesh &a = MeshOf(first_), &b = MeshOf(sixth_);
  ASSERT_EQ(a.rest_positions.size(), a.positions.size());
  ASSERT_EQ(b.rest_positions.size(), b.positions.size());
  ASSERT_EQ(a.triangles.size(), 512u);
  ASSERT_EQ(b.triangles.size(), 512u);
  for (std::size_t t = 0; t < a.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t at = a.triangles[t][i], then = b.triangles[t][i];
      EXPECT_EQ(a.rest_positions[at], b.rest_positions[then]) << t;
      EXPECT_EQ(a.rest_positions[at], a.positions[at]) << t;
    }
  }
}

TEST_F(TwistedGrid, Moves) {
  Camera above;  // 40 pixels a metre
  above.orthographic = true;
  above.ymag = 1.2;
  above.world_from_camera = glm::dmat4(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 10, 0, 1);
  GuidegenOptions options;
  options.width = options.height = 96;
  options.layers.Add(Layer::kMotion);
  const auto result = RenderGuides(first_, above, {sixth_, above}, options);
  ASSERT_TRUE(result) << result.error().message;
  int seen = 0;
  double farthest = 0.0;
  for (int row = 0; row < 96; ++row) {
    for (int column = 0; column < 96; ++column) {
      const double x = (column + 0.5 - 48) / 40, y = (48 - row - 0.5) / 40;
      if (std::abs(x) >= 1.0 || std::abs(y) >= 1.0) continue;
      const std::size_t pixel = std::size_t(row * 96 + column);
      const double moved = 40 * 0.5 * x * (std::cos(y) - 1);
      ++seen, farthest = std::max(farthest, std::abs(moved));
      // Between vertices, 5 pixels apart, the surface is straight.
      ASSERT_NEAR(result->guides.Plane(Layer::kMotion, 0)[pixel], moved, 0.15) << column << " " << row;
      ASSERT_NEAR(result->guides.Plane(Layer::kMotion, 1)[pixel], 0.0, 1e-4) << column << " " << row;
    }
  }
  EXPECT_EQ(seen, 6400);
  EXPECT_GT(farthest, 8.0);
}

TEST(BlenderLamps, PointsAndSpots) {
  const Scene scene = Loaded("lamps");
  const Light& point = Named(scene.lights, "Point");
  EXPECT_EQ(point.type, LightType::kPoint);
  ExpectClose(point.intensity, 100.0 / (4 * kPi), "point");
  ExpectClose(point.radius, 0.25, "radius");
  ExpectColor(point.color, {1.0f, 0.5f, 0.25f}, "colour");
  ExpectColor(glm::vec3(point.world_from_light[3]), glm::vec3(YUp({1, 2, 3})), "place");
  const Light& spot = Named(scene.lights, "Spot");
  EXPECT_EQ(spot.type, LightType::kSpot);
  EXPECT_TRUE(spot.cycles_spot);
  EXPECT_EQ(spot.spot_cosine, !IsBlender4());
  for (const Material& material : scene.materials) EXPECT_EQ(material.cycles4, IsBlender4());
  ExpectClose(spot.intensity, 60.0 / (4 * kPi), "spot");
  ExpectClose(spot.outer_cone_degrees, 25.0, "half angle");
  ExpectClose(spot.spot_blend, 0.4, "blend");
  ExpectClose(spot.radius, 0.0, "radius");
  ExpectColor(-glm::vec3(spot.world_from_light[2]), {0, -1, 0}, "it shines down");
  ExpectClose(Named(scene.lights, "NodePoint").intensity, 5.0 / (4 * kPi), "node strength");
}

TEST(BlenderLamps, SunsKeepTheirStrengthWithNodesToo) {
  const Scene scene = Loaded("lamps");
  const Light& sun = Named(scene.lights, "Sun");
  EXPECT_EQ(sun.type, LightType::kSun);
  ExpectClose(sun.intensity, 2.0, "strength");
  ExpectClose(sun.angle_degrees, 3.0, "angle");
  ExpectColor(-glm::vec3(sun.world_from_light[2]), glm::vec3(YUp({0, 1, 0})), "direction");
  const Light& node_sun = Named(scene.lights, "NodeSun");
  ExpectClose(node_sun.intensity, 6.0, "2 times the node's 3");
  ExpectColor(node_sun.color, {0.5f, 1.0f, 1.0f}, "the node's colour");
}

TEST(BlenderLamps, AreasOfEveryShape) {
  const Scene scene = Loaded("lamps");
  struct Case {
    const char* name;
    bool ellipse;
    double x, y, area;
  };
  for (const Case& c :
       {Case{"Square", false, 2, 2, 4}, Case{"Rectangle", false, 2, 0.5, 1}, Case{"Disc", true, 2, 2, kPi},
        Case{"Ellipse", true, 2, 1, kPi / 2}, Case{"ScaledSquare", false, 2, 3, 6}}) {
    const Light& light = Named(scene.lights, c.name);
    EXPECT_EQ(light.type, LightType::kArea) << c.name;
    EXPECT_EQ(light.ellipse, c.ellipse) << c.name;
    ExpectClose(light.size_x, c.x, c.name);
    ExpectClose(light.size_y, c.y, c.name);
    ExpectClose(light.intensity, 10.0 / ((IsBlender4() ? kPi : 4.0) * c.area), c.name);
  }
}

TEST(BlenderLamps, TheWorldAndWhatIsLeftOut) {
  const Scene scene = Loaded("lamps");
  ExpectColor(scene.world_radiance, {0.5f, 1.0f, 2.0f}, "world");
  EXPECT_EQ(scene.lights.size(), 12u) << "all but the hidden one";
  EXPECT_THAT(scene.warnings,
              testing::UnorderedElementsAre(AllOf(HasSubstr("OddPoint"), HasSubstr("TEX_NOISE")),
                                            AllOf(HasSubstr("'Shy'"), HasSubstr("glossy surfaces")),
                                            AllOf(HasSubstr("'Shy'"), HasSubstr("after 0 bounces")),
                                            AllOf(HasSubstr("'World'"), HasSubstr("diffuse surfaces"))));
}

TEST(BlenderMaterials, PureShaders) {
  const Scene scene = Loaded("materials");
  const Material& diffuse = Named(scene.materials, "Diffuse");
  EXPECT_EQ(diffuse.bsdf, Bsdf::kDiffuse);
  EXPECT_TRUE(diffuse.double_sided) << "culling is the viewport's";
  ExpectColor(diffuse.base_color, {0.2f, 0.4f, 0.8f}, "diffuse");
  EXPECT_EQ(diffuse.diffuse_roughness, 0.0f);
  ExpectClose(Named(scene.materials, "Rough").diffuse_roughness, 0.6, "diffuse roughness");
  const Material& glossy = Named(scene.materials, "Glossy");
  EXPECT_EQ(glossy.bsdf, Bsdf::kGlossy);
  ExpectColor(glossy.base_color, {0.9f, 0.7f, 0.3f}, "glossy");
  ExpectClose(glossy.roughness, 0.3, "roughness");
  EXPECT_EQ(Named(scene.materials, "Sharp").roughness, 0.0f);
  const Material& emission = Named(scene.materials, "Emission");
  EXPECT_EQ(emission.bsdf, Bsdf::kEmission);
  ExpectColor(emission.emission, {4.0f, 2.0f, 1.0f}, "emission");
}

TEST(BlenderMaterials, PrincipledAndNone) {
  const Scene scene = Loaded("materials");
  const Material& principled = Named(scene.materials, "Principled");
  EXPECT_EQ(principled.bsdf, Bsdf::kMetallicRoughness);
  ExpectColor(principled.base_color, {0.3f, 0.6f, 0.9f}, "base colour");
  ExpectClose(principled.metallic, 0.25, "metallic");
  ExpectClose(principled.roughness, 0.35, "roughness");
  ExpectColor(principled.emission, {1.5f, 0.75f, 0.0f}, "emission");
  ExpectColor(Named(scene.materials, "Plain").base_color, {0.7f, 0.6f, 0.5f}, "without nodes");
  EXPECT_EQ(Named(scene.materials, "Plain").bsdf, Bsdf::kDiffuse);
  ExpectColor(Named(scene.materials, "default").base_color, {0.8f, 0.8f, 0.8f}, "faces without a material");
}

// Blender takes them from old files as they are, though its own properties end at 1.
TEST(BlenderMaterials, NumbersBeyondOneOfOldFilesAreOne) {
  const Scene scene = Loaded("old");
  const Material& ground = Named(scene.materials, "Ground");
  EXPECT_EQ(ground.bsdf, Bsdf::kDiffuse);
  EXPECT_EQ(scene.instances.size(), 1u);
}

TEST(BlenderMaterials, TexturesAndPaintStay) {
  const Scene scene = Loaded("materials");
  for (const char* name : {"DiffuseTextured", "GlossyTextured", "EmissionTextured", "PrincipledTextured"}) {
    const Material& material = Named(scene.materials, name);
    ExpectColor(material.base_color, glm::vec3(1.0f), name);
    ASSERT_GE(material.base_color_texture.texture, 0) << name;
    EXPECT_TRUE(material.base_color_texture.nearest) << name;
    const Picture& picture = scene.textures[std::size_t(material.base_color_texture.texture)];
    ASSERT_EQ(picture.width, 4) << name;
    EXPECT_EQ(picture.At(0, 3)[0], 65535) << "the first row of Blender's pixels is the lowest";
    EXPECT_EQ(picture.At(3, 3)[1], 65535);
  }
  EXPECT_EQ(Named(scene.materials, "GlossyTextured").bsdf, Bsdf::kGlossy);
  ExpectClose(Named(scene.materials, "GlossyTextured").base_color_texture.uv_transform[0][0], 2.0, "mapping");
  EXPECT_GE(Named(scene.materials, "EmissionTextured").emission_texture.texture, 0);
  ExpectColor(Named(scene.materials, "EmissionTextured").emission, glm::vec3(2.0f), "strength");
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    EXPECT_EQ(!mesh.colors.empty(), instance.object == "OnSeen") << instance.object;
    EXPECT_FALSE(mesh.uvs[0].empty()) << instance.object;
    // 16 bits, as the exporter of Blender 4 writes them.
    for (int i = 0; i < 3 && !mesh.colors.empty(); ++i) EXPECT_NEAR(mesh.colors[0][i], 0.25 * (i + 1), 1e-5) << "paint";
  }
}

TEST(BlenderMaterials, NormalMapsAndBumpsComeOver) {
  const Scene scene = Loaded("materials");
  const Material& both = Named(scene.materials, "BumpOnMap");
  EXPECT_GE(both.normal_texture.texture, 0);
  EXPECT_EQ(both.normal_rule, NormalMapRule::kTangent);
  EXPECT_EQ(both.normal_scale, 0.5f);
  EXPECT_EQ(both.bump.height_texture.texture, both.normal_texture.texture);
  EXPECT_EQ(both.bump.strength, 0.75f);
  EXPECT_EQ(both.bump.distance, -0.5f) << "inverted";
  EXPECT_FALSE(both.bump.srgb);
  const Material& painted = Named(scene.materials, "PaintedBump");
  EXPECT_LT(painted.normal_texture.texture, 0);
  EXPECT_GE(painted.bump.height_texture.texture, 0);
  EXPECT_EQ(painted.bump.distance, -0.5f);
  EXPECT_TRUE(painted.bump.srgb);
  const Material& of_object = Named(scene.materials, "ObjectMap");
  EXPECT_EQ(of_object.normal_rule, NormalMapRule::kObject);
  EXPECT_GE(of_object.normal_texture.texture, 0);
  const Material& principled = Named(scene.materials, "PrincipledBump");
  EXPECT_GE(principled.bump.height_texture.texture, 0);
  EXPECT_EQ(principled.bump.height_texture.texture, principled.base_color_texture.texture);
  for (const char* name : {"NoBend", "WorldMap", "PaintedMap", "Bevelled"}) {
    EXPECT_LT(Named(scene.materials, name).normal_texture.texture, 0) << name;
    EXPECT_LT(Named(scene.materials, name).bump.height_texture.texture, 0) << name;
  }
  EXPECT_GE(Named(scene.materials, "NoiseOnMap").normal_texture.texture, 0) << "the map below stays";
  EXPECT_LT(Named(scene.materials, "NoiseOnMap").bump.height_texture.texture, 0);
  EXPECT_EQ(Named(scene.materials, "TwoBumps").bump.srgb, false) << "the upper one";
  std::set<std::string> on_cube;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    const Material& material = scene.materials[std::size_t(mesh.material)];
    if (instance.object == "OnBumpOnMap") on_cube.insert(material.name);
    EXPECT_EQ(mesh.tangents.empty(),
              material.normal_texture.texture < 0 || material.normal_rule != NormalMapRule::kTangent)
        << material.name;
  }
  EXPECT_EQ(on_cube, (std::set<std::string>{"BumpOnMap", "Glossy"}));
}

TEST(BlenderMaterials, WhatCannotBeExpressedIsNamed) {
  const Scene scene = Loaded("materials");
  EXPECT_THAT(scene.warnings,
              UnorderedElementsAre(AllOf(HasSubstr("'Mixed'"), HasSubstr("MIX_SHADER"), HasSubstr("viewport colour")),
                                   AllOf(HasSubstr("'Noisy'"), HasSubstr("TEX_NOISE")),
                                   AllOf(HasSubstr("'Unlinked'"), HasSubstr("black")),
                                   AllOf(HasSubstr("'Waxy'"), HasSubstr("Subsurface")),
                                   AllOf(HasSubstr("'NoiseOnMap'"), HasSubstr("bump 'Bump'"), HasSubstr("TEX_NOISE")),
                                   AllOf(HasSubstr("'TwoBumps'"), HasSubstr("'Bump.001'"), HasSubstr("another bump")),
                                   AllOf(HasSubstr("'WorldMap'"), HasSubstr("'Normal Map'"), HasSubstr("world space")),
                                   AllOf(HasSubstr("'PaintedMap'"), HasSubstr("'Image Texture'"), HasSubstr("sRGB")),
                                   AllOf(HasSubstr("'Bevelled'"), HasSubstr("'Bevel'"), HasSubstr("own normal"))));
  ExpectColor(Named(scene.materials, "Mixed").base_color, {0.1f, 0.2f, 0.3f}, "viewport colour");
  ExpectColor(Named(scene.materials, "Noisy").base_color, {0.5f, 0.25f, 0.75f}, "the node's own");
  ExpectColor(Named(scene.materials, "Unlinked").base_color, glm::vec3(0.0f), "as Cycles shows it");
}

struct Box {
  std::size_t triangles = 0;
  glm::dvec3 low{1e9};
  glm::dvec3 high{-1e9};
};

std::map<std::string, Box> Boxes(const Scene& scene) {
  std::map<std::string, Box> boxes;
  for (const Instance& instance : scene.instances) {
    // Blender counts its copies in expected.json together.
    Box& box = boxes[instance.object.substr(0, instance.object.find('#'))];
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    box.triangles += mesh.triangles.size();
    for (const glm::vec3& position : mesh.positions) {
      const glm::dvec3 world(instance.world_from_object * glm::dvec4(glm::dvec3(position), 1.0));
      box.low = glm::min(box.low, world), box.high = glm::max(box.high, world);
    }
  }
  return boxes;
}

void ExpectBoxes(const Scene& scene, const nlohmann::json& expected) {
  const std::map<std::string, Box> boxes = Boxes(scene);
  for (const auto& [name, box] : boxes) EXPECT_TRUE(expected.contains(name)) << name << " should not be there";
  for (const auto& [name, entry] : expected.items()) {
    ASSERT_TRUE(boxes.count(name)) << name;
    const Box& box = boxes.at(name);
    EXPECT_EQ(box.triangles, entry["triangles"].get<std::size_t>()) << name;
    const auto& low = entry["low"];
    const auto& high = entry["high"];
    // The y axis changes its sign, and with it which end is the low one.
    const glm::dvec3 first(low[0], low[2], -high[1].get<double>()), last(high[0], high[2], -low[1].get<double>());
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(box.low[i], first[i], 4e-6) << name << " axis " << i;
      EXPECT_NEAR(box.high[i], last[i], 4e-6) << name << " axis " << i;
    }
  }
}

TEST(BlenderObjects, StandWhereTheRenderHasThem) {
  ExpectBoxes(Loaded("objects"), BlenderCases::Expected("objects")["1"]);
  EXPECT_GT(BlenderCases::Expected("objects")["1"].size(), 12u);
}

TEST(BlenderObjects, AtTheFrameAskedFor) { ExpectBoxes(Loaded("objects6"), BlenderCases::Expected("objects")["6"]); }

TEST(BlenderObjects, InstancesShareTheirMesh) {
  const Scene scene = Loaded("objects");
  std::map<std::string, int> meshes;
  std::set<std::string> names;
  for (const Instance& instance : scene.instances) {
    meshes[instance.object] = instance.mesh;
    EXPECT_TRUE(names.insert(instance.object).second) << instance.object;
  }
  for (const char* name : {"Two", "Mirrored", "Stretched"}) EXPECT_EQ(meshes[name], meshes["One"]) << name;
  EXPECT_EQ(meshes["First/Member"], meshes["Second/Member"]);
  EXPECT_NE(meshes["Smooth"], meshes["One"]);
  EXPECT_NE(meshes["Words"], meshes["MoreWords"]) << "one text in two objects, one of them with a modifier";
  EXPECT_EQ(meshes.count("Scatter/Leaf#8"), 1u) << "one for each corner of the instancer";
  EXPECT_THAT(scene.warnings, testing::ElementsAre(AllOf(HasSubstr("'Smoke'"), HasSubstr("left out"))));
}

TEST(BlenderFiles, WhatIsLostOrAsleepIsNamed) {
  const Scene scene = Loaded("broken");
  EXPECT_THAT(
      scene.warnings,
      UnorderedElementsAre(
          AllOf(HasSubstr("image 'Gone'"), HasSubstr("//textures/gone.png"), HasSubstr("'MissingTexture'")),
          AllOf(HasSubstr("lost.blend' is missing"), HasSubstr("'Lost'"), HasSubstr("'LostToo'")),
          AllOf(HasSubstr("poor.blend' has lost"), HasSubstr("'Goes'"), testing::Not(HasSubstr("'Stays'"))),
          AllOf(HasSubstr("object 'Driven'"), HasSubstr("location[0] = unknown(frame) and 1 more")),
          HasSubstr("script 'rig.py'"), AllOf(HasSubstr("'ViewLayer'"), HasSubstr("material override 'Clay'"))));
  ExpectColor(Named(scene.materials, "MissingTexture").base_color, glm::vec3(1.0f), "as the warning says");
  EXPECT_LT(Named(scene.materials, "MissingTexture").base_color_texture.texture, 0);
  for (const char* name : {"PackedTexture", "GeneratedTexture"}) {
    EXPECT_GE(Named(scene.materials, name).base_color_texture.texture, 0) << name;
  }
  const std::map<std::string, Box> boxes = Boxes(scene);
  for (const char* name : {"Lost", "LostToo", "Goes"}) EXPECT_FALSE(boxes.count(name)) << name;
  ASSERT_TRUE(boxes.count("Stays") && boxes.count("Driven"));
  EXPECT_NEAR(boxes.at("Driven").low.y, 6.5, 1e-6) << "a driver that needs no script works";
}

TEST(BlenderCameras, TheActiveOneComesFirst) {
  const Scene scene = Loaded("cameras");
  ASSERT_EQ(scene.cameras.size(), 7u);
  EXPECT_EQ(scene.cameras.front().name, "Shifted");
  EXPECT_THAT(scene.warnings, testing::ElementsAre(HasSubstr("'Panorama'")));
}

TEST(BlenderCameras, ProjectAsBlenderDoesInEveryPicture) {
  const Scene scene = Loaded("cameras");
  for (const auto& [name, entry] : BlenderCases::Expected("cameras").items()) {
    const Camera& camera = Named(scene.cameras, name);
    for (const auto& [size, rows] : entry["projection"].items()) {
      const int width = std::stoi(size), height = std::stoi(size.substr(size.find('x') + 1));
      const auto rays = CameraRays::Make(camera, width, height);
      ASSERT_TRUE(rays) << rays.error().message;
      const GuideCamera ours = rays->ToGuideCamera();
      for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) {
          const double theirs = rows[std::size_t(row)][std::size_t(column)];
          EXPECT_NEAR(ours.clip_from_view[column][row], theirs, 2e-6 * std::max(1.0, std::abs(theirs)))
              << name << " " << size << " row " << row << " column " << column;
        }
      }
      // A ray through the corner meets the corner of clip space.
      const ViewRay ray = rays->Through(width, 0.0);
      const glm::dvec4 clip = ours.clip_from_view * glm::dvec4(ray.origin + 3.0 * ray.direction, 1.0);
      EXPECT_NEAR(clip.x / clip.w, 1.0, 1e-12) << name;
      EXPECT_NEAR(clip.y / clip.w, 1.0, 1e-12) << name;
    }
    const auto& world = entry["world"];
    for (int column = 0; column < 4; ++column) {
      const glm::dvec3 theirs(world[0][std::size_t(column)], world[1][std::size_t(column)],
                              world[2][std::size_t(column)]);
      ExpectColor(glm::vec3(camera.world_from_camera[column]), glm::vec3(YUp(theirs)), name);
    }
  }
}

void ExpectLikeCycles(const GuideSet& ours, const CyclesPasses& theirs, const std::string& view) {
  ASSERT_EQ(ours.width(), theirs.width) << view;
  ASSERT_EQ(ours.height(), theirs.height) << view;
  const glm::dmat3 world_from_view = glm::transpose(glm::dmat3(ours.camera->view_from_world));
  const nlohmann::json& pass_indices = BlenderCases::Expected("rendered");
  std::vector<double> angles, depths, positions;
  std::size_t wrong_ids = 0, different_coverage = 0;
  for (std::size_t i = 0; i < ours.pixel_count(); ++i) {
    different_coverage += (ours.Plane(Layer::kCoverage)[i] > 0.5f) != (theirs.depth[i] < 1e9f);
  }
  const std::vector<std::size_t> inside = Eroded(ours);
  ASSERT_GT(inside.size(), ours.pixel_count() / 8) << view;
  for (std::size_t i : inside) {
    const glm::dvec3 normal = world_from_view * glm::dvec3(ours.Vec3(Layer::kNormal, i));
    const glm::dvec3 theirs_unit = glm::normalize(theirs.normal[i]);
    angles.push_back(
        glm::degrees(std::atan2(glm::length(glm::cross(normal, theirs_unit)), glm::dot(normal, theirs_unit))));
    const double depth = theirs.depth[i];
    depths.push_back(std::abs(ours.Plane(Layer::kDepth)[i] - depth) / depth);
    positions.push_back(glm::length(glm::dvec3(ours.Vec3(Layer::kPosition, i)) - theirs.position[i]) / depth);
    const std::string& name = ours.object_names.at(std::uint32_t(ours.Plane(Layer::kObject)[i]));
    const std::size_t slash = name.find('/');
    const std::string object = slash == std::string::npos ? name : name.substr(slash + 1);
    wrong_ids += pass_indices.at(object).get<float>() != theirs.index[i];
  }
  EXPECT_LT(Percentile(angles, 0.99), 0.01) << view << ": degrees";
  EXPECT_LT(Percentile(angles, 0.999), 0.1) << view << ": degrees";
  EXPECT_LT(Percentile(depths, 0.999), 1e-5) << view;
  EXPECT_LT(Percentile(positions, 0.999), 1e-5) << view;
  EXPECT_EQ(wrong_ids, 0u) << view;
  EXPECT_LE(double(different_coverage), 0.0002 * double(ours.pixel_count()) + 1.0) << view;
  testing::Test::RecordProperty(view + "_p99_degrees", std::to_string(Percentile(angles, 0.99)));
}

TEST(BlenderRenders, CyclesSeesTheSameSurfaces) {
  const std::vector<std::string> views = {"Auto:240x160",     "Auto:120x200",  "Shifted:240x160",
                                          "Vertical:240x160", "Ortho:200x200", "Ortho:120x200"};
  std::string all;
  for (const std::string& view : views) all += " " + view;
  BlenderCases::Render("rendered", all);
  const Scene scene = Loaded("rendered");
  for (const std::string& view : views) {
    const std::size_t colon = view.find(':');
    GuidegenOptions options;
    options.width = std::stoi(view.substr(colon + 1));
    options.height = std::stoi(view.substr(view.find('x') + 1));
    options.layers.Add(Layer::kPosition);
    const auto ours = RenderGuides(scene, Named(scene.cameras, view.substr(0, colon)), options);
    ASSERT_TRUE(ours) << ours.error().message;
    std::string file = view;
    file[colon] = '-';
    ExpectLikeCycles(ours->guides, ReadCycles(BlenderCases::File(file + ".exr")), view);
  }
}

// At 250x170 the border runs from 53.25 to 194.25 and from below from 21.6 to 136.5.
TEST(BlenderRenders, BordersAreThoseOfItsOwnPictures) {
  BlenderCases::Render("bordered", "Auto:250x170 Shifted:250x170 Ortho:250x170");
  const Scene bordered = Loaded("bordered"), cropped = Loaded("cropped");
  for (const std::string camera : {"Auto", "Shifted", "Ortho"}) {
    const auto cast = [&](const Scene& scene, int width, int height) {
      GuidegenOptions options;
      options.width = width, options.height = height;
      options.layers.Add(Layer::kPosition);
      const auto ours = RenderGuides(scene, Named(scene.cameras, camera), options);
      EXPECT_TRUE(ours) << ours.error().message;
      return ours->guides;
    };
    const GuideSet frame = cast(bordered, 250, 170);
    ExpectLikeCycles(frame, ReadCycles(BlenderCases::File("Bordered-" + camera + "-250x170.exr")), camera);
    std::set<int> columns, rows;
    for (std::size_t i = 0; i < frame.pixel_count(); ++i) {
      if (frame.Plane(Layer::kCoverage)[i] > 0.0f) columns.insert(int(i) % 250), rows.insert(int(i) / 250);
    }
    EXPECT_EQ(*columns.begin(), 53) << camera;
    EXPECT_EQ(*columns.rbegin(), 193) << camera;
    EXPECT_EQ(*rows.rbegin(), 169 - 21) << camera;
    const Camera& crop = Named(cropped.cameras, camera);
    ASSERT_TRUE(crop.border && crop.border->crop);
    EXPECT_EQ(crop.border_size, "141x115");
    ExpectLikeCycles(cast(cropped, 141, 115), ReadCycles(BlenderCases::File("Cropped-" + camera + "-250x170.exr")),
                     camera + " cropped");
  }
}

TEST(BlenderExtras, BrokenOnesAreNamed) {
  const TemporaryFolder folder;
  const auto load = [&](const std::string& extras) {
    std::ofstream(folder / "s.gltf")
        << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"L","extras":{"scumble":)"
        << extras << "}}]}";
    return LoadScene(folder / "s.gltf");
  };
  EXPECT_TRUE(load(R"({"lamp":{"type":"SUN","color":[1,1,1],"energy":2,"angle":0}})"));
  EXPECT_TRUE(load("3")) << "somebody else's";
  const auto wide = load(R"({"lamp":{"type":"SUN","color":[1,1,1],"energy":2,"angle":3.1415927410125732}})");
  ASSERT_TRUE(wide);
  EXPECT_EQ(wide->lights.at(0).angle_degrees, 180.0) << "Blender's most, a float above pi";
  for (const char* lamp :
       {R"({"type":"MOON","color":[1,1,1],"energy":2})", R"({"type":"SUN","color":[1,1],"energy":2})",
        R"({"type":"SUN","color":[1,1,1],"energy":-2,"angle":0})", R"({"type":"SUN"})", "7",
        R"({"type":"AREA","color":[1,1,1],"energy":2,"shape":"STAR","size":1,"size_y":1})"}) {
    const auto scene = load(std::string(R"({"lamp":)") + lamp + "}");
    ASSERT_FALSE(scene) << lamp;
    EXPECT_EQ(scene.error().kind, ErrorKind::kInput) << lamp;
    EXPECT_THAT(scene.error().message, AllOf(HasSubstr("'L'"), HasSubstr("extras of scumble"))) << lamp;
  }
  const auto dark = load(R"({"lamp":{"type":"AREA","color":[1,1,1],"energy":2,"shape":"DISK","size":0,"size_y":1}})");
  ASSERT_TRUE(dark);
  EXPECT_EQ(dark->lights.at(0).intensity, 0.0) << "a lamp without an area gives no light";
}

}  // namespace
}  // namespace scumble
