// The parts of the path tracer by themselves: expressions, samples, lobes, lights.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <set>
#include <string>
#include <vector>

#include "guidegen/light/light_sampling.h"
#include "guidegen/light/path_expression.h"
#include "guidegen/light/sampler.h"
#include "guidegen/path_layers.h"
#include "guidegen/surface/bsdf.h"
#include "tests/support/guidegen_scenes.h"
#include "tests/support/numbers.h"

namespace scumble::testing {
namespace {

PathExpression Parsed(const std::string& text) {
  Expected<PathExpression> expression = PathExpression::Parse(text);
  EXPECT_TRUE(expression.ok()) << text;
  return *std::move(expression);
}

TEST(PathExpression, HandWrittenPathsMatchTheLayersTheyBelongTo) {
  struct Case {
    const char* path;
    bool full, lde, lse, ldde, ld12e;
  };
  const Case cases[] = {
      {"LE", true, false, false, false, false},      {"LDE", true, true, false, false, true},
      {"LSE", true, false, true, false, false},      {"LDDE", true, false, false, true, true},
      {"LSDE", true, false, false, false, false},    {"LDSE", true, false, false, false, false},
      {"LSSE", true, false, false, false, false},    {"LDDDE", true, false, false, true, false},
      {"LSDDE", true, false, false, true, false},    {"LDSDE", true, false, false, false, false},
      {"LDDSE", true, false, false, false, false},   {"LSSSDDE", true, false, false, true, false},
      {"LDDDDDDE", true, false, false, true, false}, {"E", false, false, false, false, false},
      {"L", false, false, false, false, false},      {"", false, false, false, false, false},
      {"DDE", false, false, false, false, false},    {"LDD", false, false, false, false, false},
      {"LxE", false, false, false, false, false},    {"LDEE", true, false, false, false, false},
  };
  const auto expression = [](Layer layer) { return Parsed(PathLayerExpression(layer)); };
  for (const Case& c : cases) {
    EXPECT_EQ(expression(Layer::kLpeFull).Matches(c.path), c.full) << c.path;
    EXPECT_EQ(expression(Layer::kLpeLDE).Matches(c.path), c.lde) << c.path;
    EXPECT_EQ(expression(Layer::kLpeLSE).Matches(c.path), c.lse) << c.path;
    EXPECT_EQ(expression(Layer::kLpeLDDE).Matches(c.path), c.ldde) << c.path;
    EXPECT_EQ(expression(Layer::kLpeLD12E).Matches(c.path), c.ld12e) << c.path;
  }
}

TEST(PathExpression, EveryFormOfRepetition) {
  EXPECT_TRUE(Parsed("LD?E").Matches("LE"));
  EXPECT_TRUE(Parsed("LD?E").Matches("LDE"));
  EXPECT_FALSE(Parsed("LD?E").Matches("LDDE"));
  EXPECT_FALSE(Parsed("LD+E").Matches("LE"));
  EXPECT_TRUE(Parsed("LD+E").Matches("LDDDDE"));
  EXPECT_TRUE(Parsed("L[DS]{2}E").Matches("LSDE"));
  EXPECT_FALSE(Parsed("L[DS]{2}E").Matches("LSDSE"));
  EXPECT_FALSE(Parsed("LD{2,}E").Matches("LDE"));
  EXPECT_TRUE(Parsed("LD{2,}E").Matches("LDDDDDDDE"));
  EXPECT_TRUE(Parsed("LD{0,2}S*E").Matches("LSSE"));
  EXPECT_TRUE(Parsed("L.E").Matches("LSE"));
}

TEST(PathExpression, StopsAsSoonAsNothingCanMatch) {
  const PathExpression lde = Parsed("LDE");
  const auto eye = lde.Step(lde.Start(), PathEvent::kEye);
  ASSERT_NE(eye, PathExpression::kDead);
  EXPECT_EQ(lde.Step(eye, PathEvent::kSpecular), PathExpression::kDead);
  const auto diffuse = lde.Step(eye, PathEvent::kDiffuse);
  EXPECT_TRUE(lde.EndsWithLight(diffuse));
  EXPECT_EQ(lde.Step(diffuse, PathEvent::kDiffuse), PathExpression::kDead);
}

TEST(PathExpression, OtherTextsAreRefused) {
  for (const char* text :
       {"", "X", "L(D)E", "LD{E", "LD{2,1}E", "LD{}E", "L[E", "L[]E", "*", "L**E", "LD{99}E", "lde"}) {
    const auto expression = PathExpression::Parse(text);
    ASSERT_FALSE(expression.ok()) << text;
    EXPECT_EQ(expression.error().kind, ErrorKind::kUsage);
    EXPECT_NE(expression.error().message.find(std::string("'") + text + "'"), std::string::npos);
  }
}

TEST(PathFollower, KeepsOnlyLayersThatCanExist) {
  const PathSupply diffuse{true, 1, false, true, false};
  EXPECT_FALSE(PathFollower({Layer::kLpeLDE}, diffuse, 8).NeedsSamples());
  EXPECT_TRUE(PathFollower({Layer::kLpeLSE}, diffuse, 8).empty());
  EXPECT_TRUE(PathFollower({Layer::kLpeLDE}, PathSupply{false, 0, false, true, true}, 8).empty());
  EXPECT_TRUE(PathFollower({Layer::kLpeLDDE}, diffuse, 8).Bounces());
  EXPECT_TRUE(PathFollower({Layer::kLpeLDDE}, diffuse, 0).empty());
  EXPECT_FALSE(PathFollower({Layer::kLpeFull}, diffuse, 0).NeedsSamples());
  EXPECT_TRUE(PathFollower({Layer::kLpeLDE}, PathSupply{true, 0, true, true, false}, 0).NeedsSamples());
}

TEST(Sampler, FirstPointsOfTheSequenceAreSobols) {
  // From the definition: the van der Corput sequence, and the polynomials x + 1, x² + x + 1 and x³ + x + 1.
  const std::array<std::array<double, 8>, 4> expected = {{{0, 0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875},
                                                          {0, 0.5, 0.75, 0.25, 0.625, 0.125, 0.375, 0.875},
                                                          {0, 0.5, 0.75, 0.25, 0.375, 0.875, 0.625, 0.125},
                                                          {0, 0.5, 0.75, 0.25, 0.125, 0.625, 0.875, 0.375}}};
  for (std::uint32_t i = 0; i < 8; ++i) {
    for (int d = 0; d < 4; ++d) EXPECT_EQ(Sobol(i, d) * 0x1.0p-32, expected[std::size_t(d)][i]) << i << " " << d;
  }
}

TEST(Sampler, PowersOfTwoFillEveryElementaryInterval) {
  for (std::uint32_t pixel = 0; pixel < 5; ++pixel) {
    const Sampler sampler(pixel);
    for (int rows = 1; rows <= 64; rows *= 2) {
      std::set<int> cells;
      for (std::uint32_t i = 0; i < 64; ++i) {
        const Quad q = sampler.Draw(i, 3);
        for (const double value : q) ASSERT_TRUE(value >= 0.0 && value < 1.0);
        cells.insert(int(q[0] * rows) * (64 / rows) + int(q[1] * (64 / rows)));
      }
      EXPECT_EQ(cells.size(), 64u) << rows;
    }
    for (int d = 0; d < 4; ++d) {
      std::set<int> cells;
      for (std::uint32_t i = 0; i < 256; ++i) cells.insert(int(sampler.Draw(i, 0)[std::size_t(d)] * 256));
      EXPECT_EQ(cells.size(), 256u) << d;
    }
  }
}

TEST(Sampler, PixelsAndSetsDiffer) {
  EXPECT_NE(Sampler(1).Draw(0, 0), Sampler(2).Draw(0, 0));
  EXPECT_NE(Sampler(1).Draw(0, 0), Sampler(1).Draw(0, 1));
  EXPECT_NE(Sampler(1, 0).Draw(0, 0), Sampler(1, 1).Draw(0, 0));
  EXPECT_EQ(Sampler(1).Draw(7, 2), Sampler(1).Draw(7, 2));
}

// A point in the plane z = 0 with this material.
struct Patch {
  explicit Patch(const Material& m) : material(m) {
    object = Place(&mesh, &material, {}, glm::dmat4(1.0));
    point.facing = point.normal = glm::dvec3(0, 0, 1);
  }
  SurfaceBsdf At(double cosine) const {
    return SurfaceBsdf(object, 0, point, glm::dvec3(std::sqrt(1.0 - cosine * cosine), 0, cosine));
  }
  Material material;
  Mesh mesh = QuadMesh();
  PlacedObject object;
  SurfacePoint point;
};

Material Glossy(float roughness) {
  Material material;
  material.bsdf = Bsdf::kGlossy;
  material.roughness = roughness;
  return material;
}

Material Rough(float roughness) {
  Material material;
  material.bsdf = Bsdf::kDiffuse;
  material.diffuse_roughness = roughness;
  return material;
}

// The sum over a fine grid of the hemisphere of what `at(direction)` returns.
template <class At>
double OverHemisphere(const At& at) {
  double sum = 0.0;
  const int rings = 600;
  const int columns = 600;
  for (int ring = 0; ring < rings; ++ring) {
    const double z = (ring + 0.5) / rings;
    for (int column = 0; column < columns; ++column) {
      const double around = 2.0 * kPi * (column + 0.5) / columns;
      const double side = std::sqrt(1.0 - z * z);
      sum += at(glm::dvec3(side * std::cos(around), side * std::sin(around), z));
    }
  }
  return sum * 2.0 * kPi / (double(rings) * columns);
}

// What the lobes return of light from everywhere, by their own samples.
double SampledAlbedo(const SurfaceBsdf& bsdf) {
  const Sampler sampler(7);
  const int n = 4096;
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    const Quad u = sampler.Draw(std::uint32_t(i), 0);
    if (bsdf.HasDiffuse()) sum += bsdf.SampleDiffuse(u[0], u[1]).weight.g;
    if (bsdf.HasSpecular()) sum += bsdf.SampleSpecular(u[0], u[1]).weight.g;
  }
  return sum / n;
}

TEST(Bsdf, NoRoughnessReturnsMoreThanItReceives) {
  for (int step = 0; step <= 20; ++step) {
    for (const double cosine : {1.0, 0.9, 0.7, 0.5, 0.3, 0.15, 0.05, 0.01}) {
      for (const float metallic : {0.0f, 0.5f, 1.0f}) {
        Material coated;
        coated.roughness = float(step) / 20.0f;
        coated.metallic = metallic;
        EXPECT_LE(SampledAlbedo(Patch(coated).At(cosine)), 1.0 + 1e-3) << step << " " << cosine << " " << metallic;
      }
      EXPECT_LE(SampledAlbedo(Patch(Glossy(float(step) / 20.0f)).At(cosine)), 1.0 + 1e-9) << step << " " << cosine;
    }
  }
  EXPECT_NEAR(SampledAlbedo(Patch(Glossy(0.0f)).At(0.3)), 1.0, 1e-12);
}

TEST(Bsdf, EvaluationAgreesWithSampling) {
  // The integral of value and of density over a fine grid of the hemisphere, against the samples' mean weight.
  for (const float roughness : {0.4f, 0.6f, 1.0f}) {
    for (const double cosine : {0.9, 0.4}) {
      const Patch patch(Glossy(roughness));
      const SurfaceBsdf bsdf = patch.At(cosine);
      const double value = OverHemisphere([&](const glm::dvec3& d) { return bsdf.Specular(d).value.g; });
      EXPECT_NEAR(value, SampledAlbedo(bsdf), 5e-3) << roughness << " " << cosine;
      EXPECT_LE(OverHemisphere([&](const glm::dvec3& d) { return bsdf.Specular(d).density; }), 1.0 + 5e-3);
    }
  }
}

// White returns πa to an eye that faces it and everything to a grazing one, at every roughness.
TEST(RoughDiffuse, ReturnsWhatTheFormulaIntegratesTo) {
  for (const float roughness : {0.25f, 0.5f, 1.0f}) {
    const double scale = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * kPi)) * double(roughness));
    double before = 0.0;
    for (const double cosine : {1.0, 0.8, 0.5, 0.2, 1e-6}) {
      const Patch patch(Rough(roughness));
      const SurfaceBsdf bsdf = patch.At(cosine);
      const double returned = OverHemisphere([&](const glm::dvec3& d) { return bsdf.Diffuse(d).value.g; });
      EXPECT_NEAR(returned, SampledAlbedo(bsdf), 2e-3) << roughness << " " << cosine;
      EXPECT_NEAR(OverHemisphere([&](const glm::dvec3& d) { return bsdf.Diffuse(d).density; }), 1.0, 1e-3);
      if (cosine == 1.0) {
        EXPECT_NEAR(returned, scale, 1e-4);
      } else if (cosine == 1e-6) {
        EXPECT_NEAR(returned, 1.0, 1e-3);
      }
      EXPECT_GT(returned, before) << roughness << " " << cosine << ": rough surfaces flatten towards the rim";
      before = returned;
    }
  }
}

// One sample at a time: its weight is the value there over the density there.
TEST(RoughDiffuse, SamplesHaveTheWeightOfTheirDirection) {
  const Patch patch(Rough(0.7f));
  const SurfaceBsdf bsdf = patch.At(0.3);
  const Sampler sampler(5);
  for (int i = 0; i < 256; ++i) {
    const Quad u = sampler.Draw(std::uint32_t(i), 0);
    const SurfaceBsdf::Bounce bounce = bsdf.SampleDiffuse(u[0], u[1]);
    const SurfaceBsdf::Value value = bsdf.Diffuse(bounce.direction);
    EXPECT_NEAR(bounce.density, value.density, 1e-12);
    EXPECT_NEAR(bounce.weight.g * bounce.density, value.value.g, 1e-12);
    EXPECT_EQ(bounce.blur_density, 0.5 / kPi) << "as Cycles samples it";
  }
}

TEST(RoughDiffuse, WithoutRoughnessItIsLambertsInEveryBit) {
  const Patch smooth(Rough(0.0f));
  const SurfaceBsdf bsdf = smooth.At(0.6);
  const glm::dvec3 light = glm::normalize(glm::dvec3(0.3, -0.5, 0.4));
  EXPECT_EQ(bsdf.Diffuse(light).value.g, light.z / kPi);
  const SurfaceBsdf::Bounce bounce = bsdf.SampleDiffuse(0.3, 0.6);
  EXPECT_EQ(bounce.weight.g, 1.0);
  EXPECT_EQ(bounce.blur_density, bounce.density);
}

TEST(Bsdf, IsReciprocal) {
  Material coated;
  coated.roughness = 0.5f;
  const Patch patch(coated);
  const glm::dvec3 a = glm::normalize(glm::dvec3(0.3, 0.5, 0.8));
  const glm::dvec3 b = glm::normalize(glm::dvec3(-0.7, 0.1, 0.3));
  const SurfaceBsdf from_a(patch.object, 0, patch.point, a);
  const SurfaceBsdf from_b(patch.object, 0, patch.point, b);
  EXPECT_NEAR(from_a.Specular(b).value.r / b.z, from_b.Specular(a).value.r / a.z, 1e-12);
  EXPECT_NEAR(from_a.Diffuse(b).value.r / b.z, from_b.Diffuse(a).value.r / a.z, 1e-12);
  const Patch clay(Rough(0.8f));
  const SurfaceBsdf clay_from_a(clay.object, 0, clay.point, a);
  const SurfaceBsdf clay_from_b(clay.object, 0, clay.point, b);
  EXPECT_NEAR(clay_from_a.Diffuse(b).value.r / b.z, clay_from_b.Diffuse(a).value.r / a.z, 1e-12);
}

std::vector<PlacedLight> Placed(const std::vector<Light>& lights) {
  auto rays = CameraRays::Make(FrontCamera(0.0), 8, 8);
  auto placed = PlaceLights(lights, *rays);
  EXPECT_TRUE(placed.ok());
  return *placed;
}

Light AreaLight(bool ellipse) {
  Light light;
  light.type = LightType::kArea;
  light.name = "panel";
  light.ellipse = ellipse;
  light.size_x = 1.2;
  light.size_y = 0.7;
  light.world_from_light = glm::inverse(glm::lookAt(glm::dvec3(0.4, 0.9, 1.1), glm::dvec3(0), glm::dvec3(1, 0, 0)));
  return light;
}

// Drawing a light and hitting it must agree: equal radiance and density, and equal solid angle.
TEST(LightSet, DrawnDirectionsMeetTheLightWithTheSameDensity) {
  Light ball = PointLight({0.5, 0.2, 1.0}, 3.0);
  ball.radius = 0.4;
  Light sun;
  sun.type = LightType::kSun;
  sun.angle_degrees = 70.0;
  Light spot = ball;
  spot.type = LightType::kSpot;
  spot.cycles_spot = true;
  spot.outer_cone_degrees = 60.0;
  spot.spot_blend = 0.5;
  for (const Light& light : {ball, sun, spot, AreaLight(false), AreaLight(true)}) {
    const LightSet lights(Placed({light}), {}, glm::dvec3(0.0));
    const Sampler sampler(3);
    SurfacePoint from;
    from.position = {0.1, -0.2, -0.05};
    const glm::dvec3& point = from.position;
    int met = 0;
    double solid_angle = 0.0;
    const int n = 1024;
    for (int i = 0; i < n; ++i) {
      const Quad u = sampler.Draw(std::uint32_t(i), 0);
      const LightDraw draw = lights.Draw(0, from, u[0] * 0.999 + 0.0005, u[1] * 0.999 + 0.0005);
      ASSERT_GT(draw.density, 0.0);
      solid_angle += 1.0 / draw.density / n;
      const auto visit = [&](int, const glm::dvec3& radiance, double density) {
        ++met;
        EXPECT_NEAR(density / draw.density, 1.0, 1e-9);
        EXPECT_NEAR(radiance.g, draw.radiance.g, 1e-9 * (1.0 + radiance.g));
      };
      lights.VisitAnalytic(point, draw.direction, std::numeric_limits<double>::infinity(), visit);
    }
    EXPECT_EQ(met, n);
    // By chance, from all around.
    double seen = 0.0;
    const int many = 1 << 16;
    for (int i = 0; i < many; ++i) {
      const Quad u = sampler.Draw(std::uint32_t(i), 1);
      const double z = 2.0 * u[0] - 1.0;
      const double side = std::sqrt(1.0 - z * z);
      const glm::dvec3 direction(side * std::cos(2.0 * kPi * u[1]), side * std::sin(2.0 * kPi * u[1]), z);
      lights.VisitAnalytic(point, direction, std::numeric_limits<double>::infinity(),
                           [&](int, const glm::dvec3&, double) { seen += 4.0 * kPi / many; });
    }
    EXPECT_NEAR(seen / solid_angle, 1.0, 0.01);
  }
}

TEST(LightSet, ChoicesAddUpToOne) {
  std::vector<Light> lights = {PointLight({1, 2, 3}, 2.0), PointLight({-1, 0, 2}, 1e-6), AreaLight(true)};
  lights.push_back(PointLight({0, 5, 0}, 0.0));  // dark: no light at all
  lights[1].radius = 0.2;
  const LightSet set(Placed(lights), {}, glm::dvec3(0.0));
  ASSERT_EQ(set.count(), 3);
  EXPECT_EQ(set.delta_count(), 1);
  SurfacePoint point;
  point.position = {0.2, 0.1, 0.0};
  point.facing = point.normal = {0, 0, 1};
  for (const bool with_delta : {false, true}) {
    double total = 0.0;
    for (int i = 0; i < set.count(); ++i) total += set.Probability(point, i, with_delta);
    EXPECT_NEAR(total, 1.0, 1e-12);
    std::array<double, 3> taken{};
    for (int i = 0; i < 1000; ++i) {
      const LightChoice choice = set.Choose(point, (i + 0.5) / 1000, with_delta);
      ASSERT_GE(choice.light, 0);
      EXPECT_NEAR(choice.probability, set.Probability(point, choice.light, with_delta), 1e-12);
      taken[std::size_t(choice.light)] += 1e-3;
    }
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(taken[std::size_t(i)], set.Probability(point, i, with_delta), 2e-3);
  }
  EXPECT_EQ(set.Probability(point, 0, false), 0.0);
}

}  // namespace
}  // namespace scumble::testing
