// The ends of runs of one chunk, many pixels at a time.
#pragma once

#include <cstdint>

namespace scumble::internal {

// One row of a source field; all arrays have `count` values.
struct FieldRow {
  const std::int16_t* x;
  const std::int16_t* y;
  const std::uint8_t* exemplar;
  const std::int8_t* level;
  const std::uint8_t* active;
  std::int8_t full_level;  // levels from this one on vote over the whole radius and are one
  int count;
};

// Bits by column, (count + 63) / 64 + 1 words of each, which must be 0 before. `votes`: active pixels. `changes`:
// pixels of another chunk than the one before them, where either is active; the first, if active.
void MarkRuns(const FieldRow& row, std::uint64_t* votes, std::uint64_t* changes);

}  // namespace scumble::internal
