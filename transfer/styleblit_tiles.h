// What styleblit_tiles.cpp hands from its plain half to the half that is compiled once for each set of vector instructions.
#pragma once

#include <vector>

#include "transfer/match.h"
#include "transfer/tile_seeds.h"

namespace scumble::internal {

// Memory of one thread, kept from tile to tile.
struct TileScratch {
  std::vector<TileSeeds> levels;  // from coarse to fine
};

struct TileJob {
  const MatchInput& input;
  ExemplarRows exemplar;
  int tile_x, tile_y;  // which tile: its corner stands at (tile_x · kTileWidth, tile_y · kTileHeight)
  TileScratch& scratch;
  SourceField& field;
};

// What a pixel of the tile takes where its nearest seed s offers paint that it accepts and stands on a flat surface: near
// the border of two such seeds, that of the other if it suits better. `taken` comes with what s offers.
struct FreeChoice {
  PixelPosition p;
  PixelGuide guide;
};
void ChooseAtBorder(const MatchInput& input, TileSeeds& seeds, const FreeChoice& choice, Offer& taken);

}  // namespace scumble::internal
