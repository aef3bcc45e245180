// Finds the one painted sphere in a picture that it may not fill.
#pragma once

#include "core/image/style.h"
#include "core/painting/circle_fit.h"
#include "scumble/picture.h"

namespace scumble {

struct FoundSphere {
  enum class Kind {
    kFills,     // nothing speaks against a sphere that fills the square
    kInside,    // one sphere that clearly does not: `circle`
    kUnclear,   // paint that clearly does not fill the picture, and no sphere that is sure
    kEllipse,   // one ellipse: `longer` and `shorter`
    kSeveral,   // two spheres or more: the two largest are `circle` and `second`
    kNoGround,  // the corners are neither bare paper of one colour nor transparent, so that paint has no known end
  };
  Kind kind = Kind::kFills;
  Circle circle = {};                      // pixels of the picture
  Circle second = {};                      // of kSeveral
  double longer = 0, shorter = 0;          // of kEllipse: diameters, pixels
  SphereDoubt doubt = SphereDoubt::kNone;  // of kUnclear and kNoGround; of kShadow, the sphere is `circle`
};

// Looks at the outline of the paint against transparency or paper of one colour, which the corners show. A square whose
// paint comes within 0.75% of all four sides is kFills.
//
// kInside needs a circle on which the outline lies in 80% of all directions from its centre; that lies within the
// picture, with hardly any paint beyond it; and that, in a square, is smaller than 98.5% of the width, or more than 1%
// off the middle without covering the square's own circle. In a picture that is no square, the sphere may reach the
// sides: only directions count in which ground shows beyond it, a quarter of all at least. The tolerance is a quarter
// of the largest distance between the two circles, at most 2.5% of the radius: the farther a sphere is from filling its
// square, the more roughly it may be painted. The radius is the one that the paint reaches in 95% of those directions.
// An outline is kEllipse if its shorter diameter is less than 97% of the longer: a circle that is cut out by hand stays
// within that.
//
// In a square, kUnclear is said only where the paint leaves 3% free at three sides, or 10% at two opposite ones: paper
// that was left for the lights reaches one or two sides. A picture that is no square is never kFills. A sphere has 30
// pixels across or more. O(pixels); a picture that kFills takes some milliseconds. Memory: at most 8 bytes for each
// pixel.
FoundSphere FindSphere(const Picture& picture);

}  // namespace scumble
