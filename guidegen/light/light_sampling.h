// Every light of a scene for a path tracer: chosen, sampled, and hit by rays. Analytic lights (those of the scene's
// list, with and without extent), meshes that emit, and the world. An analytic light has no surface: it casts no shadow
// and hides nothing.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "guidegen/light/direct_light.h"
#include "guidegen/light/emitter_pieces.h"
#include "guidegen/light/light_tree.h"
#include "guidegen/surface/surface.h"

namespace scumble {

// One sample of one light, seen from a point.
struct LightDraw {
  glm::dvec3 direction{0.0};  // unit, towards the light
  glm::dvec3 target{0.0};     // where the light is, unless endless
  bool endless = false;       // the light is infinitely far
  bool is_delta = false;
  glm::dvec3 radiance{0.0};  // of delta lights: the irradiance of a surface that faces them
  double density = 0.0;      // per solid angle, without the choice of the light; meaningless for delta lights
  // Of meshes that emit: the triangle of the target, and the distance from it, in metres along the ray, at which
  // Embree's floats may find the mesh.
  static constexpr std::uint32_t kNoObject = ~0u;
  std::uint32_t object = kNoObject;
  std::uint32_t primitive = 0;
  double rounding = 0.0;
};

// The lights of a scene. Borrows the objects, which must outlive it. Immutable; free to use from any thread.
class LightSet {
 public:
  LightSet(std::span<const PlacedLight> lights, std::span<const PlacedObject> objects, const glm::dvec3& world);

  // Lights are numbered: the analytic lights that are not black, then the objects that emit. The world has no number:
  // directions sampled from a surface's lobes meet it.
  int count() const { return int(analytic_.size() + emitters_.size()); }
  int delta_count() const { return delta_count_; }
  // Whether the lights with extent are so few that the first surface can sample each of them.
  static constexpr int kFewLights = 8;
  bool FewHaveExtent() const { return count() - delta_count_ <= kFewLights; }
  bool has_emitters() const { return !emitters_.empty(); }
  bool has_extended_analytic() const { return delta_count_ < int(analytic_.size()); }
  bool has_world() const { return world_ != glm::dvec3(0.0); }
  // Whether a ray may hit a light: whether any light but a delta light shines.
  bool CanBeMet() const { return has_emitters() || has_extended_analytic() || has_world(); }
  bool empty() const { return count() == 0 && !has_world(); }
  bool IsDelta(int light) const { return light < int(analytic_.size()) && analytic_[std::size_t(light)].IsDelta(); }
  bool IsEmitter(int light) const { return light >= int(analytic_.size()); }
  const glm::dvec3& world() const { return world_; }

  // Chooses a light about in proportion to its unoccluded irradiance at a point; `with_delta` says
  // whether delta lights take part.
  LightChoice Choose(const SurfacePoint& point, double u, bool with_delta) const;
  // The probability with which Choose takes this light.
  double Probability(const SurfacePoint& point, int light, bool with_delta) const;

  // Whether a light is wide from there, and whether any is; see IsWide in light_tree.h.
  bool IsWideFrom(const glm::dvec3& point, int light, double distance = kWideDistance) const {
    return IsWide(shapes_[std::size_t(light)], point, distance);
  }
  bool AnyWideFrom(const glm::dvec3& point) const;

  // u also chooses a triangle and is rescaled for it. A draw that cannot reach the point has no radiance.
  LightDraw Draw(int light, const SurfacePoint& point, double u, double v) const;

  // Calls visit(light, radiance, density) for each analytic light with extent that the ray hits before `length`
  // (infinite: it hits nothing else); `density` is Draw's. The caller handles the world.
  template <class Visit>
  void VisitAnalytic(const glm::dvec3& point, const glm::dvec3& direction, double length, const Visit& visit) const {
    if (!has_extended_analytic()) return;
    tree_.VisitAlong(point, direction, [&](int light) {
      if (IsEmitter(light)) return;
      const LightDraw met = Meet(light, point, direction, length);
      if (met.density > 0.0) visit(light, met.radiance, met.density);
    });
  }

  // Calls visit(emitter) for each mesh that emits and that the ray may hit, and for others near the ray.
  template <class Visit>
  void VisitEmitters(const glm::dvec3& point, const glm::dvec3& direction, const Visit& visit) const {
    if (!has_emitters()) return;
    tree_.VisitAlong(point, direction, [&](int light) {
      if (IsEmitter(light)) visit(light);
    });
  }

  // The light that an object is, or −1.
  int EmitterOf(std::uint32_t object) const { return emitter_of_[object]; }
  // The density with which Draw chooses the direction to this point of an emitter's triangle.
  double EmitterDensity(int light, const SurfacePoint& point, std::uint32_t primitive,
                        const SurfacePoint& on_emitter) const;

 private:
  struct Emitter {
    std::uint32_t object = 0;
    EmitterPieces pieces;
  };

  LightDraw Meet(int light, const glm::dvec3& point, const glm::dvec3& direction, double length) const;
  LightDraw DrawEmitter(const Emitter& emitter, const SurfacePoint& point, double u, double v) const;
  double Weight(int light, const SurfacePoint& point, bool with_delta) const;
  void AddEmitter(std::uint32_t object);

  std::span<const PlacedObject> objects_;
  std::vector<PlacedLight> analytic_;
  std::vector<Emitter> emitters_;
  std::vector<int> emitter_of_;    // by object
  std::vector<TreeLight> shapes_;  // by light
  LightTree tree_;
  glm::dvec3 world_{0.0};
  int delta_count_ = 0;
};

}  // namespace scumble
