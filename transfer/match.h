// Three ways to fill a SourceField. All run inside the caller's oneTBB arena, write only pixels of `region`, and leave
// uncovered ones at kNoSource. False: the progress callback asked to stop.
#pragma once

#include "image/guides.h"
#include "transfer/guide_distance.h"
#include "transfer/parallel.h"
#include "transfer/prepared_exemplar.h"
#include "transfer/seeds.h"
#include "transfer/source_field.h"

namespace scumble::internal {

// What a match looks at. `field` has the picture's size already.
struct MatchInput {
  const GuideSet& guides;
  const PreparedExemplar& exemplar;
  GuideTest test;
  SeedRules seeds;
  int levels = 1;  // effective, at the output's size
  Region region;
};

// Every pixel takes its own nearest neighbour.
bool MatchLitSphere(const MatchInput& input, SourceField& field, RowProgress& progress);

// Parallel StyleBlit: from coarse to fine, the nearest seed q offers its u*; pixel p takes u* + (p - q) where that is
// usable and its guide is like p's. A seed outside the picture or on background fails its level. If no level accepts,
// p takes its own u*.
bool MatchStyleBlit(const MatchInput& input, SourceField& field, RowProgress& progress);

// Sýkora's algorithm 1: the first free pixel in row order is the next anchor; its u* is offered to every free pixel of
// the picture by the same rule. One thread, O(chunks × pixels).
bool MatchBruteForce(const MatchInput& input, SourceField& field, RowProgress& progress);

}  // namespace scumble::internal
