// Frame setup: the style mask, and clearing of the previous frame.
#pragma once

#include <cstdint>
#include <vector>

#include "core/filter/region.h"
#include "core/image/guides.h"
#include "scumble/picture.h"
#include "transfer/source_field.h"
#include "transfer/style_map.h"

namespace scumble::internal {

struct FrameInput {
  const GuideSet& guides;
  const StyleMap* map = nullptr;  // null: one style paints all
  std::size_t styles = 1;
  Region region;  // of the picture that is made; within it
};

struct FrameSetup {
  std::vector<Region> extents;             // the rectangle around each style's covered pixels
  std::vector<std::vector<Region>> tiles;  // by style, with a map only: small rectangles that hold all its pixels
  bool softly_covered = false;             // some painted pixel has coverage between 0 and 1
};

// The style mask: a plane of bytes by pixel, of all rows of the picture or of some.
struct ActiveRows {
  std::uint8_t* first;  // of row first_row
  int width;
  int first_row = 0;
  std::uint8_t* At(int x, int y) const { return first + std::size_t(y - first_row) * width + x; }
};

// One pass over coverage and map. The field and `active` become as large as the guides, `out` too, unless it is
// already.
// - `active`: without a map 1 where coverage is above 0; with one 0 everywhere, see Activate.
// - The field has kNoSource wherever no style paints and outside the region, and is undefined elsewhere.
// - `out` is 0 wherever in the region no style paints, and undefined where one does; outside the region it is left
//   alone if it had its size.
// Runs in the caller's arena.
FrameSetup StartFrame(const FrameInput& input, SourceField& field, std::vector<std::uint8_t>& active, Picture& out);

// Sets `active` to 1 on the covered pixels of a style in these tiles, or clears it.
void Activate(const FrameInput& input, int style, const std::vector<Region>& tiles, std::vector<std::uint8_t>& active);
void Deactivate(const FrameInput& input, const std::vector<Region>& tiles, std::vector<std::uint8_t>& active);

// StartFrame for some rows alone, on one thread, without a field: its rules for `out` hold for these rows, `out` has
// its size already, and `covered` is 1 where coverage is above 0. Adds to `rows`.
struct StartedRows {
  std::vector<Region> extents;  // by style, as many as the caller made room for; empty: not needed
  std::vector<std::pair<std::uint16_t, Region>> tiles;  // styles, without a map 0, and their regions in these rows
  bool soft = false;                                    // some painted pixel has coverage between 0 and 1
};
void StartRows(const FrameInput& input, int y0, int y1, const ActiveRows& covered, Picture& out, StartedRows& rows);

// With a map: sets `active` to 1 on the covered pixels of a style in a tile, or clears it.
void ActivateTile(const FrameInput& input, int style, const Region& tile, const ActiveRows& covered,
                  const ActiveRows& active);
void DeactivateTile(const Region& tile, const ActiveRows& active);

}  // namespace scumble::internal
