// What styleblit_tiles.cpp hands from its plain half to the half that is compiled once for each set of vector
// instructions.
#pragma once

#include <vector>

#include "transfer/match/match.h"
#include "transfer/match/seed_tiles.h"

namespace scumble::internal {

// Seeds of one column of tiles, for one thread. A pass over other rows than those that follow begins them anew.
struct TileScratch {
  std::vector<TileSeeds> levels;  // from coarse to fine
  bool begun = false;
};

// A piece of the picture, as wide as a tile.
struct TileJob {
  const MatchInput& input;
  ExemplarRows exemplar;
  int tile_x;                            // pixels from tile_x · kTileWidth on
  int x0, x1;                            // columns of the tile that are looked at
  int y0, y1;                            // rows, none above those that `scratch` was used for
  std::span<const std::uint8_t> wanted;  // by the field's index, 1: pixels to be matched
  TileScratch& scratch;
  SourceField& field;
};

// Matches the pixels of the job that are wanted and in the input's region.
void MatchTile(const TileJob& job);

// What a pixel of the tile takes where its nearest seed s offers paint that it accepts and stands on a flat surface:
// near the border of two such seeds, that of the other if it suits better. `taken` comes with what s offers.
struct FreeChoice {
  PixelPosition p;
  PixelGuide guide;
};
void ChooseAtBorder(const MatchInput& input, TileSeeds& seeds, const FreeChoice& choice, Candidate& taken);

}  // namespace scumble::internal
