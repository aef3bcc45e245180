// Samples of direct light under lamps with extent: packets of rays against one ray after the other, and pixels that
// choose how many samples they take against many samples.
#include "guidegen/light/area_light_tile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "guidegen/rays/single_ray.h"
#include "tests/support/light_path_scenes.h"

namespace scumble::testing {
namespace {

constexpr int kTileSize = 16;  // of a tile
const LayerSet kLight = {Layer::kLuminance, Layer::kShadow};

Light Square(const glm::dvec3& at, double size, double radiance = 10.0) {
  Light light = PointLight(at, radiance);
  light.type = LightType::kArea;
  light.size_x = light.size_y = size;
  return light;
}

// A ball over a floor, and a thin bar across: shadows with wide and narrow penumbrae. Seen and lit from +Z.
Scene Stage(double lamp) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.7f), 3.0);
  AddObject(scene, "ball", BallMesh(24), glm::scale(Moved(-0.6, 0.3, 0.5), glm::dvec3(0.5)));
  AddObject(scene, "bar", CubeMesh(), glm::scale(Moved(0.7, 0, 0.8), glm::dvec3(0.03, 1.5, 0.03)));
  scene.lights = {Square({0.4, 0.6, 4.0}, lamp)};
  return scene;
}
const Camera kView = LookingAt({0, -3.0, 5.0}, {0, 0, 0}, 45.0);

GuidegenOptions Chosen(int width, int height, double error = kUnseenLightError) {
  GuidegenOptions options = Sized(width, height, kLight);
  options.light_error = error;
  return options;
}

// Every kind of light with extent; `many` more than are sampled individually.
Scene EveryLamp(int many) {
  Scene scene = Stage(0.8);
  Material glow = Painted(Bsdf::kDiffuse, 0.2f);
  glow.emission = glm::vec3(3.0f, 2.0f, 1.0f);
  Mesh panel = BallMesh(4);
  panel.material = AddMaterial(scene, glow);
  AddObject(scene, "glow", panel, glm::scale(Moved(1.2, -0.4, 0.4), glm::dvec3(0.2)));
  for (int i = 0; i < 4 + many; ++i) {
    Light light = PointLight({1.5 * std::cos(i), 1.5 * std::sin(i), 1.5 + 0.3 * i}, 3.0);
    light.type = LightType(i % 4);
    light.radius = 0.2, light.angle_degrees = 5.0, light.size_x = light.size_y = 0.4;
    scene.lights.push_back(light);
  }
  scene.world_radiance = glm::vec3(0.1f, 0.1f, 0.2f);
  return scene;
}

// A scene's lights, and the points that the rays of one tile's pixels meet.
struct LitTile {
  explicit LitTile(const Scene& scene) : camera(CameraRays::Make(kView, 4 * kTileSize, 4 * kTileSize).value()) {
    std::vector<PlacedObject> objects;
    for (const Instance& instance : scene.instances) {
      const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
      objects.push_back(Place(&mesh, &scene.materials[std::size_t(mesh.material)], scene.textures,
                              camera.ViewFromObject(instance.world_from_object)));
    }
    embree = std::make_unique<EmbreeScene>(
        EmbreeScene::Build(std::move(objects), "", {.light_rays = true, .emitters = true}).value());
    placed = PlaceLights(scene.lights, camera).value();
    lights = std::make_unique<LightSet>(placed, embree->objects(), scene.world_radiance);
    points.reserve(kTileSize * kTileSize);
    for (int i = 0; i < kTileSize * kTileSize; ++i) {
      const int column = i % kTileSize, row = i / kTileSize;
      const ViewRay ray = camera.Through(4.0 * column + 2.0, 4.0 * row + 2.0);  // every fourth pixel of a picture
      const RTCRayHit hit = CastSingleRay(*embree, ray.origin, ray.direction);
      if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
      points.push_back(FindSurfacePoint(embree->objects()[hit.hit.geomID], hit.hit.primID, ray));
      pixels.push_back({column, row, &points.back(), std::uint32_t(i), 0.0, {}});
    }
  }

  CameraRays camera;
  std::unique_ptr<EmbreeScene> embree;
  std::vector<PlacedLight> placed;
  std::unique_ptr<LightSet> lights;
  std::vector<SurfacePoint> points;
  std::vector<AreaLightPixel> pixels;
};

// The mean of `samples` samples of each term, one ray after the other.
AreaLighting PlainSamples(const EmbreeScene& scene, const LightSet& lights, const SurfacePoint& point,
                          const Sampler& sampler, int samples, RayCounts& rays) {
  const PointLighting lighting(scene, lights, point);
  const std::vector<int> terms = PointLighting::LightTerms(lights);
  AreaLighting sum;
  for (int i = 0; i < samples; ++i) {
    for (const int light : terms) {
      const PointLighting::Take take = lighting.TakeLight(light, sampler, std::uint32_t(i));
      if (!(take.light > 0.0)) continue;
      ++rays.shadow;
      sum += lighting.Resolve(take, lighting.IsBlocked(take), rays);
    }
    if (lighting.HasDirections()) sum += lighting.TakeDirection(sampler, std::uint32_t(i), rays);
  }
  return {sum.reached / samples, sum.unoccluded / samples};
}

// Packets, blocks and terms against one ray after the other, in every bit of the sums.
TEST(AreaLightTile, AFixedNumberIsTheMeanOfPlainSamples) {
  for (const int many : {0, 12}) {
    const Scene scene = EveryLamp(many);
    LitTile tile(scene);
    ASSERT_GT(tile.pixels.size(), 150u);
    ASSERT_EQ(tile.lights->FewHaveExtent(), many == 0);
    for (const int samples : {1, 3, 8, 21}) {
      const Progress none;
      ProgressGate gate(none, 1, 0.0, 1.0);
      RayCounts rays, plain_rays;
      std::vector<AreaLightPixel> pixels = tile.pixels;
      AreaLightTile soft(*tile.embree, *tile.lights, {samples, 0.0, 7});
      ASSERT_TRUE(soft.Run(pixels, gate, rays));
      for (const AreaLightPixel& pixel : pixels) {
        const AreaLighting plain = PlainSamples(*tile.embree, *tile.lights, *pixel.point,
                                                Sampler(pixel.index, kAreaLightStream, 7), samples, plain_rays);
        EXPECT_EQ(pixel.light.reached, plain.reached) << pixel.column << " " << pixel.row;
        EXPECT_EQ(pixel.light.unoccluded, plain.unoccluded) << pixel.column << " " << pixel.row;
      }
      EXPECT_EQ(rays.shadow, plain_rays.shadow);
    }
  }
}

// First samples of all pixels: four, and eight along the borders of tiles.
std::size_t FirstSamples(int width, int height) {
  std::size_t count = 0;
  const auto at_border = [](int at) { return at % kTileSize == 0 || at % kTileSize == kTileSize - 1; };
  for (int i = 0; i < width * height; ++i) count += at_border(i % width) || at_border(i / width) ? 8 : 4;
  return count;
}

// Where nothing is in the way, the first samples are enough, whatever may be taken; where all is, too.
TEST(AreaLightTile, PlainLightTakesTheFirstSamples) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.5f), 20.0);
  scene.lights = {Square({0, 0, 5.0}, 0.2)};  // all of it brings about the same
  const Camera above = FlatCamera(10.0, 1.0);
  EXPECT_EQ(Render(scene, above, Chosen(37, 21)).rays.shadow, FirstSamples(37, 21));
  AddObject(scene, "lid", QuadMesh(), glm::scale(Moved(0, 0, 3), glm::dvec3(4.0)));
  const Camera below = LookingAt({0, -2, 2.0}, {0, 0, 0}, 20.0);
  EXPECT_EQ(Render(scene, below, Chosen(37, 21)).rays.shadow, FirstSamples(37, 21));
  GuidegenOptions two = Chosen(37, 21);
  two.samples = 2;
  EXPECT_EQ(Render(scene, below, two).rays.shadow, 2u * 37 * 21) << "the most there may be is less";
}

// Whoever cuts light into steps looks at the attribute.
TEST(AreaLightTile, LightWithoutChanceIsSaidToBeExact) {
  Scene scene = Stage(0.5);
  const Camera above = FlatCamera(10.0, 1.0);
  EXPECT_FALSE(HasExactLight(Render(scene, above, Chosen(8, 8)).guides));
  scene.lights = {PointLight({0, 0, 4}, 10.0)};
  EXPECT_TRUE(HasExactLight(Render(scene, above, Chosen(8, 8)).guides));
  EXPECT_FALSE(HasExactLight(Render(scene, above, Sized(8, 8, {Layer::kAlbedo})).guides)) << "there is no light";
  scene.world_radiance = glm::vec3(0.1f);
  EXPECT_FALSE(HasExactLight(Render(scene, above, Chosen(8, 8)).guides));
}

struct Difference {
  double rms = 0.0, worst = 0.0;
  std::size_t rays = 0, most_rays = 0;
};

// Against 1,024 samples of another seed.
Difference AgainstMany(const Scene& scene, const GuidegenOptions& options) {
  GuidegenOptions many = options;
  many.light_error = 0.0, many.samples = 1024, many.seed = 5;
  const GuidegenResult truth = Render(scene, kView, many), seen = Render(scene, kView, options);
  const auto expected = truth.guides.Plane(Layer::kLuminance), shadow = truth.guides.Plane(Layer::kShadow);
  const auto actual = seen.guides.Plane(Layer::kLuminance);
  Difference difference;
  // Beside the light without occluders of the pixel; at terminators, where lamps set, beside a tenth of the brightest.
  const float brightest = *std::max_element(expected.begin(), expected.end());
  double count = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (!(expected[i] > 0.0f)) continue;
    const double open = expected[i] / std::max(1e-6, 1.0 - double(shadow[i]));
    const double error = std::abs(double(actual[i]) - expected[i]) / std::max(open, 0.1 * brightest);
    difference.rms += error * error, count += 1.0;
    difference.worst = std::max(difference.worst, error);
  }
  difference.rms = std::sqrt(difference.rms / count);
  difference.rays = seen.rays.shadow, difference.most_rays = truth.rays.shadow / 16;
  return difference;
}

// The promise of GuidegenOptions::light_error, and no pixel that stands out: five standard errors of 64 samples in the
// middle of a penumbra are below a tenth.
TEST(AreaLightTile, ErrorsStayBelowTheAllowedOne) {
  for (const double lamp : {0.1, 0.8, 3.0}) {
    const Difference found = AgainstMany(Stage(lamp), Chosen(96, 72));
    EXPECT_LT(found.rms, kUnseenLightError) << lamp;
    EXPECT_LT(found.worst, 0.1) << lamp;
    EXPECT_LT(2 * found.rays, found.most_rays) << lamp << ": less than half of 64 each";
  }
  // A coarser error is kept as well, with fewer rays.
  const Difference coarse = AgainstMany(Stage(0.8), Chosen(96, 72, 0.08));
  EXPECT_LT(coarse.rms, 0.08);
  EXPECT_LT(coarse.rays, AgainstMany(Stage(0.8), Chosen(96, 72)).rays);
}

// Lamps that directions look for, emitters, a sky, and more lamps than are sampled individually.
TEST(AreaLightTile, EveryKindOfLampKeepsTheError) {
  for (const int many : {0, 12}) {
    const Difference found = AgainstMany(EveryLamp(many), Chosen(64, 48));
    EXPECT_LT(found.rms, 1.5 * kUnseenLightError) << many << ": 64 samples are the most, and may be too few";
  }
}

// A row of globes that are one mesh, along a floor.
Scene Lanterns() {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.7f), 3.0);
  Material glow = Painted(Bsdf::kDiffuse, 0.2f);
  glow.emission = glm::vec3(8.0f);
  Mesh row, globe = BallMesh(12);
  for (int i = 0; i < 9; ++i) {
    const auto first = std::uint32_t(row.positions.size());
    for (const glm::vec3& at : globe.positions) row.positions.push_back(0.1f * at + glm::vec3(i - 0.5f, 0.2f, 0.8f));
    for (const glm::uvec3& corners : globe.triangles) row.triangles.push_back(corners + first);
  }
  row.material = AddMaterial(scene, glow);
  AddObject(scene, "lanterns", row, glm::dmat4(1.0));
  return scene;
}

// The error is that of most pixels, and is known to whoever reads the guides.
TEST(AreaLightTile, TheErrorThatIsReachedIsSaid) {
  GuidegenOptions options = Chosen(20, 15);
  const GuidegenResult fine = Render(Lanterns(), kView, options);
  EXPECT_GT(fine.light_error, 0.0);
  EXPECT_LT(fine.light_error, 0.1);
  EXPECT_NEAR(LightErrorOf(fine.guides), fine.light_error, 1e-9);
  options.samples = 16;
  EXPECT_GT(Render(Lanterns(), kView, options).light_error, 1.5 * fine.light_error);
  options.light_error = 0.0;
  const GuidegenResult fixed = Render(Lanterns(), kView, options);
  EXPECT_EQ(fixed.light_error, 0.0) << "it is not estimated";
  EXPECT_EQ(LightErrorOf(fixed.guides), 0.0);
}

// What shines is bright, whatever lights it.
TEST(AreaLightTile, EmissionIsLight) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.7f), 3.0);
  scene.lights = {PointLight({0, 0, 4}, 10.0)};
  const GuidegenOptions options = Chosen(5, 5, 0.0);
  const GuidegenResult dark = Render(scene, FlatCamera(3.0, 0.5), options);
  for (Material& material : scene.materials) material.emission = {1.0f, 2.0f, 3.0f};
  const GuidegenResult bright = Render(scene, FlatCamera(3.0, 0.5), options);
  const double emitted = 0.2126 + 2 * 0.7152 + 3 * 0.0722;
  for (std::size_t i = 0; i < dark.guides.pixel_count(); ++i) {
    const float received = dark.guides.Plane(Layer::kLuminance)[i];
    EXPECT_GT(received, 0.0f);
    EXPECT_NEAR(bright.guides.Plane(Layer::kLuminance)[i], received + emitted, 1e-5);
    EXPECT_EQ(bright.guides.Plane(Layer::kShadow)[i], dark.guides.Plane(Layer::kShadow)[i]);
  }
}

TEST(AreaLightTile, BytesDoNotDependOnThreads) {
  for (const int many : {0, 12}) {
    GuidegenOptions options = Chosen(161, 93);
    options.threads = 1;
    const GuidegenResult one = Render(EveryLamp(many), kView, options);
    options.threads = 5;
    const GuidegenResult five = Render(EveryLamp(many), kView, options);
    EXPECT_TRUE(SameBytes(one.guides, five.guides));
    EXPECT_EQ(one.rays.shadow, five.rays.shadow);
    options.seed = 3;
    EXPECT_FALSE(SameBytes(one.guides, Render(EveryLamp(many), kView, options).guides));
  }
}

// A lamp twice as bright makes no other decision: products with powers of two round nothing.
TEST(AreaLightTile, DecisionsAreRatios) {
  Scene scene = EveryLamp(0);
  const GuidegenResult one = Render(scene, kView, Chosen(64, 48));
  for (Light& light : scene.lights) light.intensity = std::ldexp(light.intensity, 30);
  for (Material& material : scene.materials) material.emission *= std::ldexp(1.0f, 30);
  scene.world_radiance *= std::ldexp(1.0f, 30);
  const GuidegenResult bright = Render(scene, kView, Chosen(64, 48));
  EXPECT_EQ(one.rays.shadow, bright.rays.shadow);
  for (std::size_t i = 0; i < one.guides.pixel_count(); ++i) {
    ASSERT_EQ(std::ldexp(one.guides.Plane(Layer::kLuminance)[i], 30), bright.guides.Plane(Layer::kLuminance)[i]);
    ASSERT_EQ(one.guides.Plane(Layer::kShadow)[i], bright.guides.Plane(Layer::kShadow)[i]);
  }
}

TEST(AreaLightTile, AnErrorThatIsNoneIsRefused) {
  for (const double error : {-0.1, double(NAN), double(INFINITY)}) {
    const auto refused = RenderGuides(Stage(0.5), kView, Chosen(8, 8, error));
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
  }
}

}  // namespace
}  // namespace scumble::testing
