#include "transfer/match/coarse_match.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

namespace scumble::internal {
namespace {

// The match of a block's pixel.
struct Matched {
  PixelPosition pixel;
  Source source;
  int exemplar = 0;
  int level = 0;
  glm::vec3 guide_offset{0.0f};
  bool off = false;  // MatchInput::IsOff

  bool SameChunk(const Matched& other) const {
    return source.x - pixel.x == other.source.x - other.pixel.x &&
           source.y - pixel.y == other.source.y - other.pixel.y && exemplar == other.exemplar && level == other.level &&
           guide_offset == other.guide_offset;
  }
};

int FloorDivide(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

// The block before the one whose centre a pixel has reached, along one axis.
int BlockBefore(int position, int step) { return FloorDivide(2 * position + 1 - step, 2 * step); }

// The field at the pixels of a grid: a copy, because the field is overwritten by upsampling.
class MatchedGrid {
 public:
  MatchedGrid(const MatchInput& input, const CoarseGrid& grid, const SourceField& field)
      : first_column_(BlockBefore(input.region.x0, grid.step())),
        first_row_(BlockBefore(input.region.y0, grid.step())) {
    columns_ = BlockBefore(input.region.x1 - 1, grid.step()) + 2 - first_column_;
    const int rows = BlockBefore(input.region.y1 - 1, grid.step()) + 2 - first_row_;
    matched_.resize(std::size_t(columns_) * rows);
    for (std::size_t b = 0; b < matched_.size(); ++b) {
      const PixelPosition* pixel = grid.Find(first_column_ + int(b % columns_), first_row_ + int(b / columns_));
      if (!pixel) continue;
      const std::size_t i = field.Index(pixel->x, pixel->y);
      matched_[b] = Matched{*pixel, {field.x[i], field.y[i]}, field.exemplar[i], field.level[i]};
      if (!field.guide_offset.empty()) matched_[b]->guide_offset = field.guide_offset[i];
      PixelGuide guide;
      input.ReadGuide(i, guide);
      guide.normal += matched_[b]->guide_offset;
      matched_[b]->off = input.IsOff(guide, matched_[b]->source, matched_[b]->exemplar);
    }
    in_one_piece_.resize(matched_.size());
    for (std::size_t b = 0; b + columns_ + 1 < matched_.size(); ++b) {
      const std::optional<Matched>& first = matched_[b];
      const auto agrees = [&](std::size_t other) { return matched_[other] && first->SameChunk(*matched_[other]); };
      in_one_piece_[b] = first && agrees(b + 1) && agrees(b + columns_) && agrees(b + columns_ + 1);
    }
  }
  // Whether a block, the one on its right and the two below them belong to one chunk.
  bool InOnePiece(int column, int row) const {
    return in_one_piece_[std::size_t(row - first_row_) * columns_ + (column - first_column_)] != 0;
  }
  const std::optional<Matched>& At(int column, int row) const {
    return matched_[std::size_t(row - first_row_) * columns_ + (column - first_column_)];
  }

 private:
  int first_column_, first_row_, columns_ = 0;
  std::vector<std::optional<Matched>> matched_;
  std::vector<std::uint8_t> in_one_piece_;
};

// The four blocks around a pixel, its own first.
std::array<PixelPosition, 4> BlocksAround(int x, int y, int column, int row, int step) {
  const PixelPosition own{x / step, y / step};
  std::array<PixelPosition, 4> blocks{own};
  int count = 1;
  for (int corner = 0; corner < 4; ++corner) {
    const PixelPosition block{column + (corner & 1), row + (corner >> 1)};
    if (block.x != own.x || block.y != own.y) blocks[std::size_t(count++)] = block;
  }
  return blocks;
}

// The candidate that p takes from a block, if its guide is like p's there.
std::optional<Candidate> Accept(const MatchInput& input, const Matched& matched, int x, int y,
                                const PixelGuide& guide) {
  const Source candidate{matched.source.x + (x - matched.pixel.x), matched.source.y + (y - matched.pixel.y)};
  if (!input.exemplar.Usable(candidate.x, candidate.y)) return std::nullopt;
  if (matched.off) {
    PixelGuide of_block, offset_guide = guide;
    input.ReadGuide(input.guides.Index(matched.pixel.x, matched.pixel.y), of_block);
    of_block.normal += matched.guide_offset;
    input.OffsetGuide(of_block, matched.source, matched.exemplar, offset_guide);
    if (!input.Alike(offset_guide, matched.guide_offset, candidate, matched.exemplar)) return std::nullopt;
    return Candidate{candidate, matched.exemplar, matched.guide_offset};
  }
  if (!input.Alike(guide, matched.guide_offset, candidate, matched.exemplar)) return std::nullopt;
  return Candidate{candidate, matched.exemplar, matched.guide_offset};
}

// The candidate that p takes from the blocks around it, and its level.
std::optional<Candidate> Best(const MatchInput& input, const MatchedGrid& matched,
                              const std::array<PixelPosition, 4>& blocks, int x, int y, const PixelGuide& guide,
                              int& level) {
  std::optional<Candidate> best;
  float least = 0.0f;
  for (const PixelPosition& block : blocks) {
    const std::optional<Matched>& there = matched.At(block.x, block.y);
    if (!there || (best && there->level < level)) continue;
    const auto candidate = Accept(input, *there, x, y, guide);
    if (!candidate) continue;
    const float error = input.Distance(guide, candidate->guide_offset, candidate->source, candidate->exemplar);
    if (best && there->level == level && !(error < least)) continue;
    best = candidate, level = there->level, least = error;
  }
  return best;
}

}  // namespace

CoarseGrid::CoarseGrid(std::span<const std::uint8_t> active, int width, int height, int step, const Region& region)
    : step_(step) {
  if (region.empty()) return;
  first_column_ = region.x0 / step, first_row_ = region.y0 / step;
  columns_ = (region.x1 - 1) / step + 1 - first_column_, rows_ = (region.y1 - 1) / step + 1 - first_row_;
  pixels_.assign(std::size_t(columns_) * rows_, {kNone, kNone});
  tbb::parallel_for(0, rows_, [&](int row) {
    for (int column = 0; column < columns_; ++column) {
      const int x0 = (first_column_ + column) * step, y0 = (first_row_ + row) * step;
      int nearest = std::numeric_limits<int>::max();
      for (int y = y0; y < std::min(y0 + step, height); ++y) {
        for (int x = x0; x < std::min(x0 + step, width); ++x) {
          if (!active[std::size_t(y) * width + x]) continue;
          const int dx = 2 * (x - x0) + 1 - step, dy = 2 * (y - y0) + 1 - step, distance = dx * dx + dy * dy;
          if (distance < nearest) nearest = distance, pixels_[std::size_t(row) * columns_ + column] = {x, y};
        }
      }
    }
  });
}

const PixelPosition* CoarseGrid::Find(int column, int row) const {
  column -= first_column_, row -= first_row_;
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return nullptr;
  const PixelPosition& pixel = pixels_[std::size_t(row) * columns_ + column];
  return pixel.x == kNone ? nullptr : &pixel;
}

void CoarseGrid::Mark(std::uint8_t value, int width, std::vector<std::uint8_t>& pixels) const {
  for (const PixelPosition& pixel : pixels_) {
    if (pixel.x != kNone) pixels[std::size_t(pixel.y) * width + pixel.x] = value;
  }
}

bool UpsampleField(const MatchInput& input, const CoarseGrid& grid, SourceField& field, RowProgress& progress) {
  if (input.region.empty()) return !progress.cancelled();
  const MatchedGrid matched(input, grid, field);
  const int step = grid.step();
  return ForEachRow(input.region, progress, [&](int y) {
    const int row = BlockBefore(y, step);
    int column = BlockBefore(input.region.x0, step);
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      if (2 * x + 1 - step >= 2 * step * (column + 1)) ++column;
      const std::size_t i = field.Index(x, y);
      if (!input.active[i]) continue;
      PixelGuide guide;
      input.ReadGuide(i, guide);
      std::optional<Candidate> best;
      int level = 0;
      if (matched.InOnePiece(column, row)) {
        const Matched& one = *matched.At(column, row);
        best = Accept(input, one, x, y, guide), level = one.level;
      } else {
        best = Best(input, matched, BlocksAround(x, y, column, row, step), x, y, guide, level);
      }
      if (!best) best = OwnCandidate(input, guide), level = 0;
      field.Set(i, best->source.x, best->source.y, best->exemplar, level);
    }
  });
}

}  // namespace scumble::internal
