// Chunk masks: which neighbours are of one chunk, 64 pixels at a time.
#pragma once

#include <cstdint>
#include <span>

#include "transfer/prepared_exemplar.h"
#include "transfer/source_field.h"
#include "transfer/vote/bit_mask_rows.h"

namespace scumble::internal {

// Two active neighbours are of one chunk if they take paint from one exemplar picture and the step between their
// sources is the step between them. Beyond the picture no pixel is active but all are linked: only pixels inside decide
// whether a window lies in one chunk.
struct ChunkMasks {
  BitMaskRows active;
  BitMaskRows right;     // with the pixel to the right, both active
  BitMaskRows below;     // with the pixel below, both active
  BitMaskRows interior;  // active, and every texel within `radius` (in x and y) of its source is usable; never
                         // set in scenes
};

// Resets `marks` to the tile and fills it with the active pixels. O(pixels of the tile).
void MaskActive(const SourceField& field, std::span<const std::uint8_t> active, const MaskedTile& tile,
                BitMaskRows& marks);

// Fills the chunk masks of a tile. False: no pixel is active there, and no masks are made. O(pixels of the tile). Reads
// the field only where pixels are active.
bool MarkChunks(const SourceField& field, std::span<const std::uint8_t> active, const PreparedExemplar& exemplar,
                int radius, const MaskedTile& tile, ChunkMasks& marks);

}  // namespace scumble::internal
