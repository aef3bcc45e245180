// Normal maps and bumps against their formulas.
#include "guidegen/surface/normal_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "guidegen/guidegen.h"
#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"

namespace scumble::testing {
namespace {

void ExpectNormalNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  EXPECT_LE(glm::length(a - b), tolerance)
      << a.x << " " << a.y << " " << a.z << " against " << b.x << " " << b.y << " " << b.z;
}

std::uint16_t Stored(double value) { return std::uint16_t(std::lround(value * 65535.0)); }

// One normal all over a square.
Scene Mapped(const glm::dvec3& normal, NormalMapRule rule, float strength, const glm::dmat4& placed = glm::dmat4(1.0)) {
  Scene scene = SceneOf(QuadMesh(), placed);
  Picture picture(1, 1);
  for (int i = 0; i < 3; ++i) picture.rgba[std::size_t(i)] = Stored(normal[i] * 0.5 + 0.5);
  scene.textures.push_back(picture);
  scene.materials[0].normal_texture.texture = 0;
  scene.materials[0].normal_rule = rule;
  scene.materials[0].normal_scale = strength;
  scene.meshes[0].tangents.assign(4, {1, 0, 0, 1});
  return scene;
}

glm::dvec3 NormalOf(const Scene& scene, const Camera& camera = FlatCamera(3.0, 0.5)) {
  GuidegenOptions options = Sized(2, 2);
  options.raw_normals = true;
  return Render(scene, camera, options).guides.Vec3(Layer::kNormal, 0);
}

const glm::dvec3 kStored = glm::normalize(glm::dvec3(1, 2, 2));

TEST(NormalMaps, StrengthIsTheRulesOwn) {
  ExpectNormalNear(NormalOf(Mapped(kStored, NormalMapRule::kGltf, 0.5f)),
                   glm::normalize(glm::dvec3(0.5 * kStored.x, 0.5 * kStored.y, kStored.z)), 1e-4);
  for (const float strength : {0.0f, 0.5f, 1.0f, 1.7f}) {
    const glm::dvec3 mixed = glm::mix(glm::dvec3(0, 0, 1), kStored, double(strength));
    ExpectNormalNear(NormalOf(Mapped(kStored, NormalMapRule::kTangent, strength)), glm::normalize(mixed), 1e-4);
  }
}

TEST(NormalMaps, ObjectSpaceHasBlendersAxesAndTurnsWithTheObject) {
  const glm::dmat4 turned = glm::rotate(glm::dmat4(1.0), 0.4, glm::dvec3(1, 2, 3));
  Scene scene = Mapped(kStored, NormalMapRule::kObject, 1.0f, turned);
  scene.meshes[0].tangents.clear();
  const glm::dmat3 turn(turned);
  ExpectNormalNear(NormalOf(scene), turn * glm::dvec3(kStored.x, kStored.z, -kStored.y), 1e-4);
  scene.materials[0].normal_rule = NormalMapRule::kBlenderObject;
  ExpectNormalNear(NormalOf(scene), turn * glm::dvec3(kStored.x, -kStored.z, kStored.y), 1e-4);
}

// The interpolated normal and tangent are not made unit: half-way between two normals, the map's x counts for more.
TEST(NormalMaps, TheFrameIsInterpolatedAsItIs) {
  Scene scene = Mapped(kStored, NormalMapRule::kTangent, 1.0f);
  const glm::vec3 left = glm::normalize(glm::vec3(-1, 0, 1)), right = glm::normalize(glm::vec3(1, 0, 1));
  scene.meshes[0].normals = {left, right, right, left};
  scene.meshes[0].tangents.assign(4, {0, 1, 0, 1});
  // In the middle, n is √½ long and n × t is as long.
  const double shorter = std::sqrt(0.5);
  const glm::dvec3 expected = glm::normalize(glm::dvec3(-kStored.y * shorter, kStored.x, kStored.z * shorter));
  GuidegenOptions options = Sized(1, 1);
  options.raw_normals = true;
  ExpectNormalNear(Render(scene, FlatCamera(3.0, 0.5), options).guides.Vec3(Layer::kNormal, 0), expected, 1e-4);
}

// An object that its matrix stretches, and the same with the stretch in its mesh, which says so.
TEST(NormalMaps, AStretchInTheMeshIsUndone) {
  const glm::dvec3 sizes(2.0, 0.5, 3.0);
  Scene one = Mapped(kStored, NormalMapRule::kTangent, 1.0f, glm::scale(glm::dmat4(1.0), sizes));
  const std::vector<glm::vec3> normals = {{-0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}, {0, -0.6f, 0.8f}};
  one.meshes[0].normals = normals;
  Scene other = one;
  other.instances[0].world_from_object = glm::dmat4(1.0);
  Mesh& mesh = other.meshes[0];
  mesh.stretch = glm::dmat3(glm::dvec3(sizes.x, 0, 0), glm::dvec3(0, sizes.y, 0), glm::dvec3(0, 0, sizes.z));
  for (glm::vec3& position : mesh.positions) position *= glm::vec3(sizes);
  for (glm::vec3& normal : mesh.normals) normal = glm::normalize(normal / glm::vec3(sizes));
  ExpectNormalNear(NormalOf(one), NormalOf(other), 1e-6);
  for (Scene* scene : {&one, &other}) scene->materials[0].normal_rule = NormalMapRule::kObject;
  ExpectNormalNear(NormalOf(one), NormalOf(other), 1e-6);
}

// A ramp from black on the left to white on the right, over a square of 2 m.
Scene Ramp(const Bump& bump) {
  constexpr int kTexels = 64;
  Scene scene = SceneOf(QuadMesh());
  Picture picture(kTexels, 1);
  for (int x = 0; x < kTexels; ++x) {
    for (int i = 0; i < 3; ++i) picture.rgba[std::size_t(4 * x + i)] = Stored((x + 0.5) / kTexels);
  }
  scene.textures.push_back(picture);
  scene.materials[0].bump = bump;
  scene.materials[0].bump.height_texture.texture = 0;
  return scene;
}

// It rises by half its distance on each metre.
glm::dvec3 Risen(double distance) { return glm::normalize(glm::dvec3(-0.5 * distance, 0, 1)); }

TEST(Bumps, ARampHasTheNormalOfASlope) {
  ExpectNormalNear(NormalOf(Ramp({.distance = 0.8f})), Risen(0.8), 1e-3);
  ExpectNormalNear(NormalOf(Ramp({.distance = -0.8f})), Risen(-0.8), 1e-3);
  ExpectNormalNear(NormalOf(Ramp({.distance = 0.8f}), FrontCamera(3.0, 10.0)), Risen(0.8), 1e-3);
  ExpectNormalNear(NormalOf(Ramp({.distance = 0.8f, .strength = 0.4f})),
                   glm::normalize(glm::mix(glm::dvec3(0, 0, 1), Risen(0.8), 0.4)), 1e-3);
  ExpectNormalNear(NormalOf(Ramp({.distance = 0.8f, .strength = 0.0f})), glm::dvec3(0, 0, 1), 1e-6);
}

TEST(Bumps, DoNotDependOnHowTheWorldTurns) {
  Scene scene = Ramp({.distance = 0.8f});
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), 1.1, glm::dvec3(1, -2, 0.5));
  Camera camera = FlatCamera(3.0, 0.5);
  const glm::dvec3 before = NormalOf(scene, camera);
  scene.instances[0].world_from_object = turn;
  camera.world_from_camera = turn * camera.world_from_camera;
  ExpectNormalNear(NormalOf(scene, camera), before, 1e-4);
}

TEST(Bumps, RiseOnTheSideOfTheNormalAlsoSeenFromBehind) {
  const Camera behind = LookingAt({0, 0, -3}, {0, 0, 0}, 10.0);
  // That camera's axes: x and z are turned round. The slope's own normal is Risen; its back looks the other way.
  const glm::dvec3 slope = Risen(0.8);
  ExpectNormalNear(NormalOf(Ramp({.distance = 0.8f}), behind), {slope.x, 0, slope.z}, 1e-3);
}

TEST(Bumps, ColouredHeightsAreDecoded) {
  const Scene plain = Ramp({.distance = 0.8f});
  const Scene colour = Ramp({.srgb = true, .distance = 0.8f});
  // In the middle the ramp's value is 0.5, where sRGB's curve rises by 2.4/1.055·((0.5 + 0.055)/1.055)^1.4.
  const double rise = 2.4 / 1.055 * std::pow(0.555 / 1.055, 1.4);
  GuidegenOptions options = Sized(2, 2);
  options.raw_normals = true;
  const Camera near = FlatCamera(3.0, 0.01);
  ExpectNormalNear(Render(colour, near, options).guides.Vec3(Layer::kNormal, 0), Risen(0.8 * rise), 3e-3);
  ExpectNormalNear(Render(plain, near, options).guides.Vec3(Layer::kNormal, 0), Risen(0.8), 3e-3);
}

TEST(Bumps, LieOnTheMappedNormal) {
  Scene scene = Ramp({.distance = 0.8f});
  const glm::dvec3 mapped = glm::normalize(glm::dvec3(0, 0.6, 0.8));
  Picture picture(1, 1);
  for (int i = 0; i < 3; ++i) picture.rgba[std::size_t(i)] = Stored(mapped[i] * 0.5 + 0.5);
  scene.textures.push_back(picture);
  scene.materials[0].normal_texture.texture = 1;
  scene.materials[0].normal_rule = NormalMapRule::kTangent;
  scene.meshes[0].tangents.assign(4, {1, 0, 0, 1});
  // det is dx · (dy × n) = n.z for unit steps, and the gradient 0.4 (dy × n) along x.
  const glm::dvec3 across = glm::cross(glm::dvec3(0, 1, 0), mapped);
  ExpectNormalNear(NormalOf(scene), glm::normalize(mapped * mapped.z - across * 0.4), 1e-3);
}

TEST(Bumps, WithoutCoordinatesThereIsNone) {
  Scene scene = Ramp({.distance = 0.8f});
  scene.meshes[0].uvs[0].clear();
  ExpectNormalNear(NormalOf(scene), glm::dvec3(0, 0, 1), 0.0);
}

}  // namespace
}  // namespace scumble::testing
