#include "guidegen/surface/curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scumble {
namespace {

// Weights of the four control points, of value and derivatives, by the power of u.
struct Weights {
  double of[4];
};

Weights Values(double u) {
  const double u2 = u * u, u3 = u2 * u;
  return {0.5 * (-u3 + 2.0 * u2 - u), 0.5 * (3.0 * u3 - 5.0 * u2 + 2.0), 0.5 * (-3.0 * u3 + 4.0 * u2 + u),
          0.5 * (u3 - u2)};
}

Weights Slopes(double u) {
  const double u2 = u * u;
  return {0.5 * (-3.0 * u2 + 4.0 * u - 1.0), 0.5 * (9.0 * u2 - 10.0 * u), 0.5 * (-9.0 * u2 + 8.0 * u + 1.0),
          0.5 * (3.0 * u2 - 2.0 * u)};
}

Weights Bends(double u) {
  return {0.5 * (-6.0 * u + 4.0), 0.5 * (18.0 * u - 10.0), 0.5 * (-18.0 * u + 8.0), 0.5 * (6.0 * u - 2.0)};
}

template <class T>
T Sum(const Weights& weights, const T* values) {
  return values[0] * weights.of[0] + values[1] * weights.of[1] + values[2] * weights.of[2] + values[3] * weights.of[3];
}

// The ray as a line: a unit direction, and the part of places that is across it.
struct Line {
  glm::dvec3 origin, direction;

  explicit Line(const ViewRay& ray) : origin(ray.origin), direction(glm::normalize(ray.direction)) {}
  double Along(const glm::dvec3& place) const { return glm::dot(place - origin, direction); }
  glm::dvec3 Across(const glm::dvec3& place) const { return place - origin - direction * Along(place); }
};

// The place along the segment whose middle line passes nearest to the ray, in radii.
double NearestToRay(const CurveSegment& segment, const Line& line) {
  const auto miss = [&](double u) {
    const glm::dvec3 across = line.Across(segment.At(u));
    const double radius = std::max(segment.RadiusAt(u), 1e-300);
    return glm::dot(across, across) / (radius * radius);
  };
  constexpr int kPlaces = 8;
  int nearest = 0;
  double least = miss(0.0);
  for (int i = 1; i <= kPlaces; ++i) {
    const double here = miss(double(i) / kPlaces);
    if (here < least) least = here, nearest = i;
  }
  // The middle line's distance itself has no corners there: golden section.
  double low = std::max(0.0, double(nearest - 1) / kPlaces), high = std::min(1.0, double(nearest + 1) / kPlaces);
  constexpr double kGolden = 0.6180339887498949;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double miss_a = miss(a), miss_b = miss(b);
  for (int i = 0; i < 32; ++i) {
    if (miss_a < miss_b) {
      high = b, b = a, miss_b = miss_a;
      a = high - kGolden * (high - low), miss_a = miss(a);
    } else {
      low = a, a = b, miss_a = miss_b;
      b = low + kGolden * (high - low), miss_b = miss(b);
    }
  }
  return 0.5 * (low + high);
}

glm::dvec3 UnitOr(glm::dvec3 v, const glm::dvec3& otherwise) { return MakeUnit(v) ? v : otherwise; }

// Where a ray meets a straight piece of a ribbon: `along` the piece and `across` it, in [0, 1] and [-1, 1] where it
// does.
struct PieceHit {
  double along, across;
  double Miss() const { return std::max({-along, along - 1.0, std::abs(across) - 1.0, 0.0}); }
};

// The middle line at both ends of a piece, and the way from there to the edge, as seen along a ray; the ray is at 0.
// Newton's method on (1 - t) (from + s from_edge) + t (to + s to_edge) = 0.
PieceHit MeetPiece(const glm::dvec2& from, const glm::dvec2& from_edge, const glm::dvec2& to,
                   const glm::dvec2& to_edge) {
  const glm::dvec2 way = to - from;
  PieceHit hit{std::clamp(-glm::dot(from, way) / std::max(glm::dot(way, way), 1e-300), 0.0, 1.0), 0.0};
  for (int i = 0; i < 8; ++i) {
    const glm::dvec2 edge = glm::mix(from_edge, to_edge, hit.along);
    const glm::dvec2 miss = glm::mix(from, to, hit.along) + hit.across * edge;
    const glm::dvec2 by_along = way + hit.across * (to_edge - from_edge);
    const double determinant = by_along.x * edge.y - by_along.y * edge.x;
    if (!(std::abs(determinant) > 0.0)) break;
    hit.along -= (miss.x * edge.y - miss.y * edge.x) / determinant;
    hit.across -= (by_along.x * miss.y - by_along.y * miss.x) / determinant;
  }
  return hit;
}

// Embree's ribbon: `pieces` straight ones, whose edges are at right angles to the curve at their ends.
SurfacePoint RibbonPoint(const CurveSegment& segment, const Line& line, int pieces) {
  const glm::dvec3 back = -line.direction;
  const glm::dvec3 aside =
      UnitOr(glm::cross(back, std::abs(back.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)), glm::dvec3(0.0));
  const glm::dvec3 up = glm::cross(back, aside);
  const auto seen = [&](const glm::dvec3& v) { return glm::dvec2(glm::dot(v, aside), glm::dot(v, up)); };
  const auto across_at = [&](double u) { return UnitOr(glm::cross(segment.Tangent(u), back), glm::dvec3(0.0)); };
  double u = 0.0, sine = 0.0, length = 0.0, least_miss = std::numeric_limits<double>::infinity();
  for (int i = 0; i < pieces; ++i) {
    const double begin = double(i) / pieces, end = double(i + 1) / pieces;
    const glm::dvec3 from = segment.At(begin), to = segment.At(end);
    const PieceHit hit = MeetPiece(seen(from - line.origin), segment.RadiusAt(begin) * seen(across_at(begin)),
                                   seen(to - line.origin), segment.RadiusAt(end) * seen(across_at(end)));
    const double along = std::clamp(hit.along, 0.0, 1.0), miss = std::isfinite(hit.Miss()) ? hit.Miss() : 1e300;
    const double here = glm::mix(line.Along(from), line.Along(to), along);
    if (miss > least_miss || (miss == least_miss && here >= length)) continue;
    least_miss = miss, length = here;
    u = glm::mix(begin, end, along), sine = std::isfinite(hit.across) ? std::clamp(hit.across, -1.0, 1.0) : 0.0;
  }
  SurfacePoint point;
  point.position = line.origin + line.direction * length;
  const glm::dvec3 tangent = UnitOr(segment.Tangent(u), glm::dvec3(0.0)), across = across_at(u);
  const double cosine = std::sqrt(1.0 - sine * sine);
  point.normal = UnitOr(sine * across - cosine * UnitOr(glm::cross(tangent, across), -back), back);
  point.facing = point.normal;
  point.barycentric.x = u;
  return point;
}

// The place along the segment, near `u`, that is nearest to `place`: there the way to it is at right angles to the
// curve.
double NearestToPlace(const CurveSegment& segment, const glm::dvec3& place, double u) {
  for (int i = 0; i < 6; ++i) {
    const glm::dvec3 from = place - segment.At(u), slope = segment.Tangent(u);
    const double squared = glm::dot(slope, slope), bent = squared - glm::dot(from, segment.Bend(u));
    if (!(squared > 0.0)) break;
    u = std::clamp(u + glm::dot(from, slope) / (bent > 0.25 * squared ? bent : squared), 0.0, 1.0);
  }
  return u;
}

// The first point of the ray that is a radius away from the middle line. On the way there the distance from the line
// falls, ever more slowly: Newton's method from before the hair comes nearer and never too far.
SurfacePoint RoundPoint(const CurveSegment& segment, const Line& line) {
  double u = NearestToRay(segment, line);
  const double nearest = line.Along(segment.At(u));
  const double thickest = std::max(segment.RadiusAt(0.0), std::max(segment.RadiusAt(u), segment.RadiusAt(1.0)));
  const glm::dvec3 tangent = UnitOr(segment.Tangent(u), glm::dvec3(0.0));
  const double slant = std::max(glm::length(glm::cross(tangent, line.direction)), 0.05);
  double length = nearest - 1.5 * thickest / slant;
  glm::dvec3 normal = -line.direction;
  for (int i = 0; i < 32; ++i) {
    const glm::dvec3 place = line.origin + line.direction * length;
    u = NearestToPlace(segment, place, u);
    const glm::dvec3 from = place - segment.At(u);
    const double distance = glm::length(from), left = distance - segment.RadiusAt(u);
    normal = UnitOr(from, -line.direction);
    const double nearer = -glm::dot(normal, line.direction);  // by a step along the ray
    if (std::abs(left) <= 1e-9 * distance || !(nearer > 0.0)) break;
    const double next = std::min(length + left / nearer, nearest);
    if (next == length) break;
    length = next;
  }
  SurfacePoint point;
  point.position = line.origin + line.direction * length;
  // A ray that only just misses the rim meets it there.
  const double away = glm::dot(normal, line.direction);
  point.normal = away > 0.0 ? UnitOr(normal - away * line.direction, -line.direction) : normal;
  point.facing = point.normal;
  point.barycentric.x = u;
  return point;
}

}  // namespace

glm::dvec3 CurveSegment::At(double u) const { return Sum(Values(u), points); }
glm::dvec3 CurveSegment::Tangent(double u) const { return Sum(Slopes(u), points); }
glm::dvec3 CurveSegment::Bend(double u) const { return Sum(Bends(u), points); }
double CurveSegment::RadiusAt(double u) const { return Sum(Values(u), radii); }

double RadiusScale(const PlacedObject& object) {
  return std::cbrt(std::abs(glm::determinant(glm::dmat3(object.view_from_object))));
}

CurveSegment ViewSegment(const PlacedObject& object, std::uint32_t segment) {
  const Mesh& mesh = *object.mesh;
  const std::size_t first = mesh.curves.segments[segment];
  const double scale = RadiusScale(object);
  CurveSegment result;
  for (std::size_t i = 0; i < 4; ++i) {
    result.points[i] = glm::dvec3(object.view_from_object * glm::dvec4(glm::dvec3(mesh.positions[first + i]), 1.0));
    result.radii[i] = scale * double(mesh.curves.radii[first + i]);
  }
  return result;
}

SurfacePoint FindCurvePoint(const PlacedObject& object, std::uint32_t segment, const ViewRay& ray) {
  const CurveSegment curve = ViewSegment(object, segment);
  const Line line(ray);
  const bool is_ribbon = object.mesh->curves.ribbons;
  SurfacePoint point = is_ribbon ? RibbonPoint(curve, line, object.mesh->curves.pieces) : RoundPoint(curve, line);
  point.rest_position = RestPlaceOfCurve(object, segment, point.barycentric.x);
  const double clearance = is_ribbon ? 1.125 * curve.RadiusAt(point.barycentric.x) : 0.0;
  point.largest_coordinate = std::max(LargestCoordinate(point.position), clearance / kRoundingPerCoordinate);
  return point;
}

glm::dvec3 RestPlaceOfCurve(const PlacedObject& object, std::uint32_t segment, double u) {
  const Mesh& mesh = *object.mesh;
  const auto& places = mesh.rest_positions.empty() ? mesh.positions : mesh.rest_positions;
  const std::size_t first = mesh.curves.segments[segment];
  const glm::dvec3 points[4] = {places[first], places[first + 1], places[first + 2], places[first + 3]};
  return Sum(Values(u), points);
}

}  // namespace scumble
