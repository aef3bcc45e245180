#include "measure/mosaic/patch_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "core/image/check.h"

namespace scumble::internal {
namespace {

constexpr double kColorWeight = 1.0 / (65535.0 * 65535.0);
// A sum of squares in float comes out too large by at most one rounding for each of them and each addition to it.
constexpr int kMostNumbers = 60;
constexpr float kSumSlack = 1.0f - (kMostNumbers + 4) * 0x1.0p-24f;
constexpr std::size_t kNormalGuides = 3;  // x, y and z, before all other guides

// Smooth patterns explain most of the difference between patches of paint: the polynomials of the degrees 0, 1 and 2
// that are orthonormal on the grid.
std::array<std::array<double, 2 * kPatchRadius + 1>, 3> Polynomials(int radius) {
  std::array<std::array<double, 2 * kPatchRadius + 1>, 3> out{};
  double mean = 0.0;
  for (int t = -radius; t <= radius; ++t) mean += double(t) * t / (2 * radius + 1);
  for (int degree = 0; degree < 3; ++degree) {
    double length = 0.0;
    for (int t = -radius; t <= radius; ++t) {
      const double value = degree == 0 ? 1.0 : degree == 1 ? t : t * t - mean;
      out[std::size_t(degree)][std::size_t(t + radius)] = value;
      length += value * value;
    }
    for (double& value : out[std::size_t(degree)]) value = length > 0.0 ? value / std::sqrt(length) : 0.0;
  }
  return out;
}

// The part of a squared distance whose root exceeds `free`.
double BeyondFree(double squared, double free) {
  const double beyond = std::max(0.0, std::sqrt(squared) - free);
  return beyond * beyond;
}

}  // namespace

PatchPlanes::PatchPlanes(int w, int h, std::size_t plane_count) : width(w), height(h) {
  const std::size_t count = std::size_t(w + 2 * kPatchRadius) * std::size_t(h + 2 * kPatchRadius);
  planes.assign(plane_count, std::vector<float>(count, 0.0f));
  mask.assign(count, 0);
}

struct PatchSearch::Best {
  double energy = std::numeric_limits<double>::infinity();
  PatchMatch match;

  bool IsAfter(const Place& place) const {
    return std::tie(match.exemplar, match.y, match.x) > std::tie(place.exemplar, place.y, place.x);
  }
};

PatchSearch::PatchSearch(std::span<const PatchPlanes> exemplars, double guide_weight, double largest_guide)
    : exemplars_(exemplars), guide_weight_(guide_weight) {
  SCUMBLE_CHECK(!exemplars.empty() && exemplars[0].planes.size() >= std::size_t(kPatchColors));
  SCUMBLE_CHECK(guide_weight >= 0.0 && std::isfinite(guide_weight));
  guides_ = exemplars[0].planes.size() - kPatchColors;
  for (const PatchPlanes& exemplar : exemplars) {
    for (const float free : exemplar.free) most_free_ = std::max(most_free_, double(free));
  }
  SCUMBLE_CHECK(most_free_ == 0.0 || guides_ >= kNormalGuides);
  // An upper bound of rounding errors: see docs/numerics.md, "Derivations".
  const double scale = std::max(1.0, std::sqrt(guide_weight) * largest_guide);
  const double n = kPatchPlaces * kPatchColors;
  slack_ = static_cast<float>(scale * (8.0 * std::sqrt(n) * 0x1.0p-24 + 2.0 * 2.0 * n * 0x1.0p-26));
  for (int radius = 0; radius <= kPatchRadius; ++radius) {
    levels_.push_back(MakeLevel(radius));
    if (levels_.back().tiles > 0) radius_ = radius;
  }
}

PatchSearch::Level PatchSearch::MakeLevel(int radius) const {
  Level level;
  level.radius = radius;
  const auto polynomials = Polynomials(radius);
  for (std::size_t degree = 0; degree <= (radius > 0 ? 2u : 0u); ++degree) {
    for (std::size_t i = 0; i <= degree; ++i) level.patterns.push_back({polynomials[degree - i], polynomials[i]});
  }
  level.numbers = static_cast<int>(kPatchColors * level.patterns.size() + guides_ + 1);
  SCUMBLE_CHECK_LE(level.numbers, kMostNumbers);
  level.first.push_back(0);
  for (std::size_t e = 0; e < exemplars_.size(); ++e) {
    for (int y = 0; y < exemplars_[e].height; y += kTileSide) {
      for (int x = 0; x < exemplars_[e].width; x += kTileSide) AddTile(level, static_cast<int>(e), x, y);
    }
  }
  // Boxes, by number: a query reads one number of all tiles after the other.
  level.low.assign(level.tiles * std::size_t(level.numbers), std::numeric_limits<float>::infinity());
  level.high.assign(level.low.size(), -std::numeric_limits<float>::infinity());
  for (std::size_t tile = 0; tile < level.tiles; ++tile) {
    const std::size_t count = level.first[tile + 1] - level.first[tile];
    for (int k = 0; k < level.numbers; ++k) {
      const float* values = level.values.data() + (tile * std::size_t(level.numbers) + std::size_t(k)) * kTilePlaces;
      const auto [low, high] = std::minmax_element(values, values + count);
      level.low[std::size_t(k) * level.tiles + tile] = *low, level.high[std::size_t(k) * level.tiles + tile] = *high;
    }
  }
  return level;
}

void PatchSearch::AddTile(Level& level, int exemplar, int tile_x, int tile_y) const {
  const PatchPlanes& planes = exemplars_[std::size_t(exemplar)];
  const int r = level.radius;
  const auto is_usable_around = [&](int x, int y) {
    for (int dy = -r; dy <= r; ++dy) {
      for (int dx = -r; dx <= r; ++dx) {
        if (!planes.mask[std::size_t(planes.Index(x + dx, y + dy))]) return false;
      }
    }
    return true;
  };
  const std::size_t before = level.places.size();
  for (int y = tile_y; y < std::min(planes.height, tile_y + kTileSide); ++y) {
    for (int x = tile_x; x < std::min(planes.width, tile_x + kTileSide); ++x) {
      if (is_usable_around(x, y)) level.places.push_back({exemplar, y, x});
    }
  }
  if (level.places.size() == before) return;
  level.first.push_back(level.places.size());
  const std::size_t numbers = std::size_t(level.numbers), start = level.tiles * numbers * kTilePlaces;
  ++level.tiles;
  level.values.resize(level.tiles * numbers * kTilePlaces, 0.0f);
  std::vector<float> of_place(numbers);
  for (std::size_t i = before; i < level.places.size(); ++i) {
    const std::ptrdiff_t middle = planes.Index(level.places[i][2], level.places[i][1]);
    const auto color = [&](std::size_t c, int dx, int dy) {
      return planes.planes[c][std::size_t(middle + dy * planes.stride() + dx)];
    };
    const auto guide = [&](std::size_t g) { return planes.planes[kPatchColors + g][std::size_t(middle)]; };
    Project(level, color, guide, of_place.data());
    for (std::size_t k = 0; k < numbers; ++k) level.values[start + k * kTilePlaces + (i - before)] = of_place[k];
  }
}

// color(c, dx, dy) is the patch and guide(g) its middle. The numbers are the colours' projections on all patterns, then
// the guides, and the length of the colours' remainder.
template <class Color, class Guide>
void PatchSearch::Project(const Level& level, const Color& color, const Guide& guide, float* numbers) const {
  const int r = level.radius;
  double left = 0.0;
  for (std::size_t c = 0; c < kPatchColors; ++c) {
    double patch[kPatchPlaces];
    int n = 0;
    for (int dy = -r; dy <= r; ++dy) {
      for (int dx = -r; dx <= r; ++dx) {
        patch[n] = color(c, dx, dy) / 65535.0;
        left += patch[n] * patch[n], ++n;
      }
    }
    for (const Pattern& pattern : level.patterns) {
      double sum = 0.0;
      n = 0;
      for (int dy = 0; dy <= 2 * r; ++dy) {
        for (int dx = 0; dx <= 2 * r; ++dx)
          sum += pattern.across[std::size_t(dx)] * pattern.down[std::size_t(dy)] * patch[n++];
      }
      *numbers++ = static_cast<float>(sum);
      left -= sum * sum;
    }
  }
  for (std::size_t g = 0; g < guides_; ++g) *numbers++ = static_cast<float>(std::sqrt(guide_weight_) * guide(g));
  *numbers++ = static_cast<float>(std::sqrt(std::max(0.0, left)));
}

PatchQuery PatchSearch::QueryAt(const PatchPlanes& target, int x, int y) const {
  SCUMBLE_DCHECK(target.planes.size() == kPatchColors + guides_);
  PatchQuery query;
  int first_gap = radius_ + 1;
  for (int dy = -radius_; dy <= radius_; ++dy) {
    for (int dx = -radius_; dx <= radius_; ++dx) {
      const std::size_t i = static_cast<std::size_t>(target.Index(x + dx, y + dy));
      if (!target.mask[i]) {
        first_gap = std::min(first_gap, std::max(std::abs(dx), std::abs(dy)));
        continue;
      }
      query.offsets.push_back({dx, dy});
      for (std::size_t c = 0; c < kPatchColors; ++c) query.colors[c].push_back(target.planes[c][i]);
    }
  }
  query.core = first_gap - 1;
  SCUMBLE_CHECK(query.core >= 0);
  query.whole = double(kPatchPlaces) / static_cast<double>(query.offsets.size());
  const std::size_t middle = static_cast<std::size_t>(target.Index(x, y));
  for (std::size_t g = 0; g < guides_; ++g) query.guides.push_back(target.planes[kPatchColors + g][middle]);
  if (!target.free.empty()) query.free = target.free[middle];
  SCUMBLE_DCHECK(query.free == 0.0 || guides_ >= kNormalGuides);
  return query;
}

bool PatchSearch::Fits(const PatchPlanes& exemplar, const PatchQuery& query, int x, int y) const {
  if (x < 0 || y < 0 || x >= exemplar.width || y >= exemplar.height) return false;
  for (const auto& offset : query.offsets) {
    if (!exemplar.mask[std::size_t(exemplar.Index(x + offset.x, y + offset.y))]) return false;
  }
  return true;
}

// Sums only grow, in floating point too, so a partial sum above the best ends the loop. Colours are whole numbers below
// 2^39 together: exact in any order.
void PatchSearch::Try(const PatchQuery& query, const Place& place, Best& best) const {
  const PatchPlanes& exemplar = exemplars_[std::size_t(place.exemplar)];
  const std::ptrdiff_t middle = exemplar.Index(place.x, place.y), stride = exemplar.stride();
  const double free =
      exemplar.free.empty() ? query.free : std::max(query.free, double(exemplar.free[std::size_t(middle)]));
  double guide = 0.0, color = 0.0;
  for (std::size_t g = 0; g < guides_; ++g) {
    const double d = double(query.guides[g]) - exemplar.planes[kPatchColors + g][std::size_t(middle)];
    guide += d * d;
    if (free > 0.0 && g + 1 == kNormalGuides) guide = BeyondFree(guide, free);
  }
  double energy = guide_weight_ * guide;
  for (std::size_t c = 0; c < kPatchColors; ++c) {
    if (energy > best.energy) return;
    const float* values = exemplar.planes[c].data() + middle;
    const float* wanted = query.colors[c].data();
    for (std::size_t i = 0; i < query.offsets.size(); ++i) {
      const double d = double(wanted[i]) - values[query.offsets[i].y * stride + query.offsets[i].x];
      color += d * d;
    }
    energy = color * kColorWeight * query.whole + guide_weight_ * guide;
  }
  if (energy > best.energy || (energy == best.energy && !best.IsAfter(place))) return;
  best.energy = energy;
  best.match = {place.exemplar, place.x, place.y, color * kColorWeight * query.whole, guide};
}

// Adds to bounds[i] the squares of distance(number, i) over all numbers, each less the slack; normals first, because
// their free distance is subtracted from their length.
template <class Distance>
void PatchSearch::AddBounds(const Level& level, double free, std::span<float> bounds, const Distance& distance) const {
  const auto add = [&](std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      for (std::size_t i = 0; i < bounds.size(); ++i) {
        const float d = std::max(distance(k, i) - slack_, 0.0f);
        bounds[i] += d * d;
      }
    }
  };
  const std::size_t first_guide = kPatchColors * level.patterns.size();
  const std::size_t normals_end = first_guide + (free > 0.0 ? kNormalGuides : 0);
  add(first_guide, normals_end);
  if (free > 0.0) {
    // Rounded up, and by the slack once more: the root is too large by at most 10 · 2⁻²⁴ of the scale, the slack is
    // 144.
    const float off = static_cast<float>(std::sqrt(guide_weight_) * free) * (1.0f + 0x1.0p-22f) + slack_;
    for (float& bound : bounds) {
      const float beyond = std::max(0.0f, std::sqrt(bound) - off);
      bound = beyond * beyond;
    }
  }
  add(0, first_guide);
  add(normals_end, std::size_t(level.numbers));
}

void PatchSearch::SearchTile(const Level& level, std::size_t tile, const float* wanted, const PatchQuery& query,
                             Best& best) const {
  const std::size_t first = level.first[tile], count = level.first[tile + 1] - first;
  std::array<float, kTilePlaces> bounds{};
  const float* values = level.values.data() + tile * std::size_t(level.numbers) * kTilePlaces;
  AddBounds(level, std::max(query.free, most_free_), bounds,
            [&](std::size_t k, std::size_t i) { return std::fabs(wanted[k] - values[k * kTilePlaces + i]); });
  const bool is_whole = query.core == radius_;
  for (std::size_t i = 0; i < count; ++i) {
    if (bounds[i] * kSumSlack > best.energy) continue;
    const auto [exemplar, y, x] = level.places[first + i];
    if (!is_whole && !Fits(exemplars_[std::size_t(exemplar)], query, x, y)) continue;
    Try(query, {exemplar, x, y}, best);
  }
}

PatchMatch PatchSearch::Nearest(const PatchQuery& query, std::span<const Place> guesses) const {
  SCUMBLE_CHECK(radius_ >= 0);
  Best best;
  for (const Place& guess : guesses) {
    if (guess.exemplar < 0 || std::size_t(guess.exemplar) >= exemplars_.size()) continue;
    if (Fits(exemplars_[std::size_t(guess.exemplar)], query, guess.x, guess.y)) Try(query, guess, best);
  }
  const Level& level = levels_[std::size_t(query.core)];
  // The middle (2 · core + 1)² places of the query, which are all valid: their distance is a lower bound of the whole
  // one, which is scaled up where some places are invalid.
  std::vector<std::size_t> at(std::size_t(2 * kPatchRadius + 1) * (2 * kPatchRadius + 1));
  for (std::size_t i = 0; i < query.offsets.size(); ++i) {
    at[std::size_t((query.offsets[i].y + kPatchRadius) * (2 * kPatchRadius + 1) + query.offsets[i].x + kPatchRadius)] =
        i;
  }
  std::vector<float> wanted(std::size_t(level.numbers));
  const auto color = [&](std::size_t c, int dx, int dy) {
    return query.colors[c][at[std::size_t((dy + kPatchRadius) * (2 * kPatchRadius + 1) + dx + kPatchRadius)]];
  };
  Project(
      level, color, [&](std::size_t g) { return query.guides[g]; }, wanted.data());

  std::vector<float> bounds(level.tiles, 0.0f);
  AddBounds(level, std::max(query.free, most_free_), bounds, [&](std::size_t k, std::size_t tile) {
    const std::size_t box = k * level.tiles + tile;
    return std::max(level.low[box] - wanted[k], wanted[k] - level.high[box]);
  });
  std::vector<std::pair<float, std::uint32_t>> order;
  for (std::size_t tile = 0; tile < level.tiles; ++tile) {
    if (bounds[tile] * kSumSlack <= best.energy) order.push_back({bounds[tile], static_cast<std::uint32_t>(tile)});
  }
  std::sort(order.begin(), order.end());
  for (const auto& [bound, tile] : order) {
    if (bound * kSumSlack > best.energy) break;
    SearchTile(level, tile, wanted.data(), query, best);
  }
  SCUMBLE_CHECK(best.match.exemplar >= 0);
  return best.match;
}

}  // namespace scumble::internal
