// Grounds: the height of a paper's tooth, and its bare look.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "exemplars/paint/engine/canvas.h"
#include "exemplars/paint/studio.h"

namespace scumble::paint {

enum class Tooth {
  kLaid,       // fibres with a faint weave: charcoal and pastel paper
  kFine,       // even and close: drawing paper
  kColdPress,  // rounded hollows: watercolour paper
  kRibbed,     // fibres over the fine level lines of a mould: old laid paper
};

struct Stock {
  Tooth tooth = Tooth::kFine;
  float period = 4.0f;    // width of a grain, in units; on a tile rounded so that a whole number fits
  glm::vec3 color{1.0f};  // sRGB-encoded
  float relief = 0.0f;    // how strongly light from the upper left shows the tooth
};

// Heights of the tooth in [0, 1], 0.5 in the middle.
Field MakeTooth(const Sheet& sheet, const Stock& stock, std::uint64_t seed);

// Bare paper with that tooth, slightly mottled.
Colors MakePaper(const Field& tooth, const Stock& stock, std::uint64_t seed);

// A sheet to paint on, and the same paper as a tile for its surroundings. They take the streams 0 and 1 of the studio's
// seed; a style's own passes begin at kFirstStream.
inline constexpr std::uint64_t kFirstStream = 2;
struct Ground {
  Field tooth;
  Colors paper;
};
Ground PrepareGround(const Sheet& sheet, const Stock& stock, std::uint64_t seed);
Picture PaperTile(const Studio& studio, const Stock& stock);

}  // namespace scumble::paint
