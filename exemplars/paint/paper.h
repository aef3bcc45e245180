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

// Heights of the tooth in [0, 1], 0.5 in the middle. `period` is the width of a grain in units of kSide.
Field MakeTooth(int size, Tooth tooth, float period, std::uint64_t seed);

// Bare paper of the given colour: mottled a little, its tooth lit from the upper left by `relief`.
Colors MakePaper(const Field& tooth, glm::vec3 color, float relief, std::uint64_t seed);

}  // namespace scumble::paint
