// Borders between pixels, joined to lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/image/guides.h"
#include "finish/outline/border_map.h"

namespace scumble::internal {

// A border of one pixel's length. Positions are of the picture: pixel (0, 0) covers [0, 1) × [0, 1).
struct LinePoint {
  glm::vec2 at;         // on the line, near the middle of the border
  glm::vec2 to_owner;   // unit vector along x or y, to the pixel that the line belongs to
  std::uint32_t owner;  // that pixel: the nearer one, by and large; see line_owners.h
  LineClass line;
  bool has_side = true;  // the line lies at the end of a surface, and is no crease, shadow or other line on one
  bool meets = false;    // two objects meet there, and neither is nearer
  float shift = 0.0f;    // pixels towards the owner, by which the line misses the border where it runs along that
};

// The pixel on the other side of its border; `width`: of the picture.
inline std::size_t OtherSide(const LinePoint& point, int width) {
  return std::size_t(std::ptrdiff_t(point.owner) - std::ptrdiff_t(point.to_owner.x) -
                     std::ptrdiff_t(width) * std::ptrdiff_t(point.to_owner.y));
}

enum class LineEnd { kFree, kJunction, kPictureEdge };

// A contour that passes a junction, in front of all else.
struct PassingContour {
  glm::vec2 to_owner;   // a unit vector, at the junction
  std::uint32_t owner;  // a pixel there that the contour belongs to
  LineClass line;
};

struct LineChain {
  std::vector<LinePoint> points;
  bool closed = false;                                   // the last point is next to the first
  LineEnd begin = LineEnd::kFree, end = LineEnd::kFree;  // of an open line
  glm::vec2 first, last;                                 // where an open line begins and ends
  // Where it begins or ends at a junction that a contour passes. The line may be of that contour itself.
  std::optional<PassingContour> begin_contour, end_contour;
  bool begins_in_contour = false, ends_in_contour = false;
};

// Joins borders to lines from junction to junction, or round. Takes borders out of the map. Lines shorter than
// `shortest` borders that have a free end are noise and left out. Each line is smoothed: a position may move by up to
// `give` pixels across its border; half a pixel is as much as is unknown about it. Silhouettes begin where the coverage
// says, shadows where half shade lies between pixels of `shadow`, which is that of FindBorders. The order is that of
// the first border, row by row. Owners are settled (SettleOwners), if wanted. O(pixels).
std::vector<LineChain> TraceLines(BorderMap& borders, const GuideSet& guides, std::span<const float> shadow,
                                  double shortest, float give = 0.5f, bool settles_owners = true);

// `values` under a Gaussian of the chain's own smoothing, for quantities that follow a line.
void SmoothAlong(const LineChain& chain, std::vector<float>& values);

}  // namespace scumble::internal
