// The coherence of a mosaic: the share that is copied in large chunks.
//
// A pixel's offset is its source position minus its own. Where neighbours share their offset the exemplar was copied
// without a seam, so brush strokes survive; a picture of single pixels has almost no such pairs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace scumble {

// Views of width × height values, rows from the top; they are not stored.
struct SourcePlanes {
  int width = 0;
  int height = 0;
  std::span<const std::int16_t> source_x;  // exemplar pixels
  std::span<const std::int16_t> source_y;
  std::span<const std::uint8_t> covered;   // 0 is background
  std::span<const std::uint8_t> exemplar;  // the exemplar of the source; empty where there is only one
};

struct CoherenceReport {
  std::size_t covered = 0;         // pixels
  std::size_t pairs = 0;           // right and lower neighbours that are both covered
  std::size_t coherent_pairs = 0;  // of these, those with equal offset and exemplar
  double share = 0.0;              // coherent_pairs / pairs; 0 without pairs
  std::size_t chunks = 0;          // 4-connected components of equal offset and exemplar
  std::size_t largest_chunk = 0;   // pixels
  double mean_chunk_area = 0.0;    // covered / chunks, pixels; 0 without chunks
};

// Every span must hold width × height values (`exemplar` may be empty). Deterministic, O(pixels).
CoherenceReport MeasureCoherence(const SourcePlanes& planes);

}  // namespace scumble
