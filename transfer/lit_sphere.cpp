#include "transfer/match.h"

namespace scumble::internal {

bool MatchLitSphere(const MatchInput& input, SourceField& field, RowProgress& progress) {
  const auto coverage = input.guides.Plane(Layer::kCoverage);
  return ForEachRow(input.region, progress, [&](int y) {
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      const std::size_t i = field.Index(x, y);
      if (!(coverage[i] > 0.0f)) continue;
      const Source own = input.exemplar.NearestNeighbour(input.guides.Vec3(Layer::kNormal, i));
      field.x[i] = static_cast<std::int16_t>(own.x);
      field.y[i] = static_cast<std::int16_t>(own.y);
      field.level[i] = 0;
    }
  });
}

}  // namespace scumble::internal
