// From sources to colours: neighbouring chunks vote (Sýkora et al. 2019, section 3.3).
#pragma once

#include <cstdint>
#include <span>

#include "image/guides.h"
#include "image/picture.h"
#include "transfer/edges.h"
#include "transfer/parallel.h"
#include "transfer/prepared_exemplar.h"
#include "transfer/source_field.h"

namespace scumble::internal {

struct VoteInput {
  const SourceField& field;
  std::span<const std::uint8_t> active;  // 1: a pixel that this style paints; others neither vote nor are painted
  const PreparedExemplar& exemplar;
  int radius = 0;
  const EdgeTest* edges = nullptr;  // null: plain voting
  Region region;
};

// Every active pixel p of the region becomes the mean of what the chunks around it would put there: for each pixel q
// of the (2·radius + 1)² window the texel S(q) + (p - q), where it is usable and, with `edges`, where q shows the same
// surface. Inside a chunk all votes agree and it is a plain copy. Sums are integers, weighted by the texels' alpha.
// Writes straight alpha into `out` (the picture's size); other pixels are left alone. False: asked to stop.
bool Vote(const VoteInput& input, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
