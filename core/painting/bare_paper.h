// The paper of an exemplar, and the paint without it.
#pragma once

#include <glm/glm.hpp>

#include "scumble/picture.h"

namespace scumble {

// The ground around a painted sphere, measured in the corners of its picture.
struct BarePaper {
  enum class Kind {
    kPaper,        // one colour, but for its grain
    kTransparent,  // nothing: alpha marks the paint
    kCovered,      // paint continues into the corners: its end is unknown
  };
  Kind kind = Kind::kCovered;
  glm::vec3 color{0.0f};  // linear; for kPaper
  glm::vec3 oklab{0.0f};  // the same colour

  static BarePaper OfColor(glm::vec3 color);
};

// The corners are what lies beyond 1.15 radii of the circle that fills a square, or of the ellipse that fills another
// picture. They are bare where at most a quarter of them is painted: opaque, or of another colour than their median;
// and where the four of them are of about one colour.
BarePaper FindBarePaper(const Picture& picture);

// Whether each of the four corners is bare and of one colour for itself, and they differ: paper that is lit unevenly,
// or paint whose tone changes slowly.
bool HasUnevenCorners(const Picture& picture);

// Whether FindBarePaper finds the corners transparent. Takes no memory.
bool HasClearCorners(const Picture& picture);

// The paint alone: alpha becomes its opacity, and the colour what it must be so that the paint over the paper is again
// what the picture shows, as far as colours reach. Paper as it is between strokes becomes transparent, its grain
// included. Without a paper colour alpha is opacity already and the texel stays.
void LiftPaint(const BarePaper& paper, std::uint16_t* texel);

}  // namespace scumble
