// Paints a frame by bands of rows: setup, match and votes of the rows follow each other so closely that sources never
// leave the caches.
//
// If a whole frame is matched before it is voted on, its field of sources goes through memory twice, and so do coverage
// and the style mask. That takes as long as all the work. After the votes, only the explanation of a picture needs the
// field. Here each thread goes down its rows in steps, keeps the field of the current rows, and drops them when no vote
// needs them any more. It matches the rows just above and below its part once more. A pixel's match depends on guides
// and seeds alone, so the bytes are equal.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/filter/edge_test.h"
#include "core/filter/parallel.h"
#include "scumble/picture.h"
#include "transfer/frame/fragment_paint.h"
#include "transfer/frame/frame_setup.h"
#include "transfer/match/match.h"
#include "transfer/match/styleblit_simd.h"
#include "transfer/tint/colorize.h"
#include "transfer/vote/small_vote.h"
#include "transfer/vote/tone_texture_split.h"
#include "transfer/vote/wide/wide_vote.h"

namespace scumble::internal {

// Every thread keeps seeds for every style: this number of bytes for each kTileWidth columns of the picture.
inline constexpr std::size_t kBandSeedBytes = 100'000;
inline constexpr std::size_t kMostBandStyles = 16;

// Larger windows need so many rows above and below a band that a field of the whole picture costs less.
inline constexpr int kMostBandRadius = 3;

// A style's settings for StyleBlit and the votes.
struct BandStyle {
  MatchInput match;  // with `covered` instead of `active`, and the frame's region grown by the pixels around that
                     // count; without a GuideSpace
  int radius = 0;    // at most kMostBandRadius
  std::optional<EdgeRules> edges;  // without `covered`; none: plain voting
  Tint tint;
  const PreparedExemplar* base = nullptr;  // base layers of the hybrid; null: none
};

// Shares of the total time of all threads.
struct BandShares {
  double start = 0.0, match = 0.0, vote = 0.0;
};

struct BandResult {
  bool finished = false;        // false: the progress callback cancelled
  bool softly_covered = false;  // as in FrameSetup
  BandShares shares;
};

// One thread's working memory; kept from frame to frame.
struct BandMemory {
  SourceField field;                  // of the current rows
  std::vector<std::uint8_t> covered;  // by the field's index: coverage is above 0
  std::vector<std::uint8_t> active;   // with a map: 1 where the current style paints, else 0
  StartedRows rows;
  std::vector<std::vector<Region>> regions;  // by style, the regions of the current rows with pixels of it
  std::vector<std::uint8_t> words;           // 64 columns each: whether the current style occurs there
  std::vector<TileScratch> seeds;            // by style and column of tiles
  WideScratch votes;
};

// StartFrame, MatchStyleBlit, Vote or VoteHybrid, and ColorizeRow for all styles, with the same bytes in the frame's
// region of `out`; and FragmentPaint::Paint for all fragments. The styles are those that the frame's map names, by
// index; `memory` is by thread, resized as needed; `base_votes` is resized where a style is a hybrid. Runs in the
// caller's arena.
BandResult PaintByBands(const FrameInput& frame, std::span<const BandStyle> styles, FragmentPaint& fragments,
                        std::vector<BandMemory>& memory, Picture& base_votes, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
