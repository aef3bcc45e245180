// A frame painted by bands of rows: what its rows hold, their match and their votes follow each other so closely that
// sources never leave the caches.
//
// Where a frame is matched as a whole before it is voted on, its field of sources goes through memory twice, and so do
// coverage and who is active; that takes as long as all the work. Nobody looks at the field afterwards but who explains
// a picture. Here each thread goes down its share of the rows in steps, keeps the field of the rows at hand, and
// forgets them when no vote can ask for them any more. What lies just above and below its share it matches once more:
// every pixel's match depends on guides and seeds alone, so the bytes are the same.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/filter/edge_test.h"
#include "core/filter/parallel.h"
#include "scumble/picture.h"
#include "transfer/frame/frame_setup.h"
#include "transfer/match/match.h"
#include "transfer/match/styleblit_simd.h"
#include "transfer/tint/colorize.h"
#include "transfer/vote/small_vote.h"
#include "transfer/vote/wide/wide_vote.h"

namespace scumble::internal {

// Every thread keeps seeds for every style, so many bytes for each kTileWidth columns of the picture.
inline constexpr std::size_t kBandSeedBytes = 100'000;
inline constexpr std::size_t kMostBandStyles = 16;

// Larger windows need so many rows above and below a band that a field of the whole picture costs less.
inline constexpr int kMostBandRadius = 3;

// How one style is matched by StyleBlit and voted on.
struct BandStyle {
  MatchInput
      match;  // with `covered` instead of `active`, and the frame's region grown by the radius; without a GuideSpace
  int radius = 0;                  // at most kMostBandRadius
  std::optional<EdgeRules> edges;  // without `covered`; none: plain voting
  Tint tint;
};

// Shares of the time that all threads together took.
struct BandShares {
  double start = 0.0, match = 0.0, vote = 0.0;
};

struct BandResult {
  bool finished = false;        // false: the progress callback asked to stop
  bool softly_covered = false;  // as FrameSetup has it
  BandShares shares;
};

// What one thread works in; kept from frame to frame.
struct BandMemory {
  SourceField field;                  // of the rows at hand
  std::vector<std::uint8_t> covered;  // by the field's index: coverage is above 0
  std::vector<std::uint8_t> active;   // with a map: where the style at work paints, else 0
  StartedRows rows;
  std::vector<std::vector<Region>> pieces;  // by style, where the rows at hand have pixels of it
  std::vector<std::uint8_t> words;          // 64 columns each: whether the style at work is there
  std::vector<TileScratch> seeds;           // by style and column of tiles
  WideScratch votes;
};

// StartFrame, MatchStyleBlit, Vote and ColorizeRow for all styles, with the same bytes in the frame's region of `out`.
// The styles are those that the frame's map names, by index; `memory` is by thread, as many as it takes. Runs in the
// caller's arena.
BandResult PaintByBands(const FrameInput& frame, std::span<const BandStyle> styles, std::vector<BandMemory>& memory,
                        Picture& out, RowProgress& progress);

}  // namespace scumble::internal
