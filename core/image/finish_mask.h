// Where a finishing effect works: its masks besides names of objects and materials.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "scumble/picture.h"

namespace scumble {

// Instead of a picture's name: 0 in the middle, 1 from the ellipse on that touches the picture's edges.
inline constexpr const char* kRadialMask = "radial";

// The share of an effect at each pixel is the product of these, or with `invert` what that leaves of 1.
struct FinishMask {
  double near = 0.0, far = 0.0;  // metres: depths between these; 0: that end is open
  double soft = 0.0;             // metres that both ends take to go from 0 to 1, half of them outside
  std::string shape;             // "", kRadialMask, or the name of a picture as it was given
  bool invert = false;

  std::filesystem::path file;              // of the picture
  std::shared_ptr<const Picture> picture;  // its share in the red channel

  bool HasDepth() const { return near > 0.0 || far > 0.0; }
  // Whether it leaves the effect as it is everywhere.
  bool empty() const { return !HasDepth() && shape.empty() && !invert; }
};

}  // namespace scumble
