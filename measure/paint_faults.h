// The usual mistakes in a painted exemplar: the mistake, its place, and the remedy.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measure/paint_traits.h"

namespace scumble {

struct PaintFault {
  enum class Weight {
    kMistake,  // pictures will suffer
    kRemark,   // legal, and perhaps not intended
  };
  std::string code;  // stable: "off-centre"; see docs/checking.md
  Weight weight = Weight::kMistake;
  std::string what;                          // the mistake and its place, a clause without the file's name
  std::string remedy;                        // the remedy, a clause
  std::optional<std::pair<int, int>> place;  // pixel of the file, from its upper left corner
};

// Where the template's marks show that its sphere lies.
struct MarkedSphere {
  double x = 0, y = 0, radius = 0;  // pixels of the exemplar's picture
  double turn = 0;                  // degrees clockwise
};

// The context of faults besides the exemplar itself.
struct PaintFaultContext {
  bool several = false;                     // the style has other exemplars, for other light
  bool brightest = true;                    // of these it has the most light
  int largest_size = 0;                     // longest side of the largest of them, pixels
  double tonal_range = 0.0;                 // of all of them together, L*
  bool has_paper = false;                   // the style puts paper behind
  bool knows_guides = false;                // its guides give the direction of its light
  bool shows_marks = false;                 // the template's marks are on it (LooksLikeTemplate)
  glm::ivec2 origin{0};                     // of the exemplar's picture in its file
  std::optional<MarkedSphere> marked = {};  // of a painted template, if its marks can be seen
};

// What is said of a soft edge that is wider than the style's rim, a clause.
std::string DescribeSoftEdge(int pixels);

// In the order of gravity; empty if there are none. A mistake that explains another hides it: an off-centre sphere has
// a fringe, which is not reported as well.
std::vector<PaintFault> FindPaintFaults(const PaintTraits& traits, const PaintFaultContext& context);

}  // namespace scumble
