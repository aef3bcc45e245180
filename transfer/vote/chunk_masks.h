// Which neighbours are of one chunk, 64 pixels at a time.
#pragma once

#include <cstdint>
#include <span>

#include "transfer/exemplar/prepared_exemplar.h"
#include "transfer/field/bit_mask_rows.h"
#include "transfer/field/source_field.h"

namespace scumble::internal {

// Two active pixels are of one chunk where they have one exemplar and sources that differ as they do. Beyond the
// picture nothing is active, and all links stand, so that a window which reaches out is judged by what is inside.
struct ChunkMasks {
  BitMaskRows active;
  BitMaskRows right;  // with the pixel to the right, both active
  BitMaskRows below;  // with the pixel below, both active
  BitMaskRows
      deep;  // active, and every texel within `radius` (in x and y) of its source is usable; in scenes none is told
};

// Resets `marks` to the tile and fills it with the active pixels. O(pixels of the tile).
void MaskActive(const SourceField& field, std::span<const std::uint8_t> active, const MaskedTile& tile,
                BitMaskRows& marks);

// Fills the marks of a tile. False: nothing is active there, and no marks are made. O(pixels of the
// tile). Touches the field only where pixels are active.
bool MarkChunks(const SourceField& field, std::span<const std::uint8_t> active, const PreparedExemplar& exemplar,
                int radius, const MaskedTile& tile, ChunkMasks& marks);

}  // namespace scumble::internal
