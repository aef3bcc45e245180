#include "transfer/vote/small_vote.h"

#include <array>
#include <bit>

#include "transfer/vote/chunk_masks.h"
#include "transfer/vote/edge/open_steps.h"
#include "transfer/vote/vote_kernels.h"
#include "transfer/vote/vote_sum.h"

namespace scumble::internal {
namespace {

constexpr int kTileRows = 32;  // so that neighbouring tiles repeat little work
constexpr int kStripWords =
    16;  // words of a tile that are voted on together, so that their texels stay in the nearer caches
constexpr int kTileWords = 32;  // so that all masks of a tile stay in the caches

// One part of the picture: its chunk masks, then its open steps, then its votes row by row.
class VoteTile {
 public:
  VoteTile(const VoteInput& input, const TexelPlanes& texels, const Region& region)
      : input_(input),
        texels_(texels),
        region_(region),
        first_word_(region.x0 / 64),
        words_((region.x1 + 63) / 64 - first_word_) {
    const int r = input.radius;
    tile_ = {region.y0 - r, region.y1 - region.y0 + 2 * r, first_word_ - 1, words_ + 2};
  }

  void Run(Picture& out) {
    if (!MarkChunks(input_.field, input_.active, input_.exemplar, input_.radius, tile_, marks_) || !Split()) return;
    const bool edges = input_.edges && input_.radius > 0 && multi_chunk_any_;
    if (edges) MarkSteps();
    for (int word = first_word_; word < first_word_ + words_; word += kStripWords) {
      VoteStrip(word, std::min(kStripWords, first_word_ + words_ - word), edges, out);
    }
  }

 private:
  void VoteStrip(int first_word, int words, bool edges, Picture& out) {
    std::array<std::uint64_t, kStripWords> copied{}, linked{}, whole{}, parts{};
    joined_.assign(std::size_t(kNeighbourCount) * words, BitMaskRows::kAll);
    votes_.assign(joined_.size(), 0);
    const int radius = input_.radius, first = std::max(0, 64 * first_word - radius);
    const int end = std::min(input_.field.width, 64 * (first_word + words) + radius);
    SourceRows sources(radius, first, end);
    for (int y = region_.y0 - radius; y < region_.y0 + radius; ++y) sources.Add(input_.field, texels_, y);
    for (int y = region_.y0; y < region_.y1; ++y) {
      sources.Add(input_.field, texels_, y + radius);
      const VoteRow row{texels_, input_.field, y, out.At(0, y), first_word, words};
      std::uint64_t any_whole = 0, any_parts = 0, any_mixed = 0;
      for (int w = 0; w < words; ++w) {
        const int word = first_word + w;
        const std::uint64_t multi_chunk = multi_chunk_.At(y, word);
        copied[w] = marks_.active.At(y, word) & Inside(word) & ~multi_chunk;
        linked[w] = marks_.right.At(y, word);
        whole[w] = multi_chunk ? multi_chunk & WholeWindows(y, word) : 0;
        if (edges && multi_chunk) {
          Join(y, word, JoinedAt(w));
          for (const std::uint64_t bits : JoinedAt(w)) whole[w] &= bits;
        }
        parts[w] = multi_chunk & ~whole[w];
        if (parts[w]) parts[w] = KnownParts(y, word, parts[w], w);
        any_mixed |= multi_chunk, any_whole |= whole[w], any_parts |= parts[w];
      }
      CopyMarked(row, copied, linked);
      if (any_mixed) {
        for (int w = 0; w < words; ++w) {
          copied[w] = multi_chunk_.At(y, first_word + w) & ~whole[w] & ~parts[w];  // pixel by pixel
        }
        if (any_whole) MeanOfMarked(row, sources, whole);
        if (any_parts) MeanOfParts(row, sources, votes_, parts);
        for (int w = 0; w < words; ++w) {
          VoteOneByOne(y, first_word + w, JoinedAt(w), copied[w] | whole[w] | parts[w], out);
        }
      }
      if (input_.finished) {
        input_.finished(y, std::max(region_.x0, 64 * first_word), std::min(region_.x1, 64 * (first_word + words)));
      }
    }
  }

  std::uint64_t Inside(int word) const { return BitRange(region_.x0 - 64 * word, region_.x1 - 64 * word); }
  std::span<std::uint64_t> JoinedAt(int w) {
    return {joined_.data() + std::size_t(w) * kNeighbourCount, std::size_t(kNeighbourCount)};
  }

  // Marks the pixels of the region whose windows have several chunks. False: no pixel is active.
  bool Split() {
    multi_chunk_.Reset(tile_.first_row, tile_.rows, tile_.first_word, tile_.words, 0);
    bool any = false;
    for (int y = region_.y0; y < region_.y1; ++y) {
      for (int w = first_word_; w < first_word_ + words_; ++w) {
        const std::uint64_t active = marks_.active.At(y, w) & Inside(w);
        if (!active) continue;
        any = true;
        const std::uint64_t multi_chunk = active & ~OneChunk(y, w);
        multi_chunk_.At(y, w) = multi_chunk;
        if (multi_chunk) multi_chunk_any_ = true;
      }
    }
    return any;
  }

  std::uint64_t OneChunk(int y, int word) const {
    const int r = input_.radius;
    std::uint64_t one = BitMaskRows::kAll;
    for (int v = y - r; v <= y + r; ++v) {
      for (int dx = -r; dx < r; ++dx) one &= marks_.right.Shifted(v, word, dx);
      if (v < y + r) one &= marks_.below.At(v, word);
    }
    return one;
  }

  // Whether all of the window is active, and all texels of its votes are usable.
  std::uint64_t WholeWindows(int y, int word) const {
    const int r = input_.radius;
    std::uint64_t whole = BitMaskRows::kAll;
    for (int v = y - r; v <= y + r; ++v) {
      for (int dx = -r; dx <= r; ++dx) whole &= marks_.interior.Shifted(v, word, dx);
    }
    return whole;
  }

  // The steps that support regions of radius 1 of multi-chunk pixels depend on: of the 3 × 3 pixels around them.
  void MarkSteps() {
    BitMaskRows wanted;
    wanted.Reset(tile_, 0);
    for (int y = region_.y0; y < region_.y1; ++y) {
      const std::uint64_t* row = multi_chunk_.Row(y);
      for (int w = 0; w < tile_.words; ++w) {
        const std::uint64_t bits = row[w] | row[w] >> 1 | row[w + 1] << 63;
        for (int v = y - 1; v <= y + 1; ++v) wanted.Row(v)[w] |= bits;
      }
    }
    MarkOpenSteps(*input_.edges, tile_, marks_.active, wanted, steps_);
  }

  // Bit i of joined[k]: whether kNeighbours[k] is in the support region of the pixel 64·word + i. At radius 1 an arm is
  // an open step.
  void Join(int y, int word, std::span<std::uint64_t> joined) const {
    for (int k = 0; k < kNeighbourCount; ++k) {
      const auto [dx, dy] = kNeighbours[k];
      const std::uint64_t column = dy == 0 ? BitMaskRows::kAll : steps_.down.At(dy < 0 ? y - 1 : y, word);
      const std::uint64_t row = dx == 0  ? BitMaskRows::kAll
                                : dx < 0 ? steps_.right.Shifted(y + dy, word, -1)
                                         : steps_.right.At(y + dy, word);
      joined[std::size_t(k)] = column & row;
    }
  }

  // The pixels whose votes are all known to be usable: every joined active neighbour has usable texels only. Records
  // the votes.
  std::uint64_t KnownParts(int y, int word, std::uint64_t pixels, int w) {
    const std::span<const std::uint64_t> joined = JoinedAt(w);
    std::uint64_t* votes = votes_.data() + std::size_t(w) * joined.size();
    pixels &= marks_.interior.At(y, word);
    for (std::size_t k = 0; k < joined.size(); ++k) {
      const PixelStep step = kNeighbours[k];
      const std::uint64_t interior = marks_.interior.Shifted(y + step.dy, word, step.dx);
      pixels &= ~(joined[k] & marks_.active.Shifted(y + step.dy, word, step.dx) & ~interior);
      votes[k] = joined[k] & interior;
    }
    return pixels;
  }

  void VoteOneByOne(int y, int word, std::span<const std::uint64_t> joined, std::uint64_t pixels, Picture& out) {
    const SourceField& field = input_.field;
    for (; pixels; pixels &= pixels - 1) {
      const int i = std::countr_zero(pixels), x = 64 * word + i;
      VoteSum sum;
      const auto add = [&](int u, int v) {
        const std::size_t q = field.Index(u, v);
        const Source at{field.x[q] - (u - x), field.y[q] - (v - y)};
        if (!input_.exemplar.Usable(at.x, at.y)) return;
        sum.Add(texels_.picture[field.exemplar[q]] + 4 * (std::size_t(at.y) * texels_.width + at.x));
      };
      add(x, y);
      for (std::size_t k = 0; k < joined.size(); ++k) {
        if (!(joined[k] >> i & 1)) continue;
        const int u = x + kNeighbours[k].dx, v = y + kNeighbours[k].dy;
        if (u < 0 || v < 0 || u >= field.width || v >= field.height || !input_.active[field.Index(u, v)]) continue;
        add(u, v);
      }
      sum.Count(out.At(x, y));
    }
  }

  const VoteInput& input_;
  const TexelPlanes& texels_;
  Region region_;
  int first_word_, words_;
  MaskedTile tile_;
  ChunkMasks marks_;
  BitMaskRows multi_chunk_;
  bool multi_chunk_any_ = false;
  OpenSteps steps_;
  std::vector<std::uint64_t> joined_, votes_;  // by word and neighbour
};

}  // namespace

void SmallVotes::Vote(const VoteInput& input, Picture& out) const {
  const Region& region = input.region;
  for (int x0 = region.x0, x1; x0 < region.x1; x0 = x1) {
    x1 = std::min(region.x1, 64 * (x0 / 64 + kTileWords));
    VoteTile(input, texels_, {x0, region.y0, x1, region.y1}).Run(out);
  }
}

bool VoteSmall(const VoteInput& input, Picture& out, RowProgress& progress) {
  const Region& region = input.region;
  if (region.empty()) return !progress.cancelled();
  const SmallVotes votes(input.exemplar);
  tbb::parallel_for(tbb::blocked_range<int>(0, (region.y1 - region.y0 + kTileRows - 1) / kTileRows),
                    [&](const auto& bands) {
                      for (int band = bands.begin(); band != bands.end(); ++band) {
                        if (progress.cancelled()) return;
                        VoteInput rows = input;
                        rows.region.y0 = region.y0 + band * kTileRows;
                        rows.region.y1 = std::min(region.y1, rows.region.y0 + kTileRows);
                        votes.Vote(rows, out);
                        progress.Finished(rows.region.y1 - rows.region.y0);
                      }
                    });
  return !progress.cancelled();
}

}  // namespace scumble::internal
