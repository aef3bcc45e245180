// The interface between the plain half of styleblit_simd.cpp and the half that is compiled once for each set of vector
// instructions.
#pragma once

#include <vector>

#include "transfer/match/match.h"
#include "transfer/match/seed_tiles.h"

namespace scumble::internal {

// Seeds of one column of tiles, for one thread. A pass that does not continue below the last rows makes them anew.
struct TileScratch {
  std::vector<TileSeeds> levels;  // from coarse to fine
  bool begun = false;
};

// A part of the picture, as wide as a tile.
struct TileJob {
  const MatchInput& input;
  ExemplarRows exemplar;
  int tile_x;                            // pixels from tile_x · kTileWidth on
  int x0, x1;                            // processed columns of the tile
  int y0, y1;                            // rows, none above those that `scratch` was used for
  std::span<const std::uint8_t> wanted;  // by the field's index, 1: pixels to match
  TileScratch& scratch;
  SourceField& field;
};

// Matches the wanted pixels of the job in the input's region.
void MatchTile(const TileJob& job);

// The choice of a tile's pixel whose nearest seed s has an accepted candidate and is on a flat surface. Near the border
// of two such seeds, it is the other's candidate if that suits better. `taken` comes in with the candidate of s.
struct FreeChoice {
  PixelPosition p;
  PixelGuide guide;
};
void ChooseAtBorder(const MatchInput& input, TileSeeds& seeds, const FreeChoice& choice, Candidate& taken);

}  // namespace scumble::internal
