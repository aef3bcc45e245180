// Finds the template's printed marks in a scan or photograph, to a fraction of a pixel: AprilTag's detector at several
// scales of the picture, then refines each side of a mark in the full picture (core/style/scan/mark_edges.h).
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "core/style/fiducials.h"
#include "scumble/picture.h"

namespace scumble {

// Positions are in pixels of the whole picture, where pixel i covers [i, i + 1).
struct FoundMark {
  int id = 0;
  std::array<glm::dvec2, 4>
      corners;               // of the black border: upper left, upper right, lower right, lower left as printed
  double module_pixels = 0;  // a module's size in the picture
  double blur_pixels = 0;    // standard deviation of the blur across its sides
};

// The scales of the picture that are searched, by the pixels of its longer side. The coarsest alone takes some 30 ms.
inline constexpr int kCoarsestSearch = 900, kFinestSearch = 7200;

// The marks by place from the top; an id may occur twice if two sheets are in the picture. `picture` is opaque: alpha
// is ignored. `finest` is the last scale that is searched. Never fails: a picture without marks, or a mirrored one,
// gives none. Deterministic.
std::vector<FoundMark> FindMarks(const Picture& picture, int finest = kFinestSearch);

}  // namespace scumble
