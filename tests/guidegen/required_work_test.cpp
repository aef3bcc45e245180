// Only required work: the ray caster's casts, evaluations and allocations, counted, against formulas. Each expectation
// is an exact number, so that a scene or a style that begins to pay for an unused feature fails here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "core/image/plane_count.h"
#include "guidegen/scene_textures.h"
#include "tests/support/light_path_scenes.h"

namespace scumble {
namespace {

using namespace testing;

// Odd on purpose: packets and tiles that are not full are cast for the pixels that there are.
constexpr int kWidth = 37, kHeight = 21;
constexpr std::size_t kPixels = std::size_t(kWidth) * kHeight;
constexpr int kSamples = 5;

GuidegenOptions Asking(LayerSet layers) {
  GuidegenOptions options = Sized(kWidth, kHeight, layers);
  options.samples = kSamples;
  return options;
}

// A sun that shines along −Z, or back along +Z.
Light Sun(bool from_behind = false) {
  Light sun = PointLight({0, 0, 0}, 2.0);
  sun.type = LightType::kSun;
  if (from_behind) sun.world_from_light = glm::rotate(glm::dmat4(1.0), kPi, glm::dvec3(0, 1, 0));
  return sun;
}

// Half a metre wide and far enough away to be looked for by points on it alone, not by directions as well.
Light Panel() {
  Light panel = Above(LightType::kArea, 5.0, 3.0);
  panel.size_x = panel.size_y = 0.5;
  return panel;
}

// A texture that must not be decoded: the test fails if it is.
std::shared_ptr<const EncodedTexture> Untouchable() {
  auto texture = std::make_shared<EncodedTexture>();
  texture->decode = []() -> Expected<Picture> {
    ADD_FAILURE() << "decoded a texture that no layer needs";
    return Picture(1, 1);
  };
  return texture;
}

// A floor that fills every pixel and faces every light above it, seen from straight above.
Scene WholeFloor() { return Floor(Painted(Bsdf::kDiffuse, 0.5f), 20.0); }
Camera AboveFloor() { return FlatCamera(10.0, 1.0); }

int AddTexture(Scene& scene) {
  Picture picture(2, 2);
  for (std::uint16_t& value : picture.rgba) value = 40000;
  scene.textures.push_back(picture);
  return int(scene.textures.size()) - 1;
}

std::size_t PlaneBytes(const LayerSet& asked) {
  std::size_t channels = 0;
  for (const LayerInfo& info : AllLayers()) {
    if (AlwaysWritten().Has(info.layer) || asked.Has(info.layer)) channels += info.channels.size();
  }
  return channels * kPixels * sizeof(float);
}

// Counts that are not listed are 0.
struct Counts {
  std::size_t shadow = 0, bounce = 0, light_samples = 0, materials = 0, texture_lookups = 0, texels = 0;
};

// Renders and expects exactly these counts, one primary ray a pixel, the layers asked for, and their planes alone.
GuidegenResult ExpectWork(const Scene& scene, const Camera& camera, const GuidegenOptions& options,
                          const Counts& expected) {
  const std::size_t before = PlaneBytesHandedOut();
  GuidegenResult result = Render(scene, camera, options);
  EXPECT_EQ(result.rays.primary, kPixels) << "a ray through each pixel's centre, and no other";
  EXPECT_EQ(result.rays.coverage, 0u);
  EXPECT_EQ(result.rays.shadow, expected.shadow);
  EXPECT_EQ(result.rays.bounce, expected.bounce);
  EXPECT_EQ(result.work.light_samples, expected.light_samples);
  EXPECT_EQ(result.work.materials, expected.materials);
  EXPECT_EQ(result.work.texture_lookups, expected.texture_lookups);
  EXPECT_EQ(result.work.texels, expected.texels);
  EXPECT_EQ(result.work.plane_bytes, PlaneBytes(options.layers));
  EXPECT_EQ(PlaneBytesHandedOut() - before, result.work.plane_bytes) << "no plane that is thrown away again";
  LayerSet layers = options.layers;
  EXPECT_TRUE(result.guides.layers() == layers.Add(AlwaysWritten())) << result.guides.layers().ToString();
  return result;
}

std::size_t Covered(const GuidegenResult& result) {
  const auto coverage = result.guides.Plane(Layer::kCoverage);
  return std::size_t(std::count_if(coverage.begin(), coverage.end(), [](float a) { return a > 0.0f; }));
}

// The scene has every costly feature: lights with and without extent, a world that emits, an emissive material,
// textures on it. A style of normals pays for none of them.
TEST(RequiredWork, NormalsAloneCostOneRayAPixel) {
  Scene scene = SceneOf(CubeMesh(), glm::rotate(glm::dmat4(1.0), 0.6, glm::dvec3(1, 2, 3)));
  for (Mesh& mesh : scene.meshes) mesh.uvs[0].assign(mesh.positions.size(), glm::vec2(0.25f));
  Material& material = scene.materials[0];
  for (TextureUse* use :
       {&material.base_color_texture, &material.metallic_roughness_texture, &material.emission_texture}) {
    use->texture = int(scene.textures.size());
    scene.textures.emplace_back();
    scene.encoded_textures.push_back(Untouchable());
  }
  material.emission = glm::vec3(4.0f);
  scene.world_radiance = glm::vec3(1.0f);
  scene.lights = {Sun(), Panel(), PointLight({1, 2, 3}, 5.0)};
  const GuidegenOptions options = Asking({});
  const Expected<DecodedTextures> decoded = DecodeTextures(scene, options);
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(decoded->count, 0);
  const GuidegenResult result = ExpectWork(scene, FrontCamera(5.0), options, {});
  EXPECT_GT(Covered(result), 0u);
  EXPECT_EQ(result.work.filtered_hits, 0u) << "what shines stops camera rays as any surface does, unasked";
  EXPECT_EQ(result.samples, 0);
  // Neither do positions, rest positions, or normals in the eye's frame need materials or lights.
  GuidegenOptions geometry = Asking({Layer::kPosition, Layer::kPref});
  geometry.normal_frame = NormalFrame::kEye;
  ExpectWork(scene, FrontCamera(5.0), geometry, {});
}

// Subsamples are the one thing that antialiasing adds: N² rays for each pixel that is not covered all over for certain.
TEST(RequiredWork, CoverageRaysAreCastOnlyWhereAnEdgeMayBe) {
  GuidegenOptions options = Asking({});
  options.aa = 3;
  const GuidegenResult whole = Render(WholeFloor(), AboveFloor(), options);
  // Pixels known to be covered have four neighbours of their own tile on the same triangle. At least the tiles' borders
  // and the diagonal are not; all others are.
  EXPECT_LT(whole.rays.coverage, 9 * kPixels / 2);
  EXPECT_EQ(whole.rays.coverage % 9, 0u) << "nothing is missed, so no pixel is looked at again";
  Scene empty = WholeFloor();
  empty.instances.clear();
  EXPECT_EQ(Render(empty, AboveFloor(), options).rays.coverage, 9 * kPixels) << "nothing tells that a pixel is empty";
  EXPECT_EQ(whole.rays.shadow + whole.work.materials + whole.work.light_samples, 0u);
}

TEST(RequiredWork, PlanesAreThoseOfTheLayersAskedFor) {
  Scene scene = WholeFloor();
  scene.lights = {Sun()};
  for (const LayerInfo& info : AllLayers()) {
    if (AlwaysWritten().Has(info.layer) || info.layer == Layer::kMotion) continue;
    const std::size_t before = PlaneBytesHandedOut();
    const GuidegenResult result = Render(scene, AboveFloor(), Asking({info.layer}));
    EXPECT_EQ(result.work.plane_bytes, PlaneBytes({info.layer})) << info.name;
    EXPECT_EQ(PlaneBytesHandedOut() - before, PlaneBytes({info.layer})) << info.name;
  }
}

// White Lambert needs no material, so neither does luminance: one shadow ray for each covered pixel and each sun that
// faces it. Each sun is asked once a pixel; one that shines from behind costs no ray.
TEST(RequiredWork, ASunCostsOneShadowRayForEachPixelThatFacesIt) {
  Scene scene = WholeFloor();
  scene.materials[0].base_color_texture.texture = AddTexture(scene);
  scene.lights = {Sun()};
  ExpectWork(scene, AboveFloor(), Asking({Layer::kLuminance}), {.shadow = kPixels, .light_samples = kPixels});
  ExpectWork(scene, AboveFloor(), Asking({Layer::kShadow}), {.shadow = kPixels, .light_samples = kPixels});
  // Both layers are read off the same rays.
  ExpectWork(scene, AboveFloor(), Asking({Layer::kLuminance, Layer::kShadow}),
             {.shadow = kPixels, .light_samples = kPixels});
  scene.lights = {Sun(), Sun(true), PointLight({0, 0, 4}, 1.0)};
  ExpectWork(scene, AboveFloor(), Asking({Layer::kLuminance}), {.shadow = 2 * kPixels, .light_samples = 3 * kPixels});
  // Flat faces show by their normal, in the layer itself, whether they face the sun's +Z.
  Scene cube = SceneOf(CubeMesh(), glm::rotate(glm::dmat4(1.0), 1.1, glm::dvec3(1, 2, 3)));
  cube.lights = {Sun()};
  cube.lights[0].world_from_light = glm::rotate(glm::dmat4(1.0), 1.3, glm::dvec3(0.6, 1.0, 0.0));
  const glm::vec3 to_sun(cube.lights[0].world_from_light[2]);
  const GuidegenResult seen = Render(cube, FrontCamera(5.0), Asking({}));
  std::size_t facing = 0;
  for (std::size_t i = 0; i < kPixels; ++i) facing += glm::dot(seen.guides.Vec3(Layer::kNormal, i), to_sun) > 0.0f;
  ASSERT_GT(facing, 0u);
  ASSERT_LT(facing, Covered(seen));
  ExpectWork(cube, FrontCamera(5.0), Asking({Layer::kLuminance}), {.shadow = facing, .light_samples = Covered(seen)});
}

// A light that is small in the sky is sampled by points on it, each with its shadow ray, because all of it faces all of
// the floor. Few lights are each sampled.
TEST(RequiredWork, AnAreaLightCostsItsSamples) {
  Scene scene = WholeFloor();
  scene.lights = {Panel()};
  const std::size_t all = kSamples * kPixels;
  ExpectWork(scene, AboveFloor(), Asking({Layer::kLuminance}), {.shadow = all, .light_samples = all});
  scene.lights = {Panel(), Panel()};
  ExpectWork(scene, AboveFloor(), Asking({Layer::kLuminance}), {.shadow = 2 * all, .light_samples = 2 * all});
  scene.lights = {Panel(), Sun()};
  ExpectWork(scene, AboveFloor(), Asking({Layer::kLuminance}),
             {.shadow = all + kPixels, .light_samples = all + kPixels});
  // With an allowed error, four samples show that nothing is in the way, eight at the borders of tiles.
  GuidegenOptions few = Asking({Layer::kLuminance});
  few.light_error = 0.05, few.samples = 64;
  scene.lights = {Panel()};
  std::size_t first = 0;
  for (int i = 0; i < int(kPixels); ++i) {
    const int column = i % kWidth % 16, row = i / kWidth % 16;
    first += column == 0 || column == 15 || row == 0 || row == 15 ? 8 : 4;
  }
  ExpectWork(scene, AboveFloor(), few, {.shadow = first, .light_samples = first});
  // One that is turned away is sampled in vain, and no ray is cast for it.
  scene.lights = {Panel()};
  scene.lights[0].world_from_light *= glm::rotate(glm::dmat4(1.0), kPi, glm::dvec3(0, 1, 0));
  ExpectWork(scene, AboveFloor(), Asking({Layer::kLuminance}), {.light_samples = all});
}

// Each pixel's material is asked once for its colour: four texels where the texture is interpolated, one where not.
TEST(RequiredWork, ColourCostsOneLookAtTheMaterialOfEachPixel) {
  Scene scene = WholeFloor();
  scene.lights = {Sun(), Panel()};
  ExpectWork(scene, AboveFloor(), Asking({Layer::kAlbedo}), {.materials = kPixels});
  scene.materials[0].base_color_texture.texture = AddTexture(scene);
  ExpectWork(scene, AboveFloor(), Asking({Layer::kAlbedo}),
             {.materials = kPixels, .texture_lookups = kPixels, .texels = 4 * kPixels});
  scene.materials[0].base_color_texture.nearest = true;
  ExpectWork(scene, AboveFloor(), Asking({Layer::kAlbedo}),
             {.materials = kPixels, .texture_lookups = kPixels, .texels = kPixels});
}

// Normal maps and bumps belong to the normals, and cost nothing else.
TEST(RequiredWork, ABumpCostsThreeLookupsAPixel) {
  Scene scene = WholeFloor();
  scene.materials[0].bump.height_texture.texture = AddTexture(scene);
  EXPECT_EQ(NeededTextures(scene, Asking({})).back(), true);
  ExpectWork(scene, AboveFloor(), Asking({}), {.texture_lookups = 3 * kPixels, .texels = 12 * kPixels});
}

TEST(RequiredWork, ANormalMapCostsOneLookupAPixel) {
  Scene scene = WholeFloor();
  scene.meshes[0].tangents.assign(4, glm::vec4(1, 0, 0, 1));
  scene.materials[0].normal_texture.texture = AddTexture(scene);
  ExpectWork(scene, AboveFloor(), Asking({}), {.texture_lookups = kPixels, .texels = 4 * kPixels});
}

// Without a light nothing is lit, and a path that the scene's materials or the number of bounces rule out is not
// traced.
TEST(RequiredWork, PathsThatCannotExistCostNothing) {
  Scene dark = WholeFloor();
  dark.materials[0].base_color_texture.texture = 0;
  dark.textures.emplace_back();
  dark.encoded_textures.push_back(Untouchable());
  ASSERT_TRUE(DecodeTextures(dark, Asking(kAllPaths)).ok());
  ExpectWork(dark, AboveFloor(), Asking(kAllPaths), {});
  ExpectWork(dark, AboveFloor(), Asking({Layer::kLuminance, Layer::kShadow}), {});

  Scene scene = dark;  // of Lambert surfaces alone: no specular path
  scene.lights = {Sun(), Panel()};
  ASSERT_TRUE(DecodeTextures(scene, Asking({Layer::kLpeLSE})).ok());
  ExpectWork(scene, AboveFloor(), Asking({Layer::kLpeLSE}), {});
  GuidegenOptions direct = Asking({Layer::kLpeLDDE});
  direct.max_bounces = 0;
  ASSERT_TRUE(DecodeTextures(scene, direct).ok());
  ExpectWork(scene, AboveFloor(), direct, {});

  Scene mirror = scene;  // nor a diffuse one where all is GGX
  mirror.materials[0].bsdf = Bsdf::kGlossy;
  ExpectWork(mirror, AboveFloor(), Asking({Layer::kLpeLDE, Layer::kLpeLDDE, Layer::kLpeLD12E}), {});
}

// A sun on Lambert needs no chance: each pixel's material is asked once, one shadow ray goes to the sun.
TEST(RequiredWork, DirectDiffuseLightOfASunIsNotSampled) {
  Scene scene = WholeFloor();
  scene.materials[0].base_color_texture.texture = AddTexture(scene);
  scene.lights = {Sun()};
  const GuidegenResult result = ExpectWork(scene, AboveFloor(), Asking({Layer::kLpeLDE}),
                                           {.shadow = kPixels,
                                            .light_samples = kPixels,
                                            .materials = kPixels,
                                            .texture_lookups = kPixels,
                                            .texels = 4 * kPixels});
  EXPECT_EQ(result.samples, 0);
}

// On an open floor each path is reflected once, meets nothing and ends: one ray more for each sample, and the sun's.
// All five layers together cost what the longest of them does: they share their paths.
TEST(RequiredWork, FullPathsOnAnOpenFloor) {
  Scene scene = WholeFloor();
  scene.lights = {Sun()};
  const Counts expected{
      .shadow = kPixels, .bounce = kSamples * kPixels, .light_samples = kPixels, .materials = kPixels};
  ExpectWork(scene, AboveFloor(), Asking({Layer::kLpeFull}), expected);
  ExpectWork(scene, AboveFloor(), Asking(kAllPaths), expected);
}

// In a closed room with a light inside, every convex object sees it from everywhere. With one bounce, S samples cost: S
// rays that hit a wall, whose material is evaluated, and from there one to the light, beside the first surface's own.
TEST(RequiredWork, FullPathsInAClosedRoom) {
  Scene room = SceneOf(CubeMesh());
  room.materials[0] = Painted(Bsdf::kDiffuse, 0.5f);
  room.lights = {PointLight({0.1, 0.2, 0.3}, 1.0)};
  GuidegenOptions options = Asking({Layer::kLpeFull});
  options.max_bounces = 1;
  const std::size_t all = (1 + kSamples) * kPixels;
  for (const int threads : {1, 2, 3, 7}) {
    options.threads = threads;
    ExpectWork(room, FrontCamera(0.0, 60.0), options,
               {.shadow = all, .bounce = kSamples * kPixels, .light_samples = all, .materials = all});
  }
}

// Surfaces with holes are asked whether they let a ray pass, and only they: the price of a mask, at their own colour's.
TEST(RequiredWork, OnlySurfacesThatMayLetRaysPassAreAsked) {
  Scene scene = WholeFloor();
  scene.materials[0].alpha_mode = AlphaMode::kMask;
  scene.materials[0].base_color_texture.texture = AddTexture(scene);  // alpha 40000 / 65535 is above the cut-off
  const GuidegenResult masked = Render(scene, AboveFloor(), Asking({}));
  EXPECT_EQ(Covered(masked), kPixels);
  EXPECT_GE(masked.work.filtered_hits, kPixels) << "once for each ray, and once more where it meets the diagonal";
  EXPECT_LE(masked.work.filtered_hits, kPixels + std::max(kWidth, kHeight));
  EXPECT_EQ(masked.work.materials, masked.work.filtered_hits);
  EXPECT_EQ(masked.work.texture_lookups, masked.work.filtered_hits);
  scene.materials[0].alpha_mode = AlphaMode::kOpaque;
  scene.materials[0].double_sided = false;
  const GuidegenResult single = Render(scene, AboveFloor(), Asking({}));
  EXPECT_GE(single.work.filtered_hits, kPixels) << "its back is not seen";
  EXPECT_EQ(single.work.materials, 0u) << "which the triangle tells, not its colour";
}

// What every layer needs of a material's four textures.
TEST(RequiredWork, TexturesThatLayersNeed) {
  Scene scene = WholeFloor();
  scene.meshes[0].tangents.assign(4, glm::vec4(1, 0, 0, 1));
  Material& material = scene.materials[0];
  material.bsdf = Bsdf::kMetallicRoughness;
  material.emission = glm::vec3(1.0f);
  int next = 0;
  for (TextureUse* use : {&material.normal_texture, &material.base_color_texture, &material.metallic_roughness_texture,
                          &material.emission_texture}) {
    use->texture = next++;
    scene.textures.emplace_back(1, 1);
  }
  const auto needed = [&](LayerSet layers) { return NeededTextures(scene, Asking(layers)); };
  using Needed = std::vector<bool>;  // normal, base colour, roughness, emission
  EXPECT_EQ(needed({}), (Needed{true, false, false, false}));
  EXPECT_EQ(needed({Layer::kPosition, Layer::kPref}), (Needed{true, false, false, false}));
  EXPECT_EQ(needed({Layer::kAlbedo}), (Needed{true, true, false, false}));
  EXPECT_EQ(needed({Layer::kLuminance}), (Needed{true, false, false, true}));
  EXPECT_EQ(needed({Layer::kShadow}), (Needed{true, false, false, true}));
  EXPECT_EQ(needed({Layer::kLpeLDE}), (Needed{true, true, true, true}));
  material.alpha_mode = AlphaMode::kBlend;
  EXPECT_EQ(needed({}), (Needed{true, true, false, false})) << "holes are the shape";
  material.alpha_mode = AlphaMode::kOpaque;
  material.emission = glm::vec3(0.0f);
  EXPECT_EQ(needed({Layer::kLuminance}), (Needed{true, false, false, false}));
  EXPECT_EQ(needed({Layer::kLpeLDE}), (Needed{true, false, false, false})) << "no light, no path";
  scene.meshes[0].tangents.clear();
  EXPECT_EQ(needed({}), (Needed{false, false, false, false}));
  scene.meshes[0].uvs[0].clear();
  EXPECT_EQ(needed({Layer::kAlbedo}), (Needed{false, false, false, false})) << "nowhere to be seen";
  scene.instances.clear();
  scene.meshes[0].uvs[0].assign(4, glm::vec2(0.0f));
  EXPECT_EQ(needed({Layer::kAlbedo}), (Needed{false, false, false, false})) << "shown by nobody";
}

}  // namespace
}  // namespace scumble
