#include "transfer/rim/rim_segments.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/image/hash.h"

namespace scumble::internal {
namespace {

constexpr int kCoarsest = 6, kFinest = 3;  // levels at the reference height
constexpr float kLeastAlike = 0.955336f;   // cos of 0.3 rad
constexpr float kMostTurn = 0.5f;          // radians
// As a share of the rim's own turn over half a cell: from there on a seed's direction is the outline's.
constexpr float kTurnOfNoFreedom = 0.75f;

int OffsetLevel(int level, int level_offset) { return std::clamp(level - level_offset, 0, 14); }

// Rotates by 2 atan(half_tangent), with operations that are exact on every machine.
glm::vec2 Turned(glm::vec2 v, float half_tangent) {
  const float square = half_tangent * half_tangent;
  const float cosine = (1.0f - square) / (1.0f + square), sine = 2.0f * half_tangent / (1.0f + square);
  return {cosine * v.x - sine * v.y, sine * v.x + cosine * v.y};
}

// The seeds of one level, sorted by (row, column, object).
class OutlineSeeds {
 public:
  OutlineSeeds(const RimSegmentInput& input, int level, const std::vector<std::size_t>& styles)
      : input_(input), styles_(styles), level_(level) {
    const auto outline = input.silhouettes.outline();
    for (std::size_t k = 0; k < outline.size(); ++k) {
      const int h = LevelAt(k);
      seeds_.push_back({outline[k].y >> h, outline[k].x >> h, input.silhouettes.ObjectOf(outline[k]),
                        static_cast<std::int32_t>(k), DistanceToCellSeed(k, h)});
    }
    std::sort(seeds_.begin(), seeds_.end(), [](const Seed& a, const Seed& b) {
      return std::tie(a.row, a.column, a.object, a.distance, a.outline) <
             std::tie(b.row, b.column, b.object, b.distance, b.outline);
    });
    const auto same = [](const Seed& a, const Seed& b) {
      return a.row == b.row && a.column == b.column && a.object == b.object;
    };
    seeds_.erase(std::unique(seeds_.begin(), seeds_.end(), same), seeds_.end());
    tbb::parallel_for(std::size_t(0), seeds_.size(),
                      [&](std::size_t s) { seeds_[s].segment = SegmentOf(seeds_[s].outline); });
  }

  // The segment of the seed nearest to outline pixel k, among those of its object in the 3 × 3 cells around; null:
  // none.
  const RimSegment* Nearest(std::size_t k) const {
    const OutlinePixel& own = input_.silhouettes.outline()[k];
    const int h = LevelAt(k), row = own.y >> h, column = own.x >> h;
    const std::uint32_t object = input_.silhouettes.ObjectOf(own);
    const RimSegment* best = nullptr;
    std::int64_t least = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const RimSegment* segment = Find(row + dy, column + dx, object);
        if (!segment) continue;
        const OutlinePixel& at = input_.silhouettes.outline()[std::size_t(segment->seed)];
        const std::int64_t ex = at.x - own.x, ey = at.y - own.y, distance = ex * ex + ey * ey;
        if (!best || distance < least) best = segment, least = distance;
      }
    }
    return best;
  }

 private:
  struct Seed {
    int row, column;
    std::uint32_t object;
    std::int32_t outline;
    std::int64_t distance;  // squared, to the cell's own seed
    RimSegment segment = {};
  };

  int LevelAt(std::size_t k) const { return OffsetLevel(level_, input_.seeds[styles_[k]].level_offset); }

  std::int64_t DistanceToCellSeed(std::size_t k, int h) const {
    const OutlinePixel& at = input_.silhouettes.outline()[k];
    const PixelPosition seed = SeedOfCell(input_.seeds[styles_[k]], h, at.x >> h, at.y >> h);
    const std::int64_t ex = seed.x - at.x, ey = seed.y - at.y;
    return ex * ex + ey * ey;
  }

  RimSegment SegmentOf(std::int32_t seed) const {
    const OutlinePixel& at = input_.silhouettes.outline()[std::size_t(seed)];
    const std::size_t style = styles_[std::size_t(seed)];
    const SeedRules& rules = input_.seeds[style];
    const int h = LevelAt(std::size_t(seed));
    const std::uint64_t hash = Hash(rules.seed, rules.time_step, h + rules.level_offset, at.x >> h, at.y >> h,
                                    input_.silhouettes.ObjectOf(at), 0xed9e);
    const float turn = (2.0f * UnitFloat(hash) - 1.0f) * kMostTurn * TurnShareAt(std::size_t(seed), h);
    return {at.point, Turned(at.outward, 0.5f * turn), seed};
  }

  const RimSegment* Find(int row, int column, std::uint32_t object) const {
    const auto found =
        std::lower_bound(seeds_.begin(), seeds_.end(), std::tuple(row, column, object),
                         [](const Seed& a, const auto& b) { return std::tie(a.row, a.column, a.object) < b; });
    if (found == seeds_.end() || found->row != row || found->column != column || found->object != object)
      return nullptr;
    return &found->segment;
  }

  // 1 where the outline is straight over half a cell to either side, 0 where it turns as strongly as the rim.
  float TurnShareAt(std::size_t k, int h) const {
    const auto outline = input_.silhouettes.outline();
    const OutlinePixel& own = outline[k];
    const std::uint32_t object = input_.silhouettes.ObjectOf(own);
    const int reach = (1 << h) / 2;
    float most = 0.0f;  // |sine| of the largest turn
    input_.silhouettes.ForNear(own.x, own.y, reach, [&](std::size_t other) {
      if (input_.silhouettes.ObjectOf(outline[other]) != object) return;
      const glm::vec2 a = own.outward, b = outline[other].outward;
      if (glm::dot(a, b) > 0.0f) most = std::max(most, std::fabs(a.x * b.y - a.y * b.x));
    });
    const float rims_own = static_cast<float>(reach) / input_.radii[styles_[k]];
    return std::clamp(1.0f - most / (kTurnOfNoFreedom * rims_own), 0.0f, 1.0f);
  }

  const RimSegmentInput& input_;
  const std::vector<std::size_t>& styles_;
  int level_;
  std::vector<Seed> seeds_;
};

}  // namespace

int RimSegmentMargin(int level_offset, int band) { return (3 << OffsetLevel(kCoarsest, level_offset)) + 2 * band + 8; }

std::vector<RimSegments> ChooseRimSegments(const RimSegmentInput& input) {
  const Silhouettes& silhouettes = input.silhouettes;
  const auto outline = silhouettes.outline();
  std::vector<std::size_t> styles(outline.size());
  for (std::size_t k = 0; k < outline.size(); ++k) styles[k] = silhouettes.StyleOf(outline[k]);
  std::vector<OutlineSeeds> levels;
  for (int level = kCoarsest; level >= kFinest; --level) levels.emplace_back(input, level, styles);

  const auto blend_width = [&](std::size_t k) { return std::max(1, silhouettes.BandOf(outline[k]) / 4); };
  int widest = 0;
  for (std::size_t k = 0; k < outline.size(); ++k) widest = std::max(widest, blend_width(k));
  const Region& region = input.region;
  const auto within = [&](const OutlinePixel& pixel, int grown) {
    return pixel.x >= region.x0 - grown && pixel.y >= region.y0 - grown && pixel.x < region.x1 + grown &&
           pixel.y < region.y1 + grown;
  };
  // Each outline pixel's own segment …
  std::vector<RimSegment> own(outline.size());
  tbb::parallel_for(std::size_t(0), outline.size(), [&](std::size_t k) {
    const OutlinePixel& pixel = outline[k];
    if (!within(pixel, widest)) return;
    own[k] = {pixel.point, pixel.outward, static_cast<std::int32_t>(k)};
    for (const OutlineSeeds& seeds : levels) {
      const RimSegment* segment = seeds.Nearest(k);
      if (!segment) continue;
      const OutlinePixel& at = outline[std::size_t(segment->seed)];
      const RimSegment straight{at.point, at.outward, segment->seed};
      if (glm::dot(straight.DirectionAt(pixel.point, input.radii[styles[k]]), pixel.outward) < kLeastAlike) continue;
      own[k] = *segment;
      return;
    }
  });
  // … and those of the pixels beside it, weighted by their number.
  std::vector<RimSegments> chosen(outline.size());
  tbb::parallel_for(std::size_t(0), outline.size(), [&](std::size_t k) {
    const OutlinePixel& pixel = outline[k];
    if (!within(pixel, 0)) return;
    const std::uint32_t object = silhouettes.ObjectOf(pixel);
    std::vector<std::pair<RimSegment, float>> votes;
    silhouettes.ForNear(pixel.x, pixel.y, blend_width(k), [&](std::size_t other) {
      if (silhouettes.ObjectOf(outline[other]) != object || glm::dot(outline[other].outward, pixel.outward) < 0.5f)
        return;
      for (auto& [segment, count] : votes) {
        if (segment.seed == own[other].seed && segment.outward == own[other].outward) return void(count += 1.0f);
      }
      votes.emplace_back(own[other], 1.0f);
    });
    std::stable_sort(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    RimSegments& segments = chosen[k];
    const std::size_t kept = std::min(votes.size(), segments.segment.size());
    float sum = 0.0f;
    for (std::size_t n = 0; n < kept; ++n) sum += votes[n].second;
    for (std::size_t n = 0; n < kept; ++n)
      segments.segment[n] = votes[n].first, segments.weight[n] = votes[n].second / sum;
  });
  return chosen;
}

}  // namespace scumble::internal
