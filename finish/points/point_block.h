// Steps that treat each pixel by itself, on blocks of pixels and on parts of pixels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/filter/light_contour.h"
#include "core/image/fragments.h"
#include "finish/finish.h"
#include "finish/tone/point_effect.h"

namespace scumble::internal {

struct PointStep {
  PointEffect apply;
  const FinishStep* step = nullptr;
  std::span<const float> coverage;  // the step changes only surfaces, as far as they cover; empty: it changes all
  PointEffect behind = {};          // what it does to background, where that is another thing; `coverage` parts the two
  std::vector<HardLight> lights = {};  // that the step looks at
};

// Whether the step changes the guides.
bool IsOfGuides(const FinishStep& step);

// Whether nothing of the paint is left to be seen, strokes of painted edges included.
bool HidesPaint(const FinishStep& step);

using Texel = FragmentColors::Texel;

// A surface that shows in a share of a pixel, and a pixel whose guides are like its own.
struct Part {
  std::size_t pixel, like;
  float share;
  std::uint16_t alpha;     // of the pixel, without its stroke
  bool is_stroke = false;  // of a painted edge: all of it is a surface, whatever the guides cover of the pixel
};

// `count` pixels of a picture, from `first` on; or that many parts of pixels.
struct Pixels {
  std::size_t first, count;
  const std::uint16_t* texels;
  const Part* parts = nullptr;

  std::size_t Of(std::size_t i) const { return parts ? parts[i].like : first + i; }
};

// A row of a picture as it was before the steps.
struct GivenRow {
  int y;
  std::size_t first;  // pixel
  std::vector<std::uint16_t> texels;

  std::size_t width() const { return texels.size() / 4; }
  Texel Of(std::size_t pixel) const {
    const std::uint16_t* const texel = texels.data() + 4 * (pixel - first);
    return {texel[0], texel[1], texel[2], texel[3]};
  }
};

// The parts of pixels one after the other, and the paint of each without the steps.
struct Batch {
  std::vector<Part> parts;
  std::vector<Texel> paint;
};

// Changes texels in place. Those whose colour no step changes keep their bits, those of alpha 0 too.
void PaintBlock(std::span<const PointStep> steps, const Pixels& pixels, std::uint16_t* texels);

// What the steps make of each part.
std::vector<Texel> PaintParts(std::span<const PointStep> steps, const Batch& batch);

}  // namespace scumble::internal
