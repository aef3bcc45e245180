// The Lit Sphere (Sloan, Martin, Gooch, Gooch, "The Lit Sphere: A Model for Capturing NPR Shading from Art", Graphics
// Interface 2001), with the light of the illuminated extension.
#include "transfer/match/match.h"

namespace scumble::internal {

Candidate OwnCandidate(const MatchInput& input, const PixelGuide& guide) {
  const int chosen = input.illumination.Choose(guide.light);
  return {input.NearestTo(guide, chosen), chosen};
}

Candidate OwnCandidate(const MatchInput& input, std::size_t pixel) {
  PixelGuide guide;
  input.ReadGuide(pixel, guide);
  return OwnCandidate(input, guide);
}

bool MatchLitSphere(const MatchInput& input, SourceField& field, RowProgress& progress) {
  return ForEachRow(input.region, progress, [&](int y) {
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      const std::size_t i = field.Index(x, y);
      if (!input.Wants(i)) continue;
      const Candidate own = OwnCandidate(input, i);
      field.Set(i, own.source.x, own.source.y, own.exemplar, 0);
    }
  });
}

}  // namespace scumble::internal
