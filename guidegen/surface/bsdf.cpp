#include "guidegen/surface/bsdf.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <numbers>

#include "guidegen/surface/shading_normal.h"
#include "guidegen/surface/work_counters.h"

namespace scumble {
namespace {

using std::numbers::pi;

// glTF's value for every dielectric: an index of refraction of 1.5.
constexpr double kDielectricF0 = 0.04;
// Below this GGX's peak is too sharp to be evaluated; Cycles has this limit, too.
constexpr double kSmoothestAlpha = 1e-4;
// The eye is never lower than this above the specular normal.
constexpr double kLowestEye = 1e-3;

double Schlick(double cosine) {
  const double m = std::clamp(1.0 - cosine, 0.0, 1.0);
  return m * m * m * m * m;
}

// The cosine-weighted mean of Schlick's Fresnel for kDielectricF0.
constexpr double kMeanFresnel = kDielectricF0 + (1.0 - kDielectricF0) / 21.0;

double SmithG1(double cosine, double alpha) {
  const double squared = cosine * cosine;
  return 2.0 * cosine / (cosine + std::sqrt(alpha * alpha * (1.0 - squared) + squared));
}

double GgxD(double cosine, double alpha) {
  const double a2 = alpha * alpha;
  // 1 + (a² − 1)cos², arranged so that small α keeps its digits near cos = 1.
  const double d = (1.0 - cosine * cosine) + a2 * cosine * cosine;
  return a2 / (pi * d * d);
}

// 1 / a of the header.
double RoughDiffuseScale(double roughness) { return pi + (pi / 2.0 - 2.0 / 3.0) * roughness; }

glm::dvec3 NotNegative(const glm::dvec3& c) {
  glm::dvec3 result;
  for (int i = 0; i < 3; ++i) result[i] = c[i] > 0.0 && std::isfinite(c[i]) ? c[i] : 0.0;
  return result;
}

}  // namespace

void MakeFrame(const glm::dvec3& z, glm::dvec3& x, glm::dvec3& y) {
  const double sign = std::copysign(1.0, z.z);
  const double a = -1.0 / (sign + z.z);
  const double b = z.x * z.y * a;
  x = glm::dvec3(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x);
  y = glm::dvec3(b, sign + z.y * z.y * a, -z.y);
}

glm::dvec2 SquareToDisc(double u, double v) {
  const double a = 2.0 * u - 1.0;
  const double b = 2.0 * v - 1.0;
  if (a == 0.0 && b == 0.0) return glm::dvec2(0.0);
  const bool wide = std::abs(a) > std::abs(b);
  const double radius = wide ? a : b;
  const double angle = wide ? pi / 4.0 * (b / a) : pi / 2.0 - pi / 4.0 * (a / b);
  return radius * glm::dvec2(std::cos(angle), std::sin(angle));
}

SurfaceBsdf::SurfaceBsdf(const PlacedObject& object, std::uint32_t primitive, const SurfacePoint& point,
                         const glm::dvec3& to_eye, double least_alpha)
    : facing_(point.facing),
      normal_(point.normal),
      smooth_normal_(point.smooth_normal),
      specular_normal_(point.normal),
      to_eye_(to_eye) {
  const Material& material = *object.material;
  if (material.bsdf == Bsdf::kEmission) return;
  cycles4_ = material.cycles4;
  const glm::dvec3 base = NotNegative(glm::dvec3(SurfaceColor(object, primitive, point.barycentric)));
  if (material.bsdf == Bsdf::kDiffuse) {
    diffuse_ = base;
    diffuse_roughness_ = std::clamp(double(material.diffuse_roughness), 0.0, 1.0);
    if (cycles4_ && diffuse_roughness_ > 0.0) {
      const double mean = (pi + diffuse_roughness_ * (2.0 * pi - 5.6) / 3.0) / RoughDiffuseScale(diffuse_roughness_);
      const glm::dvec3 color = glm::min(base, 1.0);
      const double eye = std::max(glm::dot(normal_, to_eye), 0.0);
      many_bounces_ = color * color * (mean / (1.0 - mean)) / (1.0 - color * (1.0 - mean)) * (1.0 - BounceOnce(eye));
    }
    return;
  }
  double roughness = material.roughness;
  double metallic = material.metallic;
  if (const auto texel = SampleSurface(object, material.metallic_roughness_texture, primitive, point.barycentric)) {
    roughness *= texel->g;
    metallic *= texel->b;
  }
  roughness = std::clamp(roughness, 0.0, 1.0);
  metallic = std::clamp(metallic, 0.0, 1.0);
  alpha_ = std::max(roughness * roughness, least_alpha);
  mirror_ = !(alpha_ >= kSmoothestAlpha);
  double eye = glm::dot(normal_, to_eye);
  if (cycles4_ && material.bsdf == Bsdf::kMetallicRoughness) {
    specular_normal_ = BentNormal(facing_, to_eye, normal_);
    eye = glm::dot(specular_normal_, to_eye);
  }
  if (eye < kLowestEye) specular_normal_ = glm::normalize(specular_normal_ + to_eye * (2.0 * kLowestEye - eye));
  if (material.bsdf == Bsdf::kGlossy) {
    f0_ = base;
    return;
  }
  fresnel_ = true;
  diffuse_ = base * (1.0 - metallic);
  f0_ = glm::mix(glm::dvec3(kDielectricF0), glm::min(base, 1.0), metallic);
}

glm::dvec3 SurfaceBsdf::Fresnel(double cosine) const { return fresnel_ ? f0_ + (1.0 - f0_) * Schlick(cosine) : f0_; }

// Smith's masking and shadowing of both directions, over the masking of the eye's alone.
double SurfaceBsdf::Shadowing(double eye, double light) const {
  const double to_light = SmithG1(light, alpha_);
  if (!cycles4_) return to_light;
  const double to_eye = SmithG1(eye, alpha_);
  return to_light / (to_eye + to_light - to_eye * to_light);
}

// The transmission of a dielectric coat: (1 − F) on the way in and out, scaled so that the whole lobe returns 1 − F of
// the incoming light (the form is Ashikhmin and Shirley's, 2000). glTF's own weight, 1 − F at the half vector, would
// return up to 1.7 times the light at grazing angles.
double SurfaceBsdf::Coupling(double cosine) const {
  if (!fresnel_) return 1.0;
  const auto passes = [](double c) { return (1.0 - kDielectricF0) * (1.0 - Schlick(c)); };
  const double eye = std::abs(glm::dot(normal_, to_eye_));
  return passes(eye) * passes(cosine) / (1.0 - kMeanFresnel);
}

// The share of light from one direction that a rough white surface returns by a single bounce: E of the header.
double SurfaceBsdf::BounceOnce(double cosine) const {
  const double sine = std::sqrt(std::max(1.0 - cosine * cosine, 0.0));
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
  // The tangent's term goes to 0 with the cosine: 1 − sin³ ≈ 1.5 cos².
  const double tangent = cosine > 1e-6 ? sine / cosine * (1.0 - sine * sine * sine) : 0.0;
  const double g = sine * (angle - 2.0 / 3.0 - sine * cosine) + 2.0 / 3.0 * tangent;
  return (pi + diffuse_roughness_ * g) / RoughDiffuseScale(diffuse_roughness_);
}

// What the diffuse lobe reflects, over what Lambert's does.
glm::dvec3 SurfaceBsdf::DiffuseWeight(const glm::dvec3& to_light, double cosine) const {
  const double share = ShadingNormalShadow(normal_, smooth_normal_, to_light);
  if (!(diffuse_roughness_ > 0.0)) return glm::dvec3(share * Coupling(cosine));
  const double eye = std::max(glm::dot(normal_, to_eye_), 0.0);
  double slant = glm::dot(to_light, to_eye_) - cosine * eye;
  if (slant > 0.0) slant /= std::max(cosine, eye);
  const double once = share * pi * (1.0 + diffuse_roughness_ * slant) / RoughDiffuseScale(diffuse_roughness_);
  if (!cycles4_) return glm::dvec3(once);
  return once + many_bounces_ * (share * (1.0 - BounceOnce(cosine)));
}

double SurfaceBsdf::DiffuseShare() const {
  if (!HasDiffuse()) return 0.0;
  return std::min(Brightness(diffuse_), 1.0) * Coupling(1.0) + 1e-6;
}

double SurfaceBsdf::SpecularShare() const {
  if (!HasSpecular()) return 0.0;
  return std::min(Brightness(Fresnel(glm::dot(specular_normal_, to_eye_))), 1.0) + 1e-6;
}

SurfaceBsdf::Value SurfaceBsdf::Diffuse(const glm::dvec3& to_light) const {
  const double cosine = glm::dot(normal_, to_light);
  if (!(cosine > 0.0) || !(glm::dot(facing_, to_light) > 0.0)) return {};
  return {diffuse_ * (DiffuseWeight(to_light, cosine) * cosine / pi), cosine / pi};
}

SurfaceBsdf::Value SurfaceBsdf::Specular(const glm::dvec3& to_light) const {
  const double cosine = glm::dot(specular_normal_, to_light);
  const double eye = glm::dot(specular_normal_, to_eye_);
  if (mirror_ || !(cosine > 0.0) || !(eye > 0.0) || !(glm::dot(facing_, to_light) > 0.0)) return {};
  const glm::dvec3 sum = to_light + to_eye_;
  const double length = glm::length(sum);
  if (!(length > 0.0)) return {};
  const glm::dvec3 half = sum / length;
  const double density =
      SmithG1(eye, alpha_) * GgxD(std::min(glm::dot(specular_normal_, half), 1.0), alpha_) / (4.0 * eye);
  return {Fresnel(glm::dot(half, to_light)) * (density * Shadowing(eye, cosine)), density};
}

SurfaceBsdf::Bounce SurfaceBsdf::SampleDiffuse(double u, double v) const {
  const glm::dvec2 disc = SquareToDisc(u, v);
  const double cosine = std::sqrt(std::max(0.0, 1.0 - glm::dot(disc, disc)));
  glm::dvec3 x, y;
  MakeFrame(normal_, x, y);
  Bounce bounce;
  bounce.direction = glm::normalize(x * disc.x + y * disc.y + normal_ * cosine);
  if (!(cosine > 0.0) || !(glm::dot(facing_, bounce.direction) > 0.0)) return bounce;
  bounce.weight = diffuse_ * DiffuseWeight(bounce.direction, cosine);
  bounce.density = cosine / pi;
  // Cycles 3 samples a rough diffuse lobe evenly, which is noisier.
  bounce.blur_density = diffuse_roughness_ > 0.0 && !cycles4_ ? 0.5 / pi : bounce.density;
  return bounce;
}

SurfaceBsdf::Bounce SurfaceBsdf::SampleSpecular(double u, double v) const {
  Bounce bounce;
  glm::dvec3 half = specular_normal_;
  if (!mirror_) {
    glm::dvec3 x, y;
    MakeFrame(specular_normal_, x, y);
    const glm::dvec3 eye(glm::dot(x, to_eye_), glm::dot(y, to_eye_), glm::dot(specular_normal_, to_eye_));
    const glm::dvec3 stretched = glm::normalize(glm::dvec3(alpha_ * eye.x, alpha_ * eye.y, eye.z));
    const double flat = std::hypot(stretched.x, stretched.y);
    const glm::dvec3 t1 = flat > 1e-12 ? glm::dvec3(-stretched.y, stretched.x, 0.0) / flat : glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 t2 = glm::cross(stretched, t1);
    glm::dvec2 disc = SquareToDisc(u, v);
    const double s = 0.5 * (1.0 + stretched.z);
    disc.y = (1.0 - s) * std::sqrt(std::max(0.0, 1.0 - disc.x * disc.x)) + s * disc.y;
    const double up = std::sqrt(std::max(0.0, 1.0 - glm::dot(disc, disc)));
    const glm::dvec3 n = t1 * disc.x + t2 * disc.y + stretched * up;
    const glm::dvec3 micro = glm::normalize(glm::dvec3(alpha_ * n.x, alpha_ * n.y, std::max(0.0, n.z)));
    half = x * micro.x + y * micro.y + specular_normal_ * micro.z;
  }
  const double along = glm::dot(half, to_eye_);
  bounce.direction = glm::normalize(half * (2.0 * along) - to_eye_);
  const double cosine = glm::dot(specular_normal_, bounce.direction);
  if (!(along > 0.0) || !(cosine > 0.0) || !(glm::dot(facing_, bounce.direction) > 0.0)) return bounce;
  const double eye = glm::dot(specular_normal_, to_eye_);
  bounce.weight = Fresnel(along) * (mirror_ ? 1.0 : Shadowing(eye, cosine));
  bounce.density = mirror_ ? std::numeric_limits<double>::infinity() : Specular(bounce.direction).density;
  bounce.blur_density = bounce.density;
  if (!(bounce.density > 0.0)) bounce.weight = glm::dvec3(0.0);
  return bounce;
}

bool MayBeDiffuse(const Material& material) {
  if (material.bsdf == Bsdf::kEmission || material.bsdf == Bsdf::kGlossy) return false;
  return glm::vec3(material.base_color) != glm::vec3(0.0f) &&
         (material.bsdf == Bsdf::kDiffuse || material.metallic < 1.0f ||
          material.metallic_roughness_texture.texture >= 0);
}

bool MayBeSpecular(const Material& material) {
  if (material.bsdf == Bsdf::kGlossy) return glm::vec3(material.base_color) != glm::vec3(0.0f);
  return material.bsdf == Bsdf::kMetallicRoughness;
}

bool MayEmit(const Material& material) { return NotNegative(glm::dvec3(material.emission)) != glm::dvec3(0.0); }

glm::dvec3 SurfaceEmission(const PlacedObject& object, std::uint32_t primitive, glm::dvec2 barycentric) {
  const Material& material = *object.material;
  if (!MayEmit(material)) return glm::dvec3(0.0);
  ++thread_counters.materials;
  glm::dvec3 emission(material.emission);
  if (const auto texel = SampleSurfaceColor(object, material.emission_texture, primitive, barycentric)) {
    emission *= glm::dvec3(*texel);
  }
  return NotNegative(emission);
}

}  // namespace scumble
