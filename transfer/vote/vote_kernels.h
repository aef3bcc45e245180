// How most pixels get their colour: copies of runs of a chunk, means of the nine votes of a whole window, and means of
// the votes of a part of one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "transfer/prepared_exemplar.h"
#include "transfer/source_field.h"

namespace scumble::internal {

// The pictures of an exemplar, which are of one size.
struct TexelPlanes {
  static constexpr int kMax = 256;
  const std::uint16_t* picture[kMax];
  int count = 0, width = 0, height = 0;

  explicit TexelPlanes(const PreparedExemplar& exemplar);
};

struct PixelStep {
  int dx = 0, dy = 0;
};

// The sources and the output of a row's votes.
struct VoteRow {
  const TexelPlanes& texels;
  const SourceField& field;
  int y = 0;
  std::uint16_t* out = nullptr;  // the row of the picture
  int first_word = 0, words = 0;
};

// The place of each pixel's source in its picture, y·width + x, for the rows of the current windows. Rows come in
// order; each replaces one that no window needs any more.
class SourceRows {
 public:
  // For windows of `radius`, and columns [begin, end) of the picture.
  SourceRows(int radius, int begin, int end)
      : radius_(radius), begin_(begin), end_(end), places_(std::size_t(2 * radius + 1) * (end - begin)) {}
  // A row outside the picture adds nothing.
  void Add(const SourceField& field, const TexelPlanes& texels, int y);
  int radius() const { return radius_; }
  // At column `begin`.
  const std::int32_t* Row(int y) const { return places_.data() + Offset(y); }
  int begin() const { return begin_; }

 private:
  std::size_t Offset(int y) const { return std::size_t((y + radius_) % (2 * radius_ + 1)) * (end_ - begin_); }
  int radius_, begin_, end_;
  std::vector<std::int32_t> places_;
};

// Copies its own texel to each marked pixel; transparent texels get no colour. Bit i of linked[w]: pixel 64·(first_word
// + w) + i and the one to its right are of one chunk.
void CopyMarked(const VoteRow& row, std::span<const std::uint64_t> marked, std::span<const std::uint64_t> linked);

// Every marked pixel becomes the mean of the nine votes of its whole window: the window is in the picture and active,
// and all texels that it votes for are usable. Only pixels whose texels are all opaque are done and their marks
// cleared; the marks of other pixels stay. `sources` has the rows of the windows, of radius 1. The plain mean of opaque
// texels equals VoteSum's (docs/numerics.md, "Derivations").
void MeanOfMarked(const VoteRow& row, const SourceRows& sources, std::span<std::uint64_t> marked);

// The pixels beside another, row by row.
inline constexpr PixelStep kNeighbours[] = {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}};
inline constexpr int kNeighbourCount = 8;

// MeanOfMarked for windows of which a part votes: the pixel itself, and kNeighbours[k] where its bit of votes[w ·
// kNeighbourCount + k] is set. Such pixels are in the picture, and the texels that they vote for are usable.
void MeanOfParts(const VoteRow& row, const SourceRows& sources, std::span<const std::uint64_t> votes,
                 std::span<std::uint64_t> marked);

}  // namespace scumble::internal
