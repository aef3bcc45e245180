// Circles and ellipses through the points of an outline, of which some lie elsewhere.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <span>

namespace scumble {

struct Circle {
  double x = 0, y = 0, radius = 0;  // pixels
  // The distance of a point from the circle's line.
  double Off(glm::dvec2 point) const;
};

struct CircleFit {
  Circle circle;
  std::size_t agree = 0;  // points within the tolerance
};

// The circle on which most points agree within `tolerance`, of those with a radius in that range. By random sampling of
// three points at a time (Fischler and Bolles 1981, with a fixed random seed), then least squares over the points that
// agree (Kåsa 1976). Empty if no three points make one. O(points).
std::optional<CircleFit> FitCircle(std::span<const glm::dvec2> points, double tolerance, double least_radius,
                                   double most_radius);

struct EllipseFit {
  double longer = 0, shorter = 0;  // diameters, pixels
  std::size_t agree = 0;           // points within the tolerance
};

// The ellipse through the points: least squares in the conic, repeated over the points near it. `around` is a point
// within the outline. Empty if the conic is no ellipse. O(points).
std::optional<EllipseFit> FitEllipse(std::span<const glm::dvec2> points, glm::dvec2 around, double tolerance);

}  // namespace scumble
