// glTF's material model in the light-path layers, against its formulas written out again here: the white furnace at
// every roughness and metalness, the lobes under a sun, textures on every input, both sides of a sheet.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "guidegen/cycles_version.h"
#include "tests/support/light_path_scenes.h"

namespace scumble::testing {
namespace {

double Schlick(double cosine) { return std::pow(1.0 - cosine, 5.0); }

double SmithLambda(double cosine, double alpha) {
  const double tangent2 = 1.0 / (cosine * cosine) - 1.0;
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * tangent2) - 1.0);
}

double GgxD(double cosine, double alpha) {
  const double d = cosine * cosine * (alpha * alpha - 1.0) + 1.0;
  return alpha * alpha / (kPi * d * d);
}

// One colour channel of a material as the formulas want it.
struct Paint {
  double base = 1.0;
  double metallic = 0.0;
  double roughness = 1.0;
  bool cycles4 = false;
};

// Masking and shadowing: each for itself in Cycles 3, correlated by height in Cycles 4.
double SmithG2(const Paint& p, double eye, double light) {
  const double alpha = p.roughness * p.roughness;
  const double e = SmithLambda(eye, alpha), l = SmithLambda(light, alpha);
  return p.cycles4 ? 1.0 / (1.0 + e + l) : 1.0 / ((1.0 + e) * (1.0 + l));
}

// Radiance towards `eye` per irradiance of light from `light`, on a surface that faces +Z. What the diffuse lobe gets
// is (1 − F) at both angles, scaled so that it returns 1 − F of what comes in.
double DiffuseLobe(const Paint& p, const glm::dvec3& eye, const glm::dvec3& light) {
  const double mean_fresnel = 0.04 + 0.96 / 21.0;
  const double in = 0.96 * (1.0 - Schlick(light.z)), out = 0.96 * (1.0 - Schlick(eye.z));
  return p.base * (1.0 - p.metallic) * in * out / (1.0 - mean_fresnel) / kPi;
}

double SpecularLobe(const Paint& p, const glm::dvec3& eye, const glm::dvec3& light) {
  const double alpha = p.roughness * p.roughness;
  const glm::dvec3 half = glm::normalize(eye + light);
  const double f0 = 0.04 * (1.0 - p.metallic) + p.base * p.metallic;
  const double fresnel = f0 + (1.0 - f0) * Schlick(glm::dot(half, light));
  return fresnel * GgxD(half.z, alpha) * SmithG2(p, eye.z, light.z) / (4.0 * eye.z * light.z);
}

Material Coated(const Paint& p) {
  Material material = Painted(Bsdf::kMetallicRoughness, float(p.base), float(p.roughness));
  material.metallic = float(p.metallic);
  material.cycles4 = p.cycles4;
  return material;
}

// The floor's pixel at (x, 0), seen at 45° from below it in the picture.
Camera SlantedAt(double x) { return LookingAt({x, -3, 3}, {x, 0, 0}, 1e-4); }
const glm::dvec3 kSlantedEye(0.0, -std::sqrt(0.5), std::sqrt(0.5));

// A sun of strength 1, `angle` radians from the floor's normal, on the far side of the slanted eye.
Light SlantedSun(double angle) {
  Light sun = Above(LightType::kSun, 0.0, 1.0);
  sun.world_from_light = glm::rotate(glm::dmat4(1.0), -angle, glm::dvec3(1, 0, 0));
  return sun;
}
glm::dvec3 ToSun(double angle) { return {0.0, std::sin(angle), std::cos(angle)}; }

double Encoded(double stored) { return stored <= 0.04045 ? stored / 12.92 : std::pow((stored + 0.055) / 1.055, 2.4); }

// Two texels side by side, each over one half of the floor, without a transition.
TextureUse TwoTexels(Scene& scene, const std::vector<std::uint16_t>& left, const std::vector<std::uint16_t>& right) {
  Picture picture(2, 1);
  for (int c = 0; c < 3; ++c) {
    picture.rgba[std::size_t(c)] = left[std::size_t(c)];
    picture.rgba[std::size_t(4 + c)] = right[std::size_t(c)];
  }
  picture.rgba[3] = picture.rgba[7] = 65535;
  scene.textures.push_back(picture);
  TextureUse use;
  use.texture = int(scene.textures.size()) - 1;
  use.nearest = true;
  return use;
}

// What the lobes return of a sky of 1, by a sum of n × n directions whose error falls as n^-2. The diffuse one: 1 − F
// of the way out. The specular one: F · G2 times the cosine between eye and half vector over those of
// the two, in the mean over half vectors that are spread as D · cosine is: with tan² = α² (1 − q) / q for q even in
// [0, 1], and q = s⁴ to have more of them where they lie flat.
double Integrated(const Paint& p, double eye, int n) {
  const double alpha = p.roughness * p.roughness;
  const double f0 = 0.04 * (1.0 - p.metallic) + p.base * p.metallic;
  double sum = 0.0;
  for (int ring = 0; ring < n; ++ring) {
    const double s = (ring + 0.5) / n, q = s * s * s * s;
    const double z = std::sqrt(q / (q + alpha * alpha * (1.0 - q)));
    for (int column = 0; column < n; ++column) {
      const double around = kPi * (column + 0.5) / n;  // the other half is equal
      const double along = std::sqrt((1.0 - z * z) * (1.0 - eye * eye)) * std::cos(around) + z * eye;
      const double light = 2.0 * along * z - eye;
      if (!(along > 0.0) || !(light > 0.0)) continue;
      sum += 4.0 * s * s * s * (f0 + (1.0 - f0) * Schlick(along)) * SmithG2(p, eye, light) * along / z;
    }
  }
  const double specular = sum / (double(n) * n) / eye;
  return p.base * (1.0 - p.metallic) * 0.96 * (1.0 - Schlick(eye)) + specular;
}

// That integral's largest value is 1.00133, for a white dielectric of roughness 0.29 seen at 54.5°: Fresnel's curve
// bends up, so its mean over half vectors is above its value for their middle, which is what the base goes without.
constexpr double kMostReturned = 1.0014;

// A floor under a sky of 1, seen from `height`, 3 m aside, under one angle in all 64 pixels: these draw independently
// of each other, so their spread tells how sure their mean is. Five standard errors are passed less than once in
// 100,000 sets of seeds (Student's t with 63 degrees of freedom); and they would tell that 3% are missing.
void ExpectReturned(const Paint& paint, double height, int samples, double expected, double slack) {
  Scene scene = Floor(Coated(paint));
  scene.world_radiance = glm::vec3(1.0f);
  const auto result = Render(scene, LookingAt({0, -3, height}, {0, 0, 0}, 1e-4), Paths(8, {Layer::kLpeFull}, samples));
  ExpectFinite(result);
  const double mean = Mean(result, Layer::kLpeFull);
  double squares = 0.0;
  for (const float value : result.guides.Plane(Layer::kLpeFull, 1)) squares += (value - mean) * (value - mean);
  const double error = std::sqrt(squares / (64.0 * 63.0));
  EXPECT_NEAR(mean, expected, 5.0 * error + slack + 0x1.0p-24)
      << paint.base << " roughness " << paint.roughness << " metallic " << paint.metallic << " from " << height;
  EXPECT_LT(5.0 * error, 0.03);
}

// A sphere has all angles, and normals that are not its facets'. Of two renders that differ in nothing but their seed
// each pixel's mean is off by half of their difference, root mean square; the squares add up, as pixels draw
// independently.
TEST(MaterialFurnace, AWhiteSurfaceNeverReturnsMoreThanTheWorld) {
  Scene ball = SceneOf(BallMesh(48));
  ball.world_radiance = glm::vec3(1.0f);
  GuidegenOptions options = Paths(10, {Layer::kLpeFull}, 128);
  for (int step = 0; step <= 10; ++step) {
    for (const double metallic : {0.0, 0.5, 1.0}) {
      const Paint paint{1.0, metallic, step / 10.0};
      ball.materials[0] = Coated(paint);
      options.seed = 0;
      const auto one = Render(ball, FrontCamera(4.0), options);
      options.seed = 1;
      const auto other = Render(ball, FrontCamera(4.0), options);
      ExpectFinite(one);
      ExpectFinite(other);
      double squares = 0.0, covered = 0.0;
      for (std::size_t i = 0; i < one.guides.pixel_count(); ++i) {
        if (one.guides.Plane(Layer::kCoverage)[i] == 0.0f) continue;
        const double half = 0.5 * (one.guides.Plane(Layer::kLpeFull, 1)[i] - other.guides.Plane(Layer::kLpeFull, 1)[i]);
        squares += half * half, covered += 1.0;
      }
      const double mean = 0.5 * (Mean(one, Layer::kLpeFull) + Mean(other, Layer::kLpeFull));
      const double error = std::sqrt(squares) / covered;
      EXPECT_LE(mean, kMostReturned + 5.0 * error) << paint.roughness << " " << metallic;
      EXPECT_LT(5.0 * error, 0.03) << paint.roughness << " " << metallic;
    }
  }
}

// A mirror-smooth coat returns F, and what is below it 1 − F: with a white base nothing is lost at any angle. So does
// a white metal, and every mixture of the two.
TEST(MaterialFurnace, ASmoothWhiteSurfaceReturnsAllOfIt) {
  for (const double metallic : {0.0, 0.3, 1.0}) {
    for (const double height : {10.0, 3.0, 1.0, 0.3}) ExpectReturned({1.0, metallic, 0.0}, height, 64, 1.0, 0.0);
  }
}

// From 55° and 84° beside head on: about where most is returned, and near the rim. A smoother surface loses its light
// in a few of these 8,192 samples, whose spread then says little.
TEST(MaterialFurnace, ARoughSurfaceReturnsWhatItsLobesIntegrateTo) {
  for (const double base : {0.8, 1.0}) {
    for (const double roughness : {0.3, 0.5, 0.7, 1.0}) {
      for (const double metallic : {0.0, 0.5, 1.0}) {
        for (const double height : {2.1, 0.3}) {
          const Paint paint{base, metallic, roughness, roughness == 1.0};
          const double eye = height / std::hypot(3.0, height);
          const double expected = Integrated(paint, eye, 100);
          EXPECT_LE(expected, kMostReturned);
          // The sum with half as many differs by three times this one's error.
          const double slack = std::abs(expected - Integrated(paint, eye, 50));
          ExpectReturned(paint, height, 128, expected, slack);
        }
      }
    }
  }
}

TEST(MaterialLobes, ASunGivesTheFormulas) {
  for (const double roughness : {0.1, 0.3, 0.6, 1.0}) {
    for (const double metallic : {0.0, 0.5, 1.0}) {
      for (const double angle : {0.0, 0.7, 1.4}) {
        for (const bool cycles4 : {false, true}) {
          const Paint paint{0.6, metallic, roughness, cycles4};
          SCOPED_TRACE(::testing::Message() << roughness << " " << metallic << " " << angle << " " << cycles4);
          Scene scene = Floor(Coated(paint));
          scene.lights = {SlantedSun(angle)};
          const auto result = Render(scene, SlantedAt(0.0), Paths(1, {Layer::kLpeLDE, Layer::kLpeLSE}));
          const double diffuse = DiffuseLobe(paint, kSlantedEye, ToSun(angle)) * std::cos(angle);
          const double specular = SpecularLobe(paint, kSlantedEye, ToSun(angle)) * std::cos(angle);
          EXPECT_NEAR(Center(result, Layer::kLpeLDE), diffuse, 1e-5 * diffuse + 1e-9);
          // The picture's one pixel is not quite at 45°, which a sharp highlight feels.
          EXPECT_NEAR(Center(result, Layer::kLpeLSE), specular, 2e-4 * specular + 1e-9);
        }
      }
    }
  }
}

// Oren and Nayar's lobe as its authors write it, by angles: cos φ sin α tan β with the smaller of the two angles β, in
// Fujii's form, which leaves the tangent out where the light comes from the eye's other side.
double RoughLobe(double color, double roughness, const glm::dvec3& eye, const glm::dvec3& light) {
  const double to_eye = std::acos(eye.z), to_light = std::acos(light.z);
  const double turn = std::cos(std::atan2(eye.y, eye.x) - std::atan2(light.y, light.x));
  const double greater = std::max(to_eye, to_light), smaller = std::min(to_eye, to_light);
  const double slant = turn * std::sin(greater) * (turn > 0.0 ? std::tan(smaller) : std::sin(smaller));
  const double a = 1.0 / (kPi + (3.0 * kPi - 4.0) / 6.0 * roughness);
  return color * a * (1.0 + roughness * slant);
}

// The sun on the far side of the eye, and behind the eye; luminance keeps its own definition, white Lambert.
TEST(MaterialLobes, ASunOnRoughDiffuseGivesTheFormula) {
  for (const double roughness : {0.0, 0.3, 1.0}) {
    for (const double angle : {-1.3, -0.6, 0.0, 0.7, 1.4}) {
      Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.6f));
      scene.materials[0].diffuse_roughness = float(roughness);
      scene.lights = {SlantedSun(angle)};
      const auto result = Render(scene, SlantedAt(0.0), Paths(1, {Layer::kLpeLDE, Layer::kLpeFull, Layer::kLuminance}));
      const double expected = RoughLobe(0.6, float(roughness), kSlantedEye, ToSun(angle)) * std::cos(angle);
      EXPECT_NEAR(Center(result, Layer::kLpeLDE), expected, 2e-5 * expected) << roughness << " " << angle;
      EXPECT_EQ(Center(result, Layer::kLpeFull), Center(result, Layer::kLpeLDE));
      EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[0], std::cos(angle) / kPi, 1e-6);
    }
  }
}

// A lamp with extent, found by points on it and by directions: both use one lobe.
TEST(MaterialLobes, AWorldAndAPanelOnRoughDiffuseGiveTheIntegral) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f));
  scene.materials[0].diffuse_roughness = 1.0f;
  scene.world_radiance = glm::vec3(1.0f);
  double expected = 0.0;
  const int n = 400;
  for (int ring = 0; ring < n; ++ring) {
    for (int column = 0; column < n; ++column) {
      const double z = (ring + 0.5) / n, around = 2.0 * kPi * (column + 0.5) / n, side = std::sqrt(1.0 - z * z);
      expected += RoughLobe(1.0, 1.0, kSlantedEye, {side * std::cos(around), side * std::sin(around), z}) * z;
    }
  }
  expected *= 2.0 * kPi / (n * n);
  EXPECT_LT(expected, 1.0);
  const auto sky = Render(scene, SlantedAt(0.0), Paths(4, {Layer::kLpeFull}, 1024));
  EXPECT_NEAR(Mean(sky, Layer::kLpeFull), expected, 2e-3);

  // A panel that fills most of the sky, seen from below, is nearly the same sky.
  scene.world_radiance = glm::vec3(0.0f);
  Light panel = Above(LightType::kArea, 0.02, 1.0);
  panel.size_x = panel.size_y = 20.0;
  scene.lights = {panel};
  const auto lit = Render(scene, LookingAt({0, -0.01, 0.01}, {0, 0, 0}, 1e-4), Paths(4, {Layer::kLpeLDE}, 1024));
  EXPECT_NEAR(Mean(lit, Layer::kLpeLDE), expected, 6e-3);
}

// What Cycles 4 adds is what bounces on between the facets: white then returns all that it receives, at every angle.
TEST(MaterialLobes, RoughDiffuseOfCycles4LosesNothing) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f));
  ShadeAsCycles("4.3.2", scene);
  scene.world_radiance = glm::vec3(1.0f);
  for (const float roughness : {0.25f, 1.0f}) {
    for (const double height : {0.3, 3.0}) {
      scene.materials[0].diffuse_roughness = roughness;
      const Camera eye = LookingAt({0, -3, height}, {0, 0, 0}, 1e-4);
      EXPECT_NEAR(Mean(Render(scene, eye, Paths(4, {Layer::kLpeFull}, 1024)), Layer::kLpeFull), 1.0, 3e-3);
    }
  }
  // A dark one gains little: a = 1 / (π + π/2 − 2/3) of an eye and a sun that face it, and 0.04% by more bounces.
  scene.world_radiance = glm::vec3(0.0f);
  scene.materials[0].base_color = {0.04f, 0.04f, 0.04f, 1.0f};
  scene.lights = {SlantedSun(0.0)};
  const double once = 0.04 / (1.5 * kPi - 2.0 / 3.0);
  const Camera above = LookingAt({0, -0.001, 2}, {0, 0, 0}, 1e-4);
  const double lit = Center(Render(scene, above, Paths(1, {Layer::kLpeLDE})), Layer::kLpeLDE);
  EXPECT_GT(lit, once);
  EXPECT_LT(lit, 1.001 * once);
}

// G multiplies the roughness and B the metalness, as numbers; R and the sRGB curve have no part in it.
TEST(MaterialTextures, RoughnessAndMetalness) {
  Scene scene = Floor(Coated({0.6, 0.9, 0.8}));
  scene.materials[0].metallic_roughness_texture = TwoTexels(scene, {65535, 32768, 0}, {0, 58982, 49151});
  scene.lights = {SlantedSun(0.7)};
  const Paint left{0.6, 0.0, 0.8 * 32768 / 65535}, right{0.6, 0.9 * 49151 / 65535, 0.8 * 58982 / 65535};
  const Paint between{0.6, 0.5 * right.metallic, 0.5 * (left.roughness + right.roughness)};
  const auto expect = [&](double x, const Paint& paint) {
    const auto result = Render(scene, SlantedAt(x), Paths(1, {Layer::kLpeLDE, Layer::kLpeLSE}));
    const double diffuse = DiffuseLobe(paint, kSlantedEye, ToSun(0.7)) * std::cos(0.7);
    const double specular = SpecularLobe(paint, kSlantedEye, ToSun(0.7)) * std::cos(0.7);
    EXPECT_NEAR(Center(result, Layer::kLpeLDE) / diffuse, 1.0, 1e-4) << x;
    EXPECT_NEAR(Center(result, Layer::kLpeLSE) / specular, 1.0, 1e-4) << x;
  };
  expect(-0.5, left);
  expect(0.5, right);
  scene.materials[0].metallic_roughness_texture.nearest = false;
  expect(0.0, between);
}

// A base colour is decoded from sRGB and multiplied by its factor and the vertices' colours, whichever lobe it colours.
TEST(MaterialTextures, BaseColor) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f));
  scene.materials[0].base_color = {0.5f, 0.75f, 1.0f, 1.0f};
  scene.materials[0].base_color_texture = TwoTexels(scene, {32768, 52429, 65535}, {0, 0, 0});
  scene.meshes[0].colors.assign(4, {0.5f, 1.0f, 0.25f, 1.0f});
  scene.lights = {SlantedSun(0.7)};
  const glm::dvec3 base(0.5 * 0.5 * Encoded(32768 / 65535.0), 0.75 * Encoded(52429 / 65535.0), 0.25);
  const auto expect = [&](Layer layer, const auto& lobe) {
    const auto result = Render(scene, SlantedAt(-0.5), Paths(1, {Layer::kLpeLDE, Layer::kLpeLSE}));
    for (int c = 0; c < 3; ++c) {
      const double expected = lobe(base[c]) * std::cos(0.7);
      EXPECT_NEAR(result.guides.Vec3(layer, 0)[c] / expected, 1.0, 1e-4) << c;
    }
  };
  expect(Layer::kLpeLDE, [](double color) { return color / kPi; });
  EXPECT_EQ(Center(Render(scene, SlantedAt(0.5), Paths(1, {Layer::kLpeLDE})), Layer::kLpeLDE), 0.0);
  scene.materials[0].bsdf = Bsdf::kMetallicRoughness;
  expect(Layer::kLpeLDE, [](double color) { return DiffuseLobe({color, 0.0, 0.5}, kSlantedEye, ToSun(0.7)); });
  scene.materials[0].metallic = 1.0f;
  expect(Layer::kLpeLSE, [](double color) { return SpecularLobe({color, 1.0, 0.5}, kSlantedEye, ToSun(0.7)); });
  // Pure Glossy is a white metal without Fresnel, times its colour.
  scene.materials[0].bsdf = Bsdf::kGlossy;
  expect(Layer::kLpeLSE, [](double color) { return color * SpecularLobe({1.0, 1.0, 0.5}, kSlantedEye, ToSun(0.7)); });
}

TEST(MaterialTextures, Emission) {
  Material glow = Painted(Bsdf::kDiffuse, 0.0f);
  glow.emission = {2.0f, 1.0f, 0.5f};
  Scene panel = Floor(glow);
  panel.materials[0].emission_texture = TwoTexels(panel, {32768, 65535, 52429}, {0, 0, 0});
  const glm::dvec3 radiance(2.0 * Encoded(32768 / 65535.0), 1.0, 0.5 * Encoded(52429 / 65535.0));
  // Seen from either side.
  for (const double side : {3.0, -3.0}) {
    const auto seen = Render(panel, LookingAt({-0.5, -1, side}, {-0.5, 0, 0}, 1e-4), Paths(1, {Layer::kLpeFull}));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen.guides.Vec3(Layer::kLpeFull, 0)[c], radiance[c], 1e-5) << side;
  }
  EXPECT_EQ(Center(Render(panel, SlantedAt(0.5), Paths(1, {Layer::kLpeFull})), Layer::kLpeFull), 0.0);
  // The bright half, 1 × 2 m at a height of 1.5 m, over the point below the panel's middle, one corner in each
  // direction.
  Scene lit = Floor(Painted(Bsdf::kDiffuse, 1.0f), 4.0);
  lit.textures = panel.textures;
  Mesh quad = QuadMesh();
  quad.material = AddMaterial(lit, panel.materials[0]);
  AddObject(lit, "panel", quad, Moved(0, 0, 1.5));
  const double a = 1.0 / 1.5, root = std::sqrt(1.0 + a * a);
  const double corner = 2.0 * a / root * std::atan(a / root) / (2.0 * kPi);
  const auto below = Render(lit, LookingAt({0, -3, 1}, {0, 0, 0}, 1e-4), Paths(1, {Layer::kLpeLDE}, 8192));
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(below.guides.Vec3(Layer::kLpeLDE, 0)[c], 2.0 * corner * radiance[c], 3e-3 * radiance[c]) << c;
  }
}

TEST(MaterialSides, TheBackAnswersLightAsTheFrontDoes) {
  for (const Bsdf bsdf : {Bsdf::kDiffuse, Bsdf::kGlossy, Bsdf::kMetallicRoughness}) {
    const Material paint = Painted(bsdf, 0.7f);
    const LayerSet layers = {Layer::kLpeLDE, Layer::kLpeLSE, Layer::kLuminance};
    Scene front = Floor(paint);
    front.lights = {SlantedSun(0.7)};
    Scene back = front;
    back.instances[0].world_from_object = glm::rotate(glm::dmat4(1.0), kPi, glm::dvec3(1, 0, 0));
    const auto from_front = Render(front, SlantedAt(0.0), Paths(1, layers));
    const auto from_back = Render(back, SlantedAt(0.0), Paths(1, layers));
    EXPECT_GT(Center(from_front, bsdf == Bsdf::kGlossy ? Layer::kLpeLSE : Layer::kLpeLDE), 0.01);
    for (const Layer layer : {Layer::kLpeLDE, Layer::kLpeLSE}) {
      EXPECT_FLOAT_EQ(float(Center(from_back, layer)), float(Center(from_front, layer))) << Info(layer).name;
    }
    EXPECT_FLOAT_EQ(from_back.guides.Plane(Layer::kLuminance)[0], from_front.guides.Plane(Layer::kLuminance)[0]);
    // Nothing shines through: the sun behind the sheet.
    back.lights[0].world_from_light = glm::rotate(glm::dmat4(1.0), kPi - 0.7, glm::dvec3(1, 0, 0));
    const auto behind = Render(back, SlantedAt(0.0), Paths(1, layers));
    for (const Layer layer : {Layer::kLpeLDE, Layer::kLpeLSE}) EXPECT_EQ(Center(behind, layer), 0.0);
  }
}

// The eye does not see the back of a single-sided surface; light hits it, as in Cycles.
TEST(MaterialSides, ASheetOfOneSideStillCastsItsShadow) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.5f), 4.0);
  Mesh sheet = QuadMesh();
  Material paint = Painted(Bsdf::kDiffuse, 0.5f);
  paint.double_sided = false;
  sheet.material = AddMaterial(scene, paint);
  AddObject(scene, "sheet", sheet, glm::rotate(Moved(0, 0, 1), kPi, glm::dvec3(1, 0, 0)));
  scene.lights = {Above(LightType::kSun, 0.0, 1.0)};
  const auto through = Render(scene, Spot(), Paths(1, {Layer::kLpeLDE, Layer::kShadow}));
  EXPECT_NEAR(through.guides.Plane(Layer::kDepth)[0], 5.0, 1e-3) << "the floor is seen through the sheet's back";
  EXPECT_EQ(Center(through, Layer::kLpeLDE), 0.0);
  EXPECT_EQ(through.guides.Plane(Layer::kShadow)[0], 1.0f);
}

}  // namespace
}  // namespace scumble::testing
