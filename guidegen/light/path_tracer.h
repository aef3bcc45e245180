// The path tracer behind the light-path layers: from the eye, with next-event estimation, multiple importance sampling
// and Russian roulette (Veach 1997; Kajiya 1986).
//
// Each reflection chooses one lobe, so that every path has one string of events, and its light goes to exactly the
// layers whose expression matches. On the first surface lights without extent are summed, not sampled: if no other
// light is needed, no random number is drawn. Few lights with extent are each sampled there; everywhere else one light
// is chosen.
//
// No path's light is clamped. The result is still biased, as in Cycles by default ("filter glossy" at 1): after a wide
// reflection, specular lobes are made rougher. This blurs caustics, the light that a mirror or a smooth metal throws on
// a diffuse surface, and mirrors in diffuse light. More samples do not make them sharp. The first visible surface keeps
// its roughness.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>

#include "guidegen/guidegen.h"
#include "guidegen/light/light_sampling.h"
#include "guidegen/light/sampler.h"
#include "guidegen/light/view.h"
#include "guidegen/path_layers.h"
#include "guidegen/rays/embree_scene.h"
#include "guidegen/surface/bsdf.h"

namespace scumble {

// Radiance by the number of a follower's layer.
using PathSums = std::array<glm::dvec3, kMaxPathLayers>;

// A pixel whose light is wanted, with the hit of its primary ray.
struct PathPixel {
  std::uint32_t index = 0;  // in the picture
  std::uint32_t object = 0;
  std::uint32_t primitive = 0;
  glm::dvec2 at{0.0};       // the place in the picture of its ray
  float clear_from = 0.0f;  // as in TileHits
};

// Immutable; free to use from any thread.
class LightPathTracer {
 public:
  // All three outlive the tracer.
  LightPathTracer(const EmbreeScene& scene, const View& view, const PathFollower& follower, int max_bounces);

  // A surface on a path.
  struct Vertex {
    SurfacePoint point;
    SurfaceBsdf bsdf;
    glm::dvec3 origin;  // origin of the rays that leave it
    double width;       // of the pixel's footprint, m, and its growth for each further metre
    double spread;
    std::uint32_t object;
    std::uint32_t primitive;
  };
  // The possible reflections at a vertex: index 0 is the diffuse lobe, 1 the specular one.
  struct Lobes {
    std::array<PathState, 2> after;          // the path's state after this reflection
    std::array<bool, 2> lit = {};            // light through this lobe belongs to a layer
    std::array<double, 2> probability = {};  // that the path continues by this lobe
  };
  // A pixel's first surface, which all its samples share.
  struct First {
    Vertex vertex;
    Lobes lobes;
  };
  First FirstVertex(const PathPixel& pixel) const;

  // The part without random numbers: emission in view, and delta lights on the first surface.
  void AddExact(const First& first, PathSums& sums, RayCounts& rays) const;
  // One path and its light. The layers are the mean over the samples 0 … N − 1 plus the exact part.
  void AddSample(const First& first, const Sampler& sampler, std::uint32_t sample, PathSums& sums,
                 RayCounts& rays) const;

 private:
  // The ray that continues a path, and its hit.
  struct Flight {
    glm::dvec3 throughput{1.0};
    glm::dvec3 direction{0.0};
    int lobe = 0;
    double density = 0.0;                                     // of the direction, the choice of the lobe included
    double widest = std::numeric_limits<double>::infinity();  // the smallest density of any direction so far
    bool first = true;                                        // whether it leaves the first surface
  };

  Vertex MakeVertex(std::uint32_t object, std::uint32_t primitive, const ViewRay& ray, double clear_from,
                    double least_alpha) const;
  Lobes LobesAt(const Vertex& vertex, const PathState& state, bool last) const;
  void Add(const PathState& state, const glm::dvec3& light, PathSums& sums) const;
  bool IsBlocked(const Vertex& vertex, const LightDraw& draw, RayCounts& rays) const;
  void AddDraw(const Vertex& vertex, const Lobes& lobes, int light, const LightDraw& draw, double probability,
               const glm::dvec3& throughput, PathSums& sums, RayCounts& rays) const;
  void AddChosen(const Vertex& vertex, const Lobes& lobes, const Quad& u, bool with_delta, const glm::dvec3& throughput,
                 PathSums& sums, RayCounts& rays) const;
  bool Scatter(const Vertex& vertex, const Lobes& lobes, const Quad& u, int bounce, Flight& flight) const;
  std::optional<Vertex> Fly(const Vertex& vertex, const Lobes& lobes, const Flight& flight, bool goes_on,
                            PathSums& sums, RayCounts& rays) const;
  void AddMet(const Vertex& vertex, const PathState& state, const Flight& flight, double length, PathSums& sums) const;
  void AddEmission(const Vertex& from, const Vertex& to, const PathState& state, const Flight& flight,
                   PathSums& sums) const;
  void AddEach(const Vertex& vertex, const Lobes& lobes, const Sampler& sampler, std::uint32_t sample, PathSums& sums,
               RayCounts& rays) const;
  double ChoiceOf(int light, const Vertex& vertex, const Flight& flight) const;
  bool MayMeetLight(const Vertex& vertex, int lobe) const;
  bool MayMeetLight(const Vertex& vertex, const Flight& flight) const;
  bool LooksFor(int light, const Vertex& vertex, int lobe) const;

  const EmbreeScene& scene_;
  const View& view_;
  const PathFollower& follower_;
  const int max_bounces_;
  const LightSet lights_;
};

}  // namespace scumble
