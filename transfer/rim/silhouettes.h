// The outlines of objects in a picture: the distance field that painted edges follow.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/filter/region.h"
#include "core/image/guides.h"

namespace scumble::internal {

// A pixel of an object beside a farther object or the background.
struct OutlinePixel {
  int x = 0, y = 0;
  glm::vec2 point{0.0f};     // of the outline, picture coordinates, y down
  glm::vec2 outward{0.0f};   // unit
  float width = 1.0f;        // 0 … 1: the possible width of an edge here, as a share of its full width; see below
  std::uint32_t beyond = 0;  // index of a pixel on the other side
  bool open = false;         // the background is on the other side
};

struct SilhouetteInput {
  const GuideSet& guides;                // with object and depth
  std::span<const std::uint16_t> style;  // per pixel; empty: style 0 everywhere
  std::span<const int> bands;            // by style: pixels on either side of the outline; 0: no outline
  Region region;                         // whose pixels Nearest serves
  int margin = 0;                        // pixels around it whose outlines are found too
};

// The outlines of objects in front of others or of the background. Object a is in front of b where they meet if b is
// farther from the camera by more than 1% of its distance; the outline tapers off below 3%. Pixels that no style paints
// (StyleMap::kPassThrough and kShadowCatcher) count as background, unless they are in front of the object.
// Self-occlusion makes no outline.
//
// `width` falls with the thickness of the object there: full from 8 bands on, and 0 below one band, where the outline
// stays exact. It also falls with the gap to the next object that is not behind: full from 3 bands on, and 0 below half
// a band. It is averaged over a band along the outline. Below kNarrowest nothing is painted.
class Silhouettes {
 public:
  explicit Silhouettes(const SilhouetteInput& input);

  // In row order, of the region grown by the margin.
  std::span<const OutlinePixel> outline() const { return outline_; }
  std::uint32_t ObjectOf(const OutlinePixel& pixel) const;
  // Calls visit(index) for the outline pixels of [x - reach, x + reach] × [y - reach, y + reach] in row order.
  template <class Visit>
  void ForNear(int x, int y, int reach, const Visit& visit) const;

  static constexpr float kNarrowest = 0.06f;  // narrower edges are left out
  static constexpr std::int32_t kNone = -1;
  // The nearest outline pixel that concerns pixel (x, y) of the region, of its own object or of one in front of it. Its
  // distance is at most its width times its band plus a pixel. kNone if there is none.
  std::int32_t Nearest(int x, int y) const;
  // Whether an edge along the outline reaches the pixel, and no object is in front of it there.
  bool Concerns(const OutlinePixel& outline, int x, int y) const;
  // Whether the pixel shows the outline's own object, so is inside of it.
  bool Inside(const OutlinePixel& outline, std::size_t pixel) const;
  int BandOf(const OutlinePixel& outline) const { return Band(input_.guides.Index(outline.x, outline.y)); }
  std::size_t StyleOf(const OutlinePixel& outline) const { return StyleOf(input_.guides.Index(outline.x, outline.y)); }

 private:
  template <class Visit>
  void ForNearInRow(int x, int y, int reach, const Visit& visit) const;
  std::size_t StyleOf(std::size_t i) const { return input_.style.empty() ? 0 : input_.style[i]; }
  bool Painted(std::size_t i) const;
  int Band(std::size_t i) const;
  float Step(std::size_t front, std::size_t behind) const;
  bool Behind(const OutlinePixel& outline, std::size_t pixel) const;
  void Find();
  void Straighten(OutlinePixel& pixel) const;
  float Room(const OutlinePixel& pixel) const;
  void Smooth();
  void FindNearest();
  std::int32_t Search(int x, int y) const;

  SilhouetteInput input_;
  std::span<const float> coverage_, depth_, object_;
  Region around_;
  std::vector<OutlinePixel> outline_;
  std::vector<std::uint32_t> row_;     // of the first outline pixel of each row of around_, and one more
  std::vector<int> row_reach_;         // by row of around_: the largest reach of an edge in it
  std::vector<std::int32_t> nearest_;  // by pixel of the region
  int widest_ = 0;
};

template <class Visit>
void Silhouettes::ForNearInRow(int x, int y, int reach, const Visit& visit) const {
  const std::uint32_t end = row_[std::size_t(y - around_.y0) + 1];
  std::uint32_t from = row_[std::size_t(y - around_.y0)], count = end - from;
  while (count > 0) {  // the first that is not too far left
    const std::uint32_t half = count / 2;
    if (outline_[from + half].x < x - reach)
      from += half + 1, count -= half + 1;
    else
      count = half;
  }
  for (; from < end && outline_[from].x <= x + reach; ++from) visit(from);
}

template <class Visit>
void Silhouettes::ForNear(int x, int y, int reach, const Visit& visit) const {
  for (int v = std::max(around_.y0, y - reach); v <= std::min(around_.y1 - 1, y + reach); ++v)
    ForNearInRow(x, v, reach, visit);
}

}  // namespace scumble::internal
