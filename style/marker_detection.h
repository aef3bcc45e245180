// Finds the template's printed marks in a scan or photograph, to a fraction of a pixel.
//
// As ArUco does it (the paper is named in style/fiducials.h): the picture is cut at a moving mean, outlines of dark
// patches that are squares seen in perspective are read as 4 × 4 bits. Then each side of a mark is laid anew through
// the places where the light changes along it, in the full picture. It is written here because that is little, and
// OpenCV's module would bring Debian's users 77 packages, a window system and a text reader among them.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "image/picture.h"
#include "style/fiducials.h"

namespace scumble {

// Positions are in pixels of the whole picture, where pixel i covers [i, i + 1).
struct FoundMark {
  int id = 0;
  bool mirrored = false;  // its bits are right in a mirror only
  std::array<glm::dvec2, 4>
      corners;  // of the black border: upper left, upper right, lower right, lower left as printed
  int wrong_bits = 0;
  double module_pixels = 0;  // how large a module is seen
  double blur_pixels = 0;    // standard deviation of the blur across its sides
  double corner_pixels = 0;  // standard error of a corner, from how far its sides' points lie from straight lines
};

struct MarkSearch {
  std::vector<FoundMark> marks;  // by place from the top; an id may come twice if two sheets are in the picture
  int unknown_squares = 0;       // black squares with a marker's border whose bits are none of the template's
};

// `picture` is opaque: alpha is not looked at. Never fails; pictures without marks give none. The same marks for the
// same picture, always.
MarkSearch FindMarks(const Picture& picture);

// Looks for marks where they are expected, corners in printed order as above, and tells those whose bits are there:
// also marks that paint has run into, of which at most four bits may be hidden.
std::vector<FoundMark> FindMarksAt(const Picture& picture, std::span<const FoundMark> expected);

}  // namespace scumble
