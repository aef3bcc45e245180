// StyleBlit (Sýkora et al. 2019), section 3.1, algorithm 1.
#include "transfer/match/match.h"

namespace scumble::internal {
namespace {

// Tries the anchor's source on every free pixel whose place lands inside the exemplar.
void GrowChunk(const MatchInput& input, int anchor_x, int anchor_y, const Candidate& candidate, SourceField& field) {
  const Source anchor = candidate.source;
  PixelGuide of_anchor;
  input.ReadGuide(input.guides.Index(anchor_x, anchor_y), of_anchor);
  const bool off = input.IsOff(of_anchor, anchor, candidate.exemplar);
  const int size = input.exemplar.size();
  const int x0 = std::max(input.region.x0, anchor_x - anchor.x);
  const int x1 = std::min(input.region.x1, anchor_x - anchor.x + size);
  const int y1 = std::min(input.region.y1, anchor_y - anchor.y + size);
  for (int y = anchor_y; y < y1; ++y) {  // rows above the anchor have no free pixel left
    for (int x = x0; x < x1; ++x) {
      const std::size_t i = field.Index(x, y);
      if (field.level[i] != SourceField::kNoSource || !input.Wants(i)) continue;
      const Source source{anchor.x + (x - anchor_x), anchor.y + (y - anchor_y)};
      if (!input.exemplar.Usable(source.x, source.y)) continue;
      PixelGuide guide;
      input.ReadGuide(i, guide);
      if (off) input.OffsetGuide(of_anchor, anchor, candidate.exemplar, guide);
      if (!input.Alike(guide, glm::vec3(0.0f), source, candidate.exemplar)) continue;
      field.Set(i, source.x, source.y, candidate.exemplar, input.levels - 1);
    }
  }
}

}  // namespace

// Chunks grow as far as they fit: they count as those of the coarsest grid.
bool MatchBruteForce(const MatchInput& input, SourceField& field, RowProgress& progress) {
  for (int y = input.region.y0; y < input.region.y1; ++y) {
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      const std::size_t i = field.Index(x, y);
      if (input.Wants(i)) field.level[i] = SourceField::kNoSource;  // free; earlier values of the field do not count
    }
  }
  for (int y = input.region.y0; y < input.region.y1; ++y) {
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      const std::size_t i = field.Index(x, y);
      if (field.level[i] != SourceField::kNoSource || !input.Wants(i)) continue;
      const Candidate own = OwnCandidate(input, i);
      field.Set(i, own.source.x, own.source.y, own.exemplar, input.levels - 1);
      GrowChunk(input, x, y, own, field);
    }
    progress.Finished(1);
    if (progress.cancelled()) return false;
  }
  return true;
}

}  // namespace scumble::internal
