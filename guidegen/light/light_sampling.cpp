#include "guidegen/light/light_sampling.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numbers>

#include "guidegen/rays/ray_offset.h"
#include "guidegen/surface/bsdf.h"
#include "guidegen/surface/work_counters.h"

namespace scumble {
namespace {

using std::numbers::pi;

// The distance from a plane, over the largest coordinate, below which doubles do not determine the side.
constexpr double kFlat = 0x1.0p-40;

// Larger irradiance does not fit a float once it is reflected, and could overflow before.
constexpr double kMostIrradiance = std::numeric_limits<float>::max();

double AreaOf(const PlacedLight& light) {
  const double sides = glm::length(light.half_x) * glm::length(light.half_y);
  return light.ellipse ? pi * sides : 4.0 * sides;
}

// A sun is a disc at a distance of 1, sampled by area; `cosine` is that of the angle to its middle.
double SunDensity(const PlacedLight& sun, double cosine) {
  const double radius = std::tan(sun.half_angle);
  return 1.0 / (pi * radius * radius * cosine * cosine * cosine);
}

// From a density per area to one per solid angle.
double PerSolidAngle(double area, double square, double cosine) {
  return area > 0.0 && cosine > 0.0 ? square / (area * cosine) : 0.0;
}

LightDraw DrawDelta(const PlacedLight& light, const glm::dvec3& point) {
  LightDraw draw;
  draw.is_delta = true;
  if (light.type == LightType::kSun) {
    draw.direction = -light.axis;
    draw.endless = true;
    draw.radiance = light.color;
    return draw;
  }
  const glm::dvec3 to_light = light.position - point;
  const double length = glm::length(to_light);
  if (!(length > 0.0)) return draw;
  draw.direction = to_light / length;
  draw.target = light.position;
  const double share = SpotAttenuation(light, -draw.direction) / std::max(length * length, kLeastSquaredDistance);
  for (int i = 0; i < 3; ++i) draw.radiance[i] = std::min(light.color[i] * share, kMostIrradiance);
  return draw;
}

// The radiance is the irradiance times the density, as in Cycles: all directions contribute equally.
LightDraw DrawSun(const PlacedLight& sun, double u, double v) {
  LightDraw draw;
  draw.endless = true;
  const glm::dvec2 disc = SquareToDisc(u, v) * std::tan(sun.half_angle);
  glm::dvec3 x, y;
  MakeFrame(-sun.axis, x, y);
  draw.direction = glm::normalize(x * disc.x + y * disc.y - sun.axis);
  draw.density = SunDensity(sun, -glm::dot(draw.direction, sun.axis));
  draw.radiance = sun.color * draw.density;
  return draw;
}

LightDraw DrawBall(const PlacedLight& light, const glm::dvec3& point, double u, double v) {
  LightDraw draw;
  const glm::dvec3 to_light = light.position - point;
  const double distance = glm::length(to_light);
  if (!(distance > 0.0)) return draw;
  const glm::dvec3 axis = to_light / distance;
  glm::dvec3 x, y;
  MakeFrame(axis, x, y);
  const glm::dvec2 disc = SquareToDisc(u, v) * light.radius;
  draw.target = light.position + x * disc.x + y * disc.y;
  const glm::dvec3 to_target = draw.target - point;
  const double square = glm::dot(to_target, to_target);
  draw.direction = to_target / std::sqrt(square);
  const double area = pi * light.radius * light.radius;
  draw.density = PerSolidAngle(area, square, glm::dot(axis, draw.direction));
  draw.radiance = light.color * (SpotAttenuation(light, -draw.direction) / area);
  return draw;
}

LightDraw DrawArea(const PlacedLight& light, const glm::dvec3& point, double u, double v) {
  LightDraw draw;
  const glm::dvec2 at = light.ellipse ? SquareToDisc(u, v) : glm::dvec2(2.0 * u - 1.0, 2.0 * v - 1.0);
  draw.target = light.position + light.half_x * at.x + light.half_y * at.y;
  const glm::dvec3 to_target = draw.target - point;
  const double square = glm::dot(to_target, to_target);
  if (!(square > kLeastSquaredDistance)) return draw;
  draw.direction = to_target / std::sqrt(square);
  draw.density = PerSolidAngle(AreaOf(light), square, -glm::dot(light.axis, draw.direction));
  if (draw.density > 0.0) draw.radiance = light.color;
  return draw;
}

LightDraw MeetSun(const PlacedLight& sun, const glm::dvec3& direction) {
  LightDraw met;
  // Uses the sine, which resolves small angles; beyond a right angle the sine falls again.
  const double sine = glm::length(glm::cross(direction, sun.axis));
  const double cosine = -glm::dot(direction, sun.axis);
  if (!(cosine > 0.0) || sine > std::sin(sun.half_angle)) return met;
  met.density = SunDensity(sun, cosine);
  met.radiance = sun.color * met.density;
  return met;
}

LightDraw MeetBall(const PlacedLight& light, const glm::dvec3& point, const glm::dvec3& direction, double length) {
  LightDraw met;
  const glm::dvec3 to_light = light.position - point;
  const double distance = glm::length(to_light);
  const double along = glm::dot(to_light, direction);
  if (!(along > 0.0) || !(distance > 0.0)) return met;
  const double t = distance * (distance / along);
  if (!(t - LightGap(point, point + direction * t) < length)) return met;
  const glm::dvec3 off = direction * t - to_light;
  if (glm::dot(off, off) > light.radius * light.radius) return met;
  const double area = pi * light.radius * light.radius;
  met.density = PerSolidAngle(area, t * t, along / distance);
  met.radiance = light.color * (SpotAttenuation(light, -direction) / area);
  return met;
}

LightDraw MeetArea(const PlacedLight& light, const glm::dvec3& point, const glm::dvec3& direction, double length) {
  LightDraw met;
  const double cosine = -glm::dot(light.axis, direction);
  if (!(cosine > 0.0)) return met;
  const glm::dvec3 to_light = light.position - point;
  const double t = -glm::dot(to_light, light.axis) / cosine;
  if (!(t > 0.0) || !(t - LightGap(point, point + direction * t) < length)) return met;
  const glm::dvec3 off = direction * t - to_light;
  const double x = glm::dot(off, light.half_x) / glm::dot(light.half_x, light.half_x);
  const double y = glm::dot(off, light.half_y) / glm::dot(light.half_y, light.half_y);
  const bool inside = light.ellipse ? x * x + y * y <= 1.0 : std::abs(x) <= 1.0 && std::abs(y) <= 1.0;
  if (!inside) return met;
  met.density = PerSolidAngle(AreaOf(light), t * t, cosine);
  met.radiance = light.color;
  return met;
}

// The largest share of a spot's intensity that reaches a place from any point of its disc: that of the point nearest
// the axis. The attenuation depends on the part along the axis alone.
double MostAttenuation(const PlacedLight& spot, const glm::dvec3& from_centre) {
  const double distance = glm::length(from_centre);
  if (!(distance > spot.radius)) return 1.0;
  const double cosine = glm::dot(spot.axis, from_centre) / distance;
  const double turn = spot.radius / distance;
  const double straight = std::sqrt(1.0 - turn * turn);
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  return SpotAttenuation(spot, spot.axis * (cosine < straight ? cosine * straight + sine * turn : 1.0));
}

TreeLight ShapeOf(const PlacedLight& light) {
  TreeLight shape{light.position, light.radius, std::min(Brightness(light.color), kMostIrradiance), false,
                  light.IsDelta()};
  shape.is_sun = light.type == LightType::kSun;
  if (shape.is_sun) shape.radius = light.half_angle;
  if (light.type == LightType::kArea) {
    shape.radius = glm::length(light.half_x) + glm::length(light.half_y);
    shape.power *= AreaOf(light);
  }
  return shape;
}

}  // namespace

LightSet::LightSet(std::span<const PlacedLight> lights, std::span<const PlacedObject> objects, const glm::dvec3& world)
    : objects_(objects), emitter_of_(objects.size(), -1), world_(world) {
  for (const PlacedLight& light : lights) {
    if (light.color == glm::dvec3(0.0) || (light.type == LightType::kArea && !(AreaOf(light) > 0.0))) continue;
    analytic_.push_back(light);
    shapes_.push_back(ShapeOf(light));
    if (light.IsDelta()) ++delta_count_;
  }
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].mesh && MayEmit(*objects[i].material)) AddEmitter(std::uint32_t(i));
  }
  tree_ = LightTree(shapes_);
}

void LightSet::AddEmitter(std::uint32_t object) {
  const PlacedObject& placed = objects_[object];
  std::vector<Triangle> triangles(placed.mesh->triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = ViewTriangle(placed, std::uint32_t(i));
  Emitter emitter{object, EmitterPieces(triangles)};
  const double area = emitter.pieces.area();
  if (!(area > 0.0) || !std::isfinite(area)) return;
  const double power = std::min(Brightness(glm::dvec3(placed.material->emission)), kMostIrradiance) * area;
  shapes_.push_back({emitter.pieces.centre(), emitter.pieces.radius(), power, false, false});
  emitter_of_[object] = count();
  emitters_.push_back(std::move(emitter));
}

double LightSet::Weight(int light, const SurfacePoint& point, bool with_delta) const {
  const TreeLight& shape = shapes_[std::size_t(light)];
  if (shape.is_delta && !with_delta) return 0.0;
  if (IsEmitter(light)) return SphereWeight(shape.centre, shape.radius, shape.power, point);
  const PlacedLight& placed = analytic_[std::size_t(light)];
  if (shape.is_sun) return SunWeight(-placed.axis, placed.half_angle, shape.power, point);
  const glm::dvec3 from_light = point.position - placed.position;
  if (placed.type == LightType::kArea && !(glm::dot(from_light, placed.axis) > 0.0)) return 0.0;
  const double weight = SphereWeight(shape.centre, shape.radius, shape.power, point);
  return placed.type == LightType::kSpot && weight > 0.0 ? weight * MostAttenuation(placed, from_light) : weight;
}

bool LightSet::AnyWideFrom(const glm::dvec3& point) const {
  return std::any_of(shapes_.begin(), shapes_.end(), [&](const TreeLight& light) { return IsWide(light, point); });
}

LightChoice LightSet::Choose(const SurfacePoint& point, double u, bool with_delta) const {
  return tree_.Choose(point, u, with_delta, [&](int light) { return Weight(light, point, with_delta); });
}

double LightSet::Probability(const SurfacePoint& point, int light, bool with_delta) const {
  if (!with_delta && IsDelta(light)) return 0.0;
  return tree_.Probability(point, light, with_delta, [&](int other) { return Weight(other, point, with_delta); });
}

LightDraw LightSet::Draw(int light, const SurfacePoint& point, double u, double v) const {
  ++thread_counters.light_samples;
  if (IsEmitter(light)) return DrawEmitter(emitters_[std::size_t(light) - analytic_.size()], point, u, v);
  const PlacedLight& placed = analytic_[std::size_t(light)];
  if (placed.IsDelta()) return DrawDelta(placed, point.position);
  if (placed.type == LightType::kSun) return DrawSun(placed, u, v);
  if (placed.type == LightType::kArea) return DrawArea(placed, point.position, u, v);
  return DrawBall(placed, point.position, u, v);
}

LightDraw LightSet::Meet(int light, const glm::dvec3& point, const glm::dvec3& direction, double length) const {
  const PlacedLight& placed = analytic_[std::size_t(light)];
  if (placed.IsDelta()) return {};
  if (placed.type == LightType::kSun) return std::isinf(length) ? MeetSun(placed, direction) : LightDraw{};
  if (placed.type == LightType::kArea) return MeetArea(placed, point, direction, length);
  return MeetBall(placed, point, direction, length);
}

LightDraw LightSet::DrawEmitter(const Emitter& emitter, const SurfacePoint& point, double u, double v) const {
  LightDraw draw;
  const EmitterPieces::Choice choice = emitter.pieces.Choose(point, u);
  if (!(choice.area > 0.0)) return draw;
  const PlacedObject& object = objects_[emitter.object];
  const std::uint32_t primitive = choice.primitive;
  const Triangle triangle = ViewTriangle(object, primitive);
  const double root = std::sqrt(choice.remainder);
  const glm::dvec2 barycentric(root * (1.0 - v), root * v);
  const glm::dvec3 first = triangle.corner[1] - triangle.corner[0];
  const glm::dvec3 second = triangle.corner[2] - triangle.corner[0];
  draw.target = triangle.corner[0] + first * barycentric.x + second * barycentric.y;
  const glm::dvec3 to_target = draw.target - point.position;
  const double square = glm::dot(to_target, to_target);
  if (!(square > kLeastSquaredDistance)) return draw;
  draw.direction = to_target / std::sqrt(square);
  const glm::dvec3 normal = glm::normalize(glm::cross(first, second));
  double largest = LargestCoordinate(point.position);
  for (const glm::dvec3& corner : triangle.corner) largest = std::max(largest, LargestCoordinate(corner));
  // A flat emitter does not light itself: this near its plane, the side is rounding alone.
  const double off_plane = std::abs(glm::dot(normal, to_target));
  if (!(off_plane > largest * kFlat)) return draw;
  const double cosine = off_plane / std::sqrt(square);
  draw.density = PerSolidAngle(choice.area, square, cosine);
  if (draw.density > 0.0 && !IsHole(object, primitive, barycentric)) {
    draw.radiance = SurfaceEmission(object, primitive, barycentric);
  }
  draw.object = emitter.object;
  draw.primitive = primitive;
  draw.rounding = largest * kRoundingPerCoordinate / cosine;
  return draw;
}

double LightSet::EmitterDensity(int light, const SurfacePoint& point, std::uint32_t primitive,
                                const SurfacePoint& on_emitter) const {
  const Emitter& emitter = emitters_[std::size_t(light) - analytic_.size()];
  const glm::dvec3 to_emitter = on_emitter.position - point.position;
  const double square = glm::dot(to_emitter, to_emitter);
  if (!(square > kLeastSquaredDistance)) return 0.0;
  const double cosine = std::abs(glm::dot(on_emitter.facing, to_emitter)) / std::sqrt(square);
  return PerSolidAngle(emitter.pieces.AreaFor(point, primitive), square, cosine);
}

}  // namespace scumble
