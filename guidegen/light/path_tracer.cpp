#include "guidegen/light/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "guidegen/light/light_visibility.h"
#include "guidegen/rays/ray_offset.h"
#include "guidegen/rays/single_ray.h"
#include "guidegen/surface/shading_normal.h"

namespace scumble {
namespace {

// Reflections after which roulette begins: the paths before it carry most of the light.
constexpr int kFirstRoulette = 1;
constexpr double kLeastSurvival = 0.05;
// A wanted lobe is chosen with at least this probability, however little light it carries.
constexpr double kLeastLobe = 0.1;

// The sets of random numbers for points of lights on the first surface; the path's own begin at 0.
constexpr std::uint32_t kFirstLightSets = 1u << 16;

constexpr PathEvent kLobeEvents[2] = {PathEvent::kDiffuse, PathEvent::kSpecular};

// The balance heuristic: the weight of a technique of density `a` beside one of density `b`.
double Balance(double a, double b) { return std::isinf(a) ? 1.0 : a / (a + b); }

// The blur that a path applies after a wide reflection, by its smallest density so far: Cycles' "filter glossy" at its
// default of 1. Otherwise a mirror in diffuse light would show lights as fireflies.
double RoughenedAlpha(double density) { return density < 1.0 ? 0.5 * std::sqrt(1.0 - density) : 0.0; }

double Largest(const glm::dvec3& c) { return std::max(c.r, std::max(c.g, c.b)); }

}  // namespace

LightPathTracer::LightPathTracer(const EmbreeScene& scene, const View& view, const PathFollower& follower,
                                 int max_bounces)
    : scene_(scene),
      view_(view),
      follower_(follower),
      max_bounces_(max_bounces),
      lights_(view.lights, scene.objects(), view.world_radiance) {}

LightPathTracer::Vertex LightPathTracer::MakeVertex(std::uint32_t object, std::uint32_t primitive, const ViewRay& ray,
                                                    double clear_from, double least_alpha) const {
  const PlacedObject& placed = scene_.objects()[object];
  SurfacePoint point = FindSurfacePoint(placed, primitive, ray);
  if (view_.bends_normals) BendShadingNormal(placed, ray, point);
  point.max_ray_offset = MaxRayOffset(ray, clear_from, point.position);
  const SurfaceBsdf bsdf(placed, primitive, point, glm::normalize(-ray.direction), least_alpha);
  const double width = ray.width + ray.spread * glm::length(point.position - ray.origin);
  return {point, bsdf, ShadowRayOrigin(point), width, ray.spread, object, primitive};
}

LightPathTracer::First LightPathTracer::FirstVertex(const PathPixel& pixel) const {
  const ViewRay ray = view_.camera.ThroughWithFootprint(pixel.at.x, pixel.at.y);
  const Vertex vertex = MakeVertex(pixel.object, pixel.primitive, ray, double(pixel.clear_from), 0.0);
  return {vertex, LobesAt(vertex, follower_.AtEye(), max_bounces_ <= 0)};
}

void LightPathTracer::Add(const PathState& state, const glm::dvec3& light, PathSums& sums) const {
  for (int layer = 0; layer < int(follower_.layers().size()); ++layer) {
    if (follower_.WantsLight(state, layer)) sums[std::size_t(layer)] += light;
  }
}

LightPathTracer::Lobes LightPathTracer::LobesAt(const Vertex& vertex, const PathState& state, bool last) const {
  Lobes lobes;
  std::array<double, 2> share = {vertex.bsdf.DiffuseShare(), vertex.bsdf.SpecularShare()};
  for (int i = 0; i < 2; ++i) {
    lobes.after[i] = follower_.Step(state, kLobeEvents[i]);
    lobes.lit[i] = share[i] > 0.0 && follower_.WantsLight(lobes.after[i]);
    if (!(share[i] > 0.0)) continue;
    const bool useful = (!last && follower_.WantsMore(lobes.after[i])) || (lobes.lit[i] && MayMeetLight(vertex, i));
    if (!useful) share[i] = 0.0;
  }
  const double total = share[0] + share[1];
  if (!(total > 0.0)) return lobes;
  double diffuse = share[0] / total;
  if (share[0] > 0.0 && share[1] > 0.0) diffuse = std::clamp(diffuse, kLeastLobe, 1.0 - kLeastLobe);
  lobes.probability = {diffuse, 1.0 - diffuse};
  return lobes;
}

// Whether directions of a lobe search for a light, beside points drawn on it. Both techniques get one answer, so that
// their weights add up to one.
bool LightPathTracer::LooksFor(int light, const Vertex& vertex, int lobe) const {
  return lobe == 1 || lights_.IsWideFrom(vertex.point.position, light);
}

// Whether directions of a lobe may hit a light that they search for.
bool LightPathTracer::MayMeetLight(const Vertex& vertex, int lobe) const {
  if (lobe == 1 || lights_.has_world()) return lights_.CanBeMet();
  return lights_.CanBeMet() && lights_.AnyWideFrom(vertex.point.position);
}

bool LightPathTracer::IsBlocked(const Vertex& vertex, const LightDraw& draw, RayCounts& rays) const {
  ++rays.shadow;
  return scumble::IsBlocked(scene_, vertex.origin, draw);
}

// Next-event estimation. `probability` is that of the light's choice.
void LightPathTracer::AddDraw(const Vertex& vertex, const Lobes& lobes, int light, const LightDraw& draw,
                              double probability, const glm::dvec3& throughput, PathSums& sums, RayCounts& rays) const {
  if (draw.radiance == glm::dvec3(0.0)) return;
  const double density = draw.is_delta ? probability : probability * draw.density;
  if (!(density > 0.0) || std::isinf(density)) return;
  std::array<glm::dvec3, 2> reflected = {glm::dvec3(0.0), glm::dvec3(0.0)};
  bool any = false;
  for (int i = 0; i < 2; ++i) {
    if (!lobes.lit[i]) continue;
    const SurfaceBsdf::Value value =
        i == 0 ? vertex.bsdf.Diffuse(draw.direction) : vertex.bsdf.Specular(draw.direction);
    const bool looked_for = !draw.is_delta && LooksFor(light, vertex, i);
    const double other = looked_for ? lobes.probability[i] * value.density : 0.0;
    reflected[i] = throughput * value.value * draw.radiance / (density + other);
    any = any || reflected[i] != glm::dvec3(0.0);
  }
  if (!any || IsBlocked(vertex, draw, rays)) return;
  for (int i = 0; i < 2; ++i) {
    if (lobes.lit[i]) Add(lobes.after[i], reflected[i], sums);
  }
}

// Analytic lights that a sampled direction hits before `length`, and the world where it hits nothing.
void LightPathTracer::AddMet(const Vertex& vertex, const PathState& state, const Flight& flight, double length,
                             PathSums& sums) const {
  // From the ray's origin: a light in the surface itself is then behind it, however either is rounded.
  lights_.VisitAnalytic(vertex.origin, flight.direction, length,
                        [&](int light, const glm::dvec3& radiance, double density) {
                          if (!LooksFor(light, vertex, flight.lobe)) return;
                          const double other = density * ChoiceOf(light, vertex, flight);
                          Add(state, flight.throughput * radiance * Balance(flight.density, other), sums);
                        });
  if (std::isinf(length)) Add(state, flight.throughput * lights_.world(), sums);
}

void LightPathTracer::AddEmission(const Vertex& from, const Vertex& to, const PathState& state, const Flight& flight,
                                  PathSums& sums) const {
  const int light = lights_.EmitterOf(to.object);
  if (light < 0 || !LooksFor(light, from, flight.lobe)) return;
  const glm::dvec3 radiance = SurfaceEmission(scene_.objects()[to.object], to.primitive, to.point.barycentric);
  if (radiance == glm::dvec3(0.0)) return;
  const double other =
      lights_.EmitterDensity(light, from.point, to.primitive, to.point) * ChoiceOf(light, from, flight);
  Add(state, flight.throughput * radiance * Balance(flight.density, other), sums);
}

bool LightPathTracer::MayMeetLight(const Vertex& vertex, const Flight& flight) const {
  if (lights_.has_world() || lights_.has_emitters()) return true;
  bool met = false;
  const auto visit = [&](int light, const glm::dvec3&, double) { met = met || LooksFor(light, vertex, flight.lobe); };
  lights_.VisitAnalytic(vertex.origin, flight.direction, std::numeric_limits<double>::infinity(), visit);
  return met;
}

void LightPathTracer::AddExact(const First& pixel, PathSums& sums, RayCounts& rays) const {
  const auto& [first, lobes] = pixel;
  const PathState state = follower_.AtEye();
  if (follower_.WantsLight(state)) {
    Add(state, SurfaceEmission(scene_.objects()[first.object], first.primitive, first.point.barycentric), sums);
  }
  if (lights_.delta_count() == 0) return;
  if (!lobes.lit[0] && (!lobes.lit[1] || first.bsdf.IsMirror())) return;
  for (int light = 0; light < lights_.count(); ++light) {
    if (!lights_.IsDelta(light)) continue;
    AddDraw(first, lobes, light, lights_.Draw(light, first.point, 0.0, 0.0), 1.0, glm::dvec3(1.0), sums, rays);
  }
}

// Direct light on the first surface by a point of each light with extent: the only noise left is that of shadow edges.
void LightPathTracer::AddEach(const Vertex& vertex, const Lobes& lobes, const Sampler& sampler, std::uint32_t sample,
                              PathSums& sums, RayCounts& rays) const {
  for (int light = 0; light < lights_.count(); ++light) {
    if (lights_.IsDelta(light)) continue;
    const Quad u = sampler.Draw(sample, kFirstLightSets + std::uint32_t(light));
    const LightDraw draw = lights_.Draw(light, vertex.point, u[0], u[1]);
    AddDraw(vertex, lobes, light, draw, 1.0, glm::dvec3(1.0), sums, rays);
  }
}

// The probability with which a light was chosen at the vertex that a flight left.
double LightPathTracer::ChoiceOf(int light, const Vertex& vertex, const Flight& flight) const {
  if (flight.first && lights_.FewHaveExtent()) return 1.0;
  return lights_.Probability(vertex.point, light, !flight.first);
}

// Direct light on a vertex by one chosen light.
void LightPathTracer::AddChosen(const Vertex& vertex, const Lobes& lobes, const Quad& u, bool with_delta,
                                const glm::dvec3& throughput, PathSums& sums, RayCounts& rays) const {
  const LightChoice choice = lights_.Choose(vertex.point, u[0], with_delta);
  if (choice.light < 0) return;
  const LightDraw draw = lights_.Draw(choice.light, vertex.point, choice.remainder, u[1]);
  AddDraw(vertex, lobes, choice.light, draw, choice.probability, throughput, sums, rays);
}

// Continues the path by one of its lobes, roulette included. False where it ends.
bool LightPathTracer::Scatter(const Vertex& vertex, const Lobes& lobes, const Quad& u, int bounce,
                              Flight& flight) const {
  flight.lobe = u[2] < lobes.probability[0] ? 0 : 1;
  const double probability = lobes.probability[flight.lobe];
  if (!(probability > 0.0)) return false;
  const SurfaceBsdf::Bounce sampled =
      flight.lobe == 0 ? vertex.bsdf.SampleDiffuse(u[0], u[1]) : vertex.bsdf.SampleSpecular(u[0], u[1]);
  flight.throughput *= sampled.weight / probability;
  flight.direction = sampled.direction;
  flight.density = sampled.density * probability;
  flight.widest = std::min(flight.widest, sampled.blur_density);
  flight.first = bounce == 0;
  if (flight.throughput == glm::dvec3(0.0)) return false;
  if (bounce < kFirstRoulette) return true;
  // By the root, as in Cycles: a compromise between rare bright paths and many dim ones that cost time.
  const double survival = std::clamp(std::sqrt(Largest(flight.throughput)), kLeastSurvival, 1.0);
  flight.throughput /= survival;
  return u[3] < survival;
}

// Follows the flight to the next surface and adds the light on it; empty where the path ends.
std::optional<LightPathTracer::Vertex> LightPathTracer::Fly(const Vertex& vertex, const Lobes& lobes,
                                                            const Flight& flight, bool goes_on, PathSums& sums,
                                                            RayCounts& rays) const {
  const PathState& state = lobes.after[flight.lobe];
  const bool lit = lobes.lit[flight.lobe];
  if (!goes_on && !MayMeetLight(vertex, flight)) return std::nullopt;
  ++(goes_on ? rays.bounce : rays.shadow);
  const RTCRayHit hit = CastSingleRay(scene_, vertex.origin, flight.direction);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
    if (lit) AddMet(vertex, state, flight, std::numeric_limits<double>::infinity(), sums);
    return std::nullopt;
  }
  // A reflection keeps the growth of the footprint, and so does Cycles.
  const ViewRay ray{vertex.origin, flight.direction, vertex.width, vertex.spread};
  const Vertex next = MakeVertex(hit.hit.geomID, hit.hit.primID, ray, 0.0, RoughenedAlpha(flight.widest));
  if (lit) {
    AddMet(vertex, state, flight, glm::length(next.point.position - vertex.origin), sums);
    AddEmission(vertex, next, state, flight, sums);
  }
  return goes_on ? std::optional(next) : std::nullopt;
}

void LightPathTracer::AddSample(const First& first, const Sampler& sampler, std::uint32_t sample, PathSums& sums,
                                RayCounts& rays) const {
  Flight flight;
  Lobes lobes = first.lobes;
  std::optional<Vertex> next;
  const Vertex* vertex = &first.vertex;
  for (int bounce = 0;; ++bounce) {
    const bool first_surface = bounce == 0;
    if (lobes.lit[0] || lobes.lit[1]) {
      if (first_surface && lights_.FewHaveExtent()) {
        AddEach(*vertex, lobes, sampler, sample, sums, rays);
      } else {
        const Quad u = sampler.Draw(sample, std::uint32_t(2 * bounce + 1));
        AddChosen(*vertex, lobes, u, !first_surface, flight.throughput, sums, rays);
      }
    }
    if (!(lobes.probability[0] + lobes.probability[1] > 0.0)) return;
    if (!Scatter(*vertex, lobes, sampler.Draw(sample, std::uint32_t(2 * bounce)), bounce, flight)) return;
    const PathState state = lobes.after[flight.lobe];
    next = Fly(*vertex, lobes, flight, bounce < max_bounces_ && follower_.WantsMore(state), sums, rays);
    if (!next) return;
    vertex = &*next;
    lobes = LobesAt(*vertex, state, bounce + 1 >= max_bounces_);
  }
}

}  // namespace scumble
