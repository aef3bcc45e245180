// A flat brush of hair, loaded with opaque paint: a row of bristles side by side that start and lift almost together,
// each leaving its own streak of colour and of thickness.
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "exemplars/paint/engine/brush.h"
#include "exemplars/paint/engine/chance.h"
#include "exemplars/paint/engine/strokes.h"
#include "exemplars/paint/studio.h"

namespace scumble::paint {

// One load of the brush. Lengths are in units of kSide.
struct Load {
  glm::vec3 color;              // sRGB-encoded
  float width = 12.0f;          // of the row
  float bristle = 2.2f;         // radius of one
  float ragged = 3.0f;          // random differences between the bristles' ends
  float rounded = 0.0f;         // 1: the row's ends are half circles, 0: square
  float tremble = 0.0f;         // random offset of the place where a bristle reads the touch
  float streaks = 1.0f;         // the difference between the bristles' colours
  float height = 0.5f;          // how thick the paint stands, 0 … 1
  float ridge = 0.15f;          // how much thicker at the row's sides
  glm::vec2 press{0.8f, 0.7f};  // at the start and at the end; below 0.4 bristles get thin, and gaps open between them
};

class FlatBrush {
 public:
  // `hair` is the preset of one bristle.
  static Expected<FlatBrush> Cut(const Studio& studio, const std::string& hair);

  // Draws along the path. Each bristle reads `touch` at its own place, so the row's end follows a border. `heights`,
  // which may be null, takes the thickness in its channels.
  void Drag(Canvas& colors, Canvas* heights, Chance& chance, const Stroke& path, const Load& load,
            const Touch& touch = {});

 private:
  FlatBrush(Brush paint, Brush relief);

  Brush paint_;
  Brush relief_;
};

// A short path for one touch of the brush: `length` units through `middle` along `direction`, bent a little.
Stroke ShortPath(Chance& chance, glm::vec2 middle, glm::vec2 direction, float length, float bend = 0.12f);

}  // namespace scumble::paint
