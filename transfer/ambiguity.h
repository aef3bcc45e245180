// Measures how well an exemplar covers the directions of surfaces, and how often it repeats itself. These numbers show
// why a cube makes a bad exemplar (Isaiev, "Example-based stylization of 3D renderings", figures 5 and 6, for guides of
// normals).
#pragma once

#include <cstddef>

#include "transfer/exemplar/guide_space.h"
#include "transfer/prepared_exemplar.h"

namespace scumble {

struct AmbiguityReport {
  // Of the hemisphere of directions that face the viewer, by solid angle:
  double covered_percent = 0;  // nearer than kCoveredDegrees to the normal of the source that matching gives them
  double mean_error_degrees = 0;
  double largest_error_degrees = 0;
  // The hemisphere in cells of equal area, each about kCellDegrees across:
  int cells = 0;
  int cells_shown = 0;  // that hold the normal of some usable pixel
  std::size_t usable_pixels = 0;
  std::size_t most_repeats = 0;  // pixels of the fullest cell
  double mean_repeats = 0;       // pixels a shown cell
  // The share of usable pixels in cells four times as full as the fullest of a sphere with as many pixels. They show
  // flat faces: one direction has many sources and the neighbouring directions have none.
  double flat_percent = 0;
};

inline constexpr double kCoveredDegrees = 5.0;
inline constexpr double kCellDegrees = 2.5;

// The ambiguity in a style's GuideSpace: all of its guides together.
struct SpaceAmbiguity {
  // Each direction that faces the viewer is tried at kLightSteps even steps from the least to the largest value of
  // every layer in the exemplar. The share whose source is nearer than the threshold to its guides. A sphere under one
  // light shows each direction in one light only, and covers little of this space.
  double covered_percent = 0;
  double mean_error = 0;  // distance, weighted
  // The space in cubes of side kGuideCell: those that hold some usable pixel, and the number of pixels in them.
  std::size_t cells_shown = 0;
  std::size_t most_repeats = 0;
  double mean_repeats = 0;
};

inline constexpr int kLightSteps = 8;
inline constexpr double kGuideCell = 0.0436;  // kCellDegrees, as a chord of the unit sphere

// Measures exemplar k. Some 6000 searches and O(usable pixels · log).
SpaceAmbiguity MeasureAmbiguity(const GuideSpace& space, const PreparedExemplar& exemplar, int k,
                                const GuideTest& test);

// O(usable pixels + cells). The result does not depend on threads.
AmbiguityReport MeasureAmbiguity(const PreparedExemplar& exemplar);

}  // namespace scumble
