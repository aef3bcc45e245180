// The usual mistakes in a painted exemplar: what is wrong, where, and how a painter mends it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measure/painting/paint_traits.h"

namespace scumble {

struct PaintFault {
  enum class Weight {
    kMistake,  // pictures will suffer
    kRemark,   // legal, and perhaps not meant
  };
  std::string code;  // stable: "off-centre"; see docs/checking.md
  Weight weight = Weight::kMistake;
  std::string what;                          // what is wrong and where, a clause without the file's name
  std::string mend;                          // what to do, a clause
  std::optional<std::pair<int, int>> place;  // pixel of the file, from its upper left corner
};

// What faults depend on beside the painting itself.
struct PaintFaultContext {
  bool several = false;       // the style has other exemplars, for other light
  bool brightest = true;      // of these it has the most light
  int largest_size = 0;       // longest side of the largest of them, pixels
  double tonal_range = 0.0;   // of all of them together, L*
  bool has_paper = false;     // the style puts paper behind
  bool knows_guides = false;  // the painting has guides that say where its light is
  bool shows_marks = false;   // the template's marks are on it (LooksLikeTemplate)
  int margin = 0;             // of the template, that was cut off the file
};

// In the order of gravity; empty where all is well. A mistake that explains another hides it: an off-centre sphere has
// a fringe, which is not told as well.
std::vector<PaintFault> FindPaintFaults(const PaintTraits& traits, const PaintFaultContext& context);

}  // namespace scumble
