// StyleBlit: Fast Example-Based Stylization with Local Guidance. Daniel Sýkora, Ondřej Jamriška, Ondřej Texler, Jakub
// Fišer, Michal Lukáč, Jingwan Lu, Eli Shechtman. Computer Graphics Forum 38 (2019). Section 3.2, the parallel form.
#include <optional>
#include <vector>

#include "transfer/match.h"

namespace scumble::internal {
namespace {

// The seeds of one level with what they offer; thousands of pixels share each.
struct Level {
  SeedGrid grid;
  std::vector<std::optional<Source>> offers;  // empty: outside the picture or on background

  Level(const MatchInput& input, int level)
      : grid(input.seeds, level, input.guides.width(), input.guides.height()), offers(grid.size()) {
    const auto coverage = input.guides.Plane(Layer::kCoverage);
    for (std::size_t s = 0; s < grid.size(); ++s) {
      const PixelPosition q = grid.Position(s);
      if (q.x < 0 || q.y < 0 || q.x >= input.guides.width() || q.y >= input.guides.height()) continue;
      const std::size_t i = input.guides.Index(q.x, q.y);
      if (coverage[i] > 0.0f) offers[s] = input.exemplar.NearestNeighbour(input.guides.Vec3(Layer::kNormal, i));
    }
  }
};

// What p may take from its nearest seed on this level, if anything.
std::optional<Source> Accept(const MatchInput& input, const Level& level, int x, int y, glm::vec3 guide) {
  const std::size_t s = level.grid.Nearest(x, y);
  if (!level.offers[s]) return std::nullopt;
  const PixelPosition q = level.grid.Position(s);
  const Source candidate{level.offers[s]->x + (x - q.x), level.offers[s]->y + (y - q.y)};
  if (!input.exemplar.Usable(candidate.x, candidate.y)) return std::nullopt;
  if (!input.test.Alike(guide, input.exemplar.Normal(candidate.x, candidate.y))) return std::nullopt;
  return candidate;
}

}  // namespace

bool MatchStyleBlit(const MatchInput& input, SourceField& field, RowProgress& progress) {
  // Level 0 has a seed on every pixel, so its offer is the pixel's own nearest neighbour, accepted or not.
  std::vector<Level> levels;
  for (int level = input.levels - 1; level >= 1; --level) levels.emplace_back(input, level);
  const auto coverage = input.guides.Plane(Layer::kCoverage);
  return ForEachRow(input.region, progress, [&](int y) {
    for (int x = input.region.x0; x < input.region.x1; ++x) {
      const std::size_t i = field.Index(x, y);
      if (!(coverage[i] > 0.0f)) continue;
      const glm::vec3 guide = input.guides.Vec3(Layer::kNormal, i);
      std::optional<Source> source;
      int settled = 0;
      for (const Level& level : levels) {
        if ((source = Accept(input, level, x, y, guide))) {
          settled = level.grid.level();
          break;
        }
      }
      if (!source) source = input.exemplar.NearestNeighbour(guide);
      field.x[i] = static_cast<std::int16_t>(source->x);
      field.y[i] = static_cast<std::int16_t>(source->y);
      field.level[i] = static_cast<std::int8_t>(settled);
    }
  });
}

}  // namespace scumble::internal
