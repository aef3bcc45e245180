// The two ways in which most pixels get their colour: copies of whole runs, and means of whole windows.
#pragma once

#include <cstdint>
#include <span>

#include "transfer/prepared_exemplar.h"
#include "transfer/source_field.h"

namespace scumble::internal {

// The pictures of an exemplar, which are of one size.
struct TexelPlanes {
  static constexpr int kMax = 256;
  const std::uint16_t* picture[kMax];
  int count = 0, width = 0;

  explicit TexelPlanes(const PreparedExemplar& exemplar);
};

// Where a row's votes come from and go to.
struct VoteRow {
  const TexelPlanes& texels;
  const SourceField& field;
  int y = 0;
  std::uint16_t* out = nullptr;  // the row of the picture
  int first_word = 0, words = 0;
};

// Copies to each marked pixel its own texel, transparent ones without colour. Bit i of linked[w] tells that pixel
// 64·(first_word + w) + i and the one to its right are of one chunk.
void CopyMarked(const VoteRow& row, std::span<const std::uint64_t> marked, std::span<const std::uint64_t> linked);

// Every marked pixel becomes the mean of the votes of its whole window: the window is in the picture and active, and
// all texels that it votes for are usable. Only where all of these are opaque; the marks of other pixels are left,
// those of pixels that are done are cleared. `radius` is 1 … 3.
//
// With opaque paint the mean weighted by alpha is the plain one, rounded alike. Ballot has floor((aS + floor(an/2)) /
// (an)), a = 65535, for n votes of sum S. Without the inner floor that is floor((2S + n) / (2n)). Where an is odd, aS +
// an/2 lies half-way between two integers, so no multiple of an lies between it and the lower one, and both quotients
// have one floor.
void MeanOfMarked(const VoteRow& row, int radius, std::span<std::uint64_t> marked);

}  // namespace scumble::internal
