// The path tracer behind the light-path layers: from the eye, with next-event estimation, multiple importance sampling
// and Russian roulette (Veach 1997; Kajiya 1986).
//
// Each reflection chooses one lobe, so that every path has one string of events, and what it carries goes to exactly
// the layers whose expression matches. On the first surface lights without extent are summed, not sampled: where
// nothing else is asked for, no random number is drawn. Lights with extent are each sampled there while they are few;
// everywhere else one light is chosen.
//
// No path's light is clamped. The result is biased all the same, as Cycles' is by default ("filter glossy" at 1): after
// a wide reflection, specular lobes are made rougher. Caustics, light that a mirror or a smooth metal throws on a
// diffuse surface, are blurred by it, and so is what a diffuse surface's light sees in them; no number of samples makes
// them sharp. What the eye sees first keeps its roughness.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>

#include "guidegen/guidegen.h"
#include "guidegen/light/light_sampling.h"
#include "guidegen/light/path_layers.h"
#include "guidegen/light/sampler.h"
#include "guidegen/light/view.h"
#include "guidegen/rays/embree_scene.h"
#include "guidegen/surface/bsdf.h"

namespace scumble {

// Radiance by the number of a follower's layer.
using PathSums = std::array<glm::dvec3, kMaxPathLayers>;

// A pixel whose light is wanted, by what its primary ray met.
struct PathPixel {
  std::uint32_t index = 0;  // in the picture
  std::uint32_t object = 0;
  std::uint32_t primitive = 0;
  glm::dvec2 at{0.0};       // where in the picture the ray went through
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
    glm::dvec3 origin;  // where rays leave it
    std::uint32_t object;
    std::uint32_t primitive;
  };
  // What can happen at a vertex: index 0 is the diffuse, 1 the specular lobe.
  struct Lobes {
    std::array<PathState, 2> after;          // where the path is with this reflection
    std::array<bool, 2> lit = {};            // light that comes by this lobe belongs to a layer
    std::array<double, 2> probability = {};  // with which the path goes on by this lobe
  };
  // A pixel's first surface, which all its samples share.
  struct First {
    Vertex vertex;
    Lobes lobes;
  };
  First FirstVertex(const PathPixel& pixel) const;

  // The part that needs no random numbers: emission that the eye sees, and delta lights on the first surface.
  void AddExact(const First& first, PathSums& sums, RayCounts& rays) const;
  // One path and all its light. The mean over the samples 0 … N − 1 and the exact part make the layers.
  void AddSample(const First& first, const Sampler& sampler, std::uint32_t sample, PathSums& sums,
                 RayCounts& rays) const;

 private:
  // The ray that carries a path on, and what it met.
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
