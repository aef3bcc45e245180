// StyleBlit (Sýkora et al. 2019, section 3.2) with seeds on surfaces instead of the screen; surface_seeds.h defines
// their places. Two things differ from styleblit.cpp:
//
//   - A pixel belongs to one surface cell of each level by its place on the surface. The cell's seed is the pixel
//     nearest to the cell's point, whatever the order of the threads.
//   - If an object turns, the nearest neighbour of a seed moves over the exemplar, and the paint would slide over the
//     surface. So the seed's normal is rounded to a grid, and the paint is static until the seed has turned by one grid
//     cell; then this one chunk changes. A hash shifts the grid of each surface cell, so that they do not all change at
//     once. Acceptance is the usual one, so no pixel is less like its paint than in StyleBlit.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <memory>
#include <optional>

#include "core/image/hash.h"
#include "transfer/match/seed_candidate.h"
#include "transfer/seeds/surface_seeds.h"

namespace scumble::internal {
namespace {

// The grid cell's side as a share of the threshold. Without rounding, a figure that turns flickers nearly as much as
// with seeds that are frozen to the screen (bench/flicker_bench.cpp); with 1, small highlights get lost.
constexpr float kSteadiness = 0.5f;
constexpr float kLargestCell = 0.25f;

// A normal rounded to the middle of a grid cell of side `cell`, on the equal-area map of the hemisphere (Lambert's
// azimuthal one), whose grid a hash shifts.
glm::vec3 Steady(const glm::vec3& normal, float cell, std::uint64_t key) {
  if (!(cell > 0.0f)) return normal;
  glm::vec3 facing = normal;
  if (normal.z < 0.0f) {  // its nearest neighbour lies on the rim
    const float flat = std::sqrt(normal.x * normal.x + normal.y * normal.y);
    if (!(flat > 0.0f)) return normal;
    facing = {normal.x / flat, normal.y / flat, 0.0f};
  }
  const float to_map = std::sqrt(2.0f / (1.0f + facing.z));
  const auto round = [&](float value, int purpose) {
    const float shift = CellChance(key, purpose);
    return (std::floor(value / cell + shift) - shift + 0.5f) * cell;
  };
  float x = round(facing.x * to_map, 1), y = round(facing.y * to_map, 2);
  float squared = x * x + y * y;
  if (squared > 2.0f) {
    const float back = std::sqrt(2.0f / squared);
    x *= back, y *= back, squared = 2.0f;
  }
  const float from_map = std::sqrt(1.0f - squared / 4.0f);
  return {x * from_map, y * from_map, 1.0f - squared / 2.0f};
}

// The seeds of the surface cells of one exponent: from a cell's key to the pixel nearest to its point. Any thread may
// add; the result does not depend on the order.
class SeedTable {
 public:
  // For at most `cells` different keys.
  explicit SeedTable(std::size_t cells)
      : mask_(std::bit_ceil(2 * cells + 2) - 1), slots_(std::make_unique<Slot[]>(mask_ + 1)) {}

  void Add(std::uint64_t key, float squared, std::uint32_t pixel) {
    std::atomic<std::uint64_t>& nearest = slots_[SlotOf(key)].nearest;
    // The bits of distances that are not negative have the order of the values; among equal distances the lower pixel
    // wins.
    const std::uint64_t mine = std::uint64_t(std::bit_cast<std::uint32_t>(squared)) << 32 | pixel;
    std::uint64_t other = nearest.load(std::memory_order_relaxed);
    while (mine < other && !nearest.compare_exchange_weak(other, mine, std::memory_order_relaxed)) {
    }
  }
  // A key that was added.
  std::uint32_t Pixel(std::uint64_t key) {
    return static_cast<std::uint32_t>(slots_[SlotOf(key)].nearest.load(std::memory_order_relaxed));
  }

 private:
  struct Slot {
    std::atomic<std::uint64_t> key{0};
    std::atomic<std::uint64_t> nearest{~std::uint64_t{0}};
  };

  std::size_t SlotOf(std::uint64_t key) {
    for (std::size_t s = key & mask_;; s = (s + 1) & mask_) {
      std::uint64_t held = slots_[s].key.load(std::memory_order_relaxed);
      if (held == 0 && slots_[s].key.compare_exchange_strong(held, key, std::memory_order_relaxed)) return s;
      if (held == key) return s;
    }
  }

  std::size_t mask_;
  std::unique_ptr<Slot[]> slots_;
};

// The largest distance of a normal if all other guides are equal.
float NormalThreshold(const MatchInput& input) {
  return input.test.EuclideanThreshold() / (input.space ? input.space->normal_weight() : 1.0f);
}

class CoherentMatch {
 public:
  CoherentMatch(const MatchInput& input, SourceField& field)
      : input_(input),
        field_(field),
        object_(input.guides.Plane(Layer::kObject)),
        octaves_(SurfaceOctaves(input.guides, input.active)),
        cell_(kSteadiness * std::min(kLargestCell, NormalThreshold(input))),
        settled_(input.guides.pixel_count(), 0) {
    // Unwanted pixels belong to cells as all do, but take no paint.
    for (std::size_t i = 0; i < input.wanted.size(); ++i) settled_[i] = !input.wanted[i];
  }

  bool Run(RowProgress& progress) {
    const Region& region = input_.region;
    const auto [low, high] = Exponents();
    for (int exponent = high; exponent >= low && !progress.cancelled(); --exponent) Settle(exponent);
    // Pixels that no seed suited.
    return ForEachRow(region, progress, [&](int y) {
      for (int x = region.x0; x < region.x1; ++x) {
        const std::size_t i = field_.Index(x, y);
        if (!input_.Wants(i) || settled_[i]) continue;
        const Candidate own = OwnCandidate(input_, i);
        field_.Set(i, own.source.x, own.source.y, own.exemplar, 0);
        if (!field_.guide_offset.empty()) field_.guide_offset[i] = own.guide_offset;
      }
    });
  }

 private:
  // The exponents at which a pixel may have a seed: e from floor(κ) + 1 on, for `levels` of them.
  bool Takes(std::size_t i, int exponent) const {
    if (octaves_[i] == kNoOctave) return false;
    const int above = exponent - static_cast<int>(std::floor(octaves_[i]));
    return above >= 1 && above <= input_.levels;
  }

  // The smallest and the largest such exponent of the region's pixels.
  std::pair<int, int> Exponents() const {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (int y = input_.region.y0; y < input_.region.y1; ++y) {
      for (int x = input_.region.x0; x < input_.region.x1; ++x) {
        const float octave = octaves_[field_.Index(x, y)];
        if (octave != kNoOctave) low = std::min(low, octave), high = std::max(high, octave);
      }
    }
    if (!(low <= high) || input_.levels < 2) return {1, 0};
    return {static_cast<int>(std::floor(low)) + 1, static_cast<int>(std::floor(high)) + input_.levels};
  }

  template <class RowFunction>
  static void Rows(const Region& region, RowFunction row) {
    tbb::parallel_for(tbb::blocked_range<int>(region.y0, region.y1, 8), [&](const auto& range) {
      for (int y = range.begin(); y != range.end(); ++y) row(y);
    });
  }

  // Finds the cells and their seeds, then tries the seeds on the pixels that have none yet.
  void Settle(int exponent) {
    if (!IsWanted(exponent)) return;
    const int width = input_.guides.width();
    const Region whole{0, 0, width, input_.guides.height()};
    key_.resize(input_.guides.pixel_count()), squared_.resize(key_.size());
    std::atomic<std::size_t> runs = 0;
    Rows(whole, [&](int y) { runs.fetch_add(FindCells(exponent, y), std::memory_order_relaxed); });
    SeedTable seeds(runs);
    Rows(whole, [&](int y) { AddSeeds(y, seeds); });
    Rows(input_.region, [&](int y) { CandidateRow(exponent, y, seeds); });
  }

  bool IsWanted(int exponent) const {
    std::atomic<bool> wanted = false;
    Rows(input_.region, [&](int y) {
      for (int x = input_.region.x0; x < input_.region.x1 && !wanted.load(std::memory_order_relaxed); ++x) {
        const std::size_t i = field_.Index(x, y);
        if (input_.Wants(i) && !settled_[i] && Takes(i, exponent)) wanted = true;
      }
    });
    return wanted;
  }

  // Key 0 where there is none. Returns the number of changes in the row.
  std::size_t FindCells(int exponent, int y) {
    SurfaceGrid grid;
    std::size_t runs = 0;
    std::uint64_t last = 0;
    for (int x = 0; x < input_.guides.width(); ++x) {
      const std::size_t i = field_.Index(x, y);
      key_[i] = 0;
      if (!Takes(i, exponent)) continue;
      const auto object = std::bit_cast<std::uint32_t>(object_[i]);  // any float will do
      if (!grid.Is(object, exponent)) grid = SurfaceGrid(input_.seeds, object, exponent);
      const SurfaceCell cell = grid.Nearest(input_.guides.Vec3(Layer::kPref, i));
      key_[i] = cell.key, squared_[i] = cell.squared;
      if (cell.key != last) ++runs, last = cell.key;
    }
    return runs;
  }

  void AddSeeds(int y, SeedTable& seeds) const {
    const int width = input_.guides.width();
    for (int x = 0; x < width;) {
      std::size_t nearest = field_.Index(x, y);
      const std::uint64_t key = key_[nearest];
      for (++x; x < width && key_[field_.Index(x, y)] == key; ++x) {
        if (squared_[field_.Index(x, y)] < squared_[nearest]) nearest = field_.Index(x, y);
      }
      if (key != 0) seeds.Add(key, squared_[nearest], static_cast<std::uint32_t>(nearest));
    }
  }

  void CandidateRow(int exponent, int y, SeedTable& seeds) {
    std::uint64_t last = 0;
    std::optional<Seed> seed;
    for (int x = input_.region.x0; x < input_.region.x1; ++x) {
      const std::size_t i = field_.Index(x, y);
      if (key_[i] == 0 || settled_[i] || !input_.Wants(i)) continue;
      if (key_[i] != last) last = key_[i], seed = MakeSeed(exponent, last, seeds.Pixel(last));
      if (!seed) continue;
      PixelGuide guide;
      input_.ReadGuide(i, guide);
      const auto taken = TryCandidate(input_, seed->made, seed->q, {x, y}, guide);
      if (!taken) continue;
      field_.Set(i, taken->source.x, taken->source.y, taken->exemplar, seed->level);
      if (!field_.guide_offset.empty()) field_.guide_offset[i] = taken->guide_offset;
      settled_[i] = 1;
    }
  }

  struct Seed {
    SeedCandidate made;
    PixelPosition q;
    int level = 0;
  };

  // Empty where the cell is too small or too large to take part.
  std::optional<Seed> MakeSeed(int exponent, std::uint64_t key, std::size_t pixel) const {
    const int level = exponent - static_cast<int>(std::floor(octaves_[pixel] + CellChance(key, 0)));
    if (level < input_.least_level || level >= input_.levels) return std::nullopt;
    const int width = input_.guides.width();
    PixelGuide guide;
    input_.ReadGuide(pixel, guide);
    PixelGuide steady = guide;
    steady.normal = Steady(guide.normal, cell_, key);
    Seed seed{SeedOf(input_, guide, OwnCandidate(input_, steady)),
              {static_cast<int>(pixel % width), static_cast<int>(pixel / width)},
              level};
    VarySource(input_, level, seed.q, Hash(key, 0x7a), seed.made);
    return seed;
  }

  const MatchInput& input_;
  SourceField& field_;
  std::span<const float> object_;
  std::vector<float> octaves_;
  float cell_;
  std::vector<std::uint8_t> settled_;
  std::vector<std::uint64_t> key_;  // of each pixel's cell, at the current exponent
  std::vector<float> squared_;
};

}  // namespace

bool MatchCoherent(const MatchInput& input, SourceField& field, RowProgress& progress) {
  return CoherentMatch(input, field).Run(progress);
}

}  // namespace scumble::internal
