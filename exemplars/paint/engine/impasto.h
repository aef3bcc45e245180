// Oil paint laid on wet and thick. Bundles of bristles drag it around the light, and a second canvas stores the
// thickness that each bristle leaves, so that lighting it shows the relief.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>

#include "exemplars/paint/engine/brush.h"
#include "exemplars/paint/engine/chance.h"
#include "exemplars/paint/studio.h"

namespace scumble::paint {

// Colours from the lightest to the core of the shade, and the reflected light in it. All sRGB-encoded.
struct Palette {
  glm::vec3 high, light, middle, turn, core, reflected;
  // Each stroke's colour is varied with one of these, the cool ones towards the shade.
  std::array<glm::vec3, 2> warm, cool;

  glm::vec3 At(const Shading& shading) const;
};

// One size of brush, worked over the whole picture.
struct BrushLayer {
  float spacing;  // of the strokes' middles
  float width_min, width_max;
  float length_min, length_max;
  float sway;            // deviation of strokes from the circles around the light
  float broken;          // variation of colour from stroke to stroke
  float bristle;         // radius of one; they lie a little more than that apart
  bool details_only;     // only where the tones change fast
  float across = 0.18f;  // share of the strokes that go across the form
};

class Impasto {
 public:
  // `undertone` shows between strokes. `thickness` is a share of the paint of a full brush.
  static Expected<Impasto> Begin(const Sheet& sheet, const Studio& studio, glm::vec3 undertone, float thickness = 1.0f);

  // Paints over the sphere, lit by the studio's light, in strokes of the layers' sizes.
  void WorkOver(const Palette& palette, std::span<const BrushLayer> layers);

  // One stroke of such a brush, outside the plan.
  struct Tuft {
    float width;
    float bristle;
    float load;            // how thick the paint is, 0 … 1
    float streaks = 1.0f;  // the difference between the colours of its bristles
  };
  void DragBristles(Chance& chance, const Stroke& path, const Tuft& tuft, glm::vec3 color);

  // Thick dabs of one colour at the mirror image of the key light.
  void PlaceHighlight(glm::vec3 color, int dabs);

  // Loose strokes of one quiet colour, in two slanting directions. No stroke stands out: it would be noticed in every
  // tile.
  void BrushGround(glm::vec3 color);

  // Light across the relief; `depth` weakens it for the background.
  Colors Finish(float depth = 1.0f) const;

 private:
  Impasto(const Sheet& sheet, const Studio& studio, glm::vec3 undertone, float thickness, Brush paint, Brush relief);

  std::uint64_t seed_;
  Light light_;
  float thickness_;
  Brush paint_;
  Brush relief_;
  std::unique_ptr<Canvas> colors_;
  std::unique_ptr<Canvas> heights_;
};

}  // namespace scumble::paint
