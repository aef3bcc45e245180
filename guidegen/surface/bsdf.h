// A surface's response to light: a diffuse lobe and a GGX lobe, each with its own event of light-path expressions.
//
// The diffuse lobe is Lambert's. With a diffuse roughness σ > 0 it is Oren & Nayar's in the form of Fujii, "A tiny
// improvement of Oren-Nayar reflectance model", 2012, as in Cycles 3.4: color · (a + b·t), where
//   a = 1 / (π + (π/2 − 2/3) σ),  b = σ·a,  s = l·v − (n·l)(n·v),  t = s for s ≤ 0, else s / max(n·l, n·v).
// White returns πa of the light to an eye that faces it (0.78 at σ = 1), and all of it to a grazing eye, never more.
// Cycles 4 adds what bounces on between the facets, as OpenPBR has it: c²/π · Ē/(1 − Ē) / (1 − c(1 − Ē)) times (1 −
// E(n·l)) (1 − E(n·v)). There c is the colour, at most 1. E(x) = πa + b·G(x) is the share that one bounce returns, and
// Ē = πa + b(2π − 5.6)/3 its mean. G(cos θ) is sin θ (θ − 2/3 − sin θ cos θ) + 2/3 tan θ (1 − sin³ θ). White then
// returns all of the light. Shading normals that differ from the interpolated ones take some of it away:
// ShadingNormalShadow.
//
// Walter et al., "Microfacet models for refraction", EGSR 2007; Heitz, "Sampling the GGX distribution of visible
// normals", JCGT 2018. Masking and shadowing are Smith's: separable in Cycles 3, G1(eye)·G1(light), and correlated by
// height in Cycles 4, 1 / (1/G1(eye) + 1/G1(light) − 1), after Heitz, "Understanding the masking-shadowing function",
// JCGT 2014. Light between microfacets is lost, so no surface returns more than it receives. White under a coat is the
// exception, by 0.13% at most, because the diffuse part depends on the eye's angle alone.
#pragma once

#include <glm/glm.hpp>

#include "guidegen/surface/surface.h"

namespace scumble {

// The response of one surface point. Directions are unit vectors in view space that point away from the surface.
class SurfaceBsdf {
 public:
  // A sampled direction. `weight` is value × cosine / density; 0 where there is no reflection.
  struct Bounce {
    glm::dvec3 direction{0.0};
    glm::dvec3 weight{0.0};
    double density = 0.0;  // per solid angle; infinite for a mirror
    // The density with which Cycles would have sampled it: by this a path blurs what follows.
    double blur_density = 0.0;
  };

  // The reflection towards a direction, times the cosine there.
  struct Value {
    glm::dvec3 value{0.0};
    double density = 0.0;  // with which the lobe's Sample would have chosen that direction
  };

  // `to_eye` points back along the path. If a shading normal still faces away from it, the normal is bent for the
  // specular lobe. The specular lobe is at least as rough as `least_alpha`.
  SurfaceBsdf(const PlacedObject& object, std::uint32_t primitive, const SurfacePoint& point, const glm::dvec3& to_eye,
              double least_alpha = 0.0);

  bool HasDiffuse() const { return diffuse_ != glm::dvec3(0.0); }
  bool HasSpecular() const { return f0_ != glm::dvec3(0.0) || fresnel_; }
  // Smooth enough that only one direction counts: evaluating gives 0.
  bool IsMirror() const { return mirror_; }

  // Approximately the share of light that each lobe reflects, for choosing between them.
  double DiffuseShare() const;
  double SpecularShare() const;

  Value Diffuse(const glm::dvec3& to_light) const;
  Value Specular(const glm::dvec3& to_light) const;
  Bounce SampleDiffuse(double u, double v) const;
  Bounce SampleSpecular(double u, double v) const;

 private:
  glm::dvec3 DiffuseWeight(const glm::dvec3& to_light, double cosine) const;
  double BounceOnce(double cosine) const;
  double Coupling(double cosine) const;
  glm::dvec3 Fresnel(double cosine) const;
  double Shadowing(double eye, double light) const;

  glm::dvec3 facing_;
  glm::dvec3 normal_;
  glm::dvec3 smooth_normal_;  // as SurfacePoint has it
  glm::dvec3 specular_normal_;
  glm::dvec3 to_eye_;
  glm::dvec3 diffuse_{0.0};
  glm::dvec3 f0_{0.0};
  bool fresnel_ =
      false;  // f0 grows to 1 at grazing angles, and the diffuse lobe gets the light that the coat transmits
  bool mirror_ = false;
  double diffuse_roughness_ = 0.0;
  glm::dvec3 many_bounces_{0.0};  // π times the part of what bounces on that does not depend on the light's direction
  bool cycles4_ = false;
  double alpha_ = 1.0;
};

// Whether a material can reflect light diffusely; textures are not read.
bool MayBeDiffuse(const Material& material);
bool MayBeSpecular(const Material& material);
bool MayEmit(const Material& material);

// Radiance that a surface point emits.
glm::dvec3 SurfaceEmission(const PlacedObject& object, std::uint32_t primitive, glm::dvec2 barycentric);

// Rec.709 luminance.
inline double Brightness(const glm::dvec3& c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

// Two unit vectors at right angles to `z` and to each other (Duff et al. 2017).
void MakeFrame(const glm::dvec3& z, glm::dvec3& x, glm::dvec3& y);
// A point of the unit disc for a point of the unit square, areas kept (Shirley & Chiu 1997).
glm::dvec2 SquareToDisc(double u, double v);

}  // namespace scumble
