// Grounds: the height of a paper's tooth, and how it looks bare.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "exemplars/paint/canvas.h"

namespace scumble::paint {

enum class Tooth {
  kLaid,       // fibres with a faint weave: charcoal and pastel paper
  kFine,       // even and close: drawing paper
  kColdPress,  // rounded hollows: watercolour paper
};

struct Stock {
  Tooth tooth = Tooth::kFine;
  float period = 4.0f;    // width of a grain, in units; on a tile it gives a little, so that a whole number fits
  glm::vec3 color{1.0f};  // sRGB-encoded
  float relief = 0.0f;    // how strongly light from the upper left shows the tooth
};

// Heights of the tooth in [0, 1], 0.5 in the middle.
Field MakeTooth(const Sheet& sheet, const Stock& stock, std::uint64_t seed);

// Bare paper with that tooth, mottled a little.
Colors MakePaper(const Field& tooth, const Stock& stock, std::uint64_t seed);

}  // namespace scumble::paint
