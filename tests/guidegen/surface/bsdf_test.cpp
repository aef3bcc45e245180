// The lobes of a surface by themselves: what they return, and how they are sampled.
#include "guidegen/surface/bsdf.h"

#include <gtest/gtest.h>

#include <cmath>

#include "guidegen/light/sampler.h"
#include "tests/support/guidegen_scenes.h"
#include "tests/support/numbers.h"

namespace scumble::testing {
namespace {

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

}  // namespace
}  // namespace scumble::testing
