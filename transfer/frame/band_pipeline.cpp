#include "transfer/frame/band_pipeline.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <mutex>
#include <vector>

#include "core/image/stopwatch.h"

namespace scumble::internal {
namespace {

// Rows of a step, which are started, matched and voted on together; their data stay in the second cache.
constexpr int kStep = 24;
constexpr int kLeastRange = 16;  // rows of a range that another thread may take over

// The remaining rows, distributed over workers. Each worker goes down its own range of rows; a worker that is done
// takes the lower half of the longest remaining range. So ranges are as long as possible: each begins with seeds that
// must be made, and ends with rows that are matched twice.
class RowRanges {
 public:
  RowRanges(int y0, int y1, int workers) {
    for (int w = 0; w < workers; ++w) {
      const auto part = [&](int k) { return y0 + static_cast<int>(std::int64_t(y1 - y0) * k / workers); };
      left_.push_back({part(w), part(w + 1)});
    }
  }

  struct Rows {
    int begin, end;
    int unclaimed_end;  // rows from `end` to here are not taken yet, and only this worker will take them
    int size() const { return end - begin; }
  };
  // The next rows for a worker, at most `most`, directly below its last ones unless its range has ended. Empty if there
  // are none.
  Rows Take(int worker, int most) {
    const std::lock_guard lock(mutex_);
    Stretch& own = left_[static_cast<std::size_t>(worker)];
    if (own.size() == 0) {
      Stretch& longest = *std::ranges::max_element(left_, {}, &Stretch::size);
      if (longest.size() < 2 * kLeastRange) return {0, 0, 0};
      const int middle = longest.begin + longest.size() / 2;
      own = {middle, longest.end};
      longest.end = middle;
    }
    const int begin = own.begin;
    own.begin = std::min(own.end, begin + most);
    return {begin, own.begin, std::min(own.end, own.begin + kLeastRange)};
  }

 private:
  struct Stretch {
    int begin, end;
    int size() const { return end - begin; }
  };
  std::mutex mutex_;
  std::vector<Stretch> left_;  // by worker
};

// Data that is made once for all threads.
struct SharedStyle {
  const BandStyle& style;
  ExemplarRows exemplar;
  SmallVotes small_votes;
  std::optional<WideVotes> wide_votes;  // for radii above kSmallRadius
  // With a base layer only:
  std::optional<SmallVotes> small_base_votes;
  std::optional<WideVotes> wide_base_votes;
  std::optional<HybridTone> tone;
};

// One thread's part of the frame.
class Band {
 public:
  Band(const FrameInput& frame, std::span<const SharedStyle> styles, FragmentPaint& fragments, BandMemory& memory,
       Picture& base_votes, Picture& out)
      : frame_(frame),
        styles_(styles),
        fragments_(fragments),
        base_votes_(base_votes),
        out_(out),
        columns_((frame.guides.width() + kTileWidth - 1) / kTileWidth),
        memory_(memory),
        field_(memory.field) {
    for (const SharedStyle& shared : styles_) radius_ = std::max(radius_, shared.style.radius);
    if (!fragments.empty()) radius_ = std::max(radius_, FragmentPaint::kReach);
    const int width = frame.guides.width(), height = frame.guides.height();
    const int rows = std::min(height, kStep + 2 * radius_);
    field_.ResizeRows(width, height, rows);
    memory.covered.resize(std::size_t(rows) * width);
    if (frame.map) memory.active.assign(std::size_t(rows) * width, 0);
    memory.words.assign(std::size_t(width + 63) / 64, 0);
    memory.regions.resize(styles_.size());
    if (memory.seeds.size() < styles_.size() * columns_) memory.seeds.resize(styles_.size() * columns_);
  }

  // Paints rows of the region, as long as this worker gets any.
  void Paint(RowRanges& row_ranges, int worker, RowProgress& progress) {
    watch_.Lap();
    int last = -1;
    for (RowRanges::Rows rows; !progress.cancelled() && (rows = row_ranges.Take(worker, kStep)).size() > 0;
         last = rows.end) {
      if (rows.begin != last) Begin(rows.begin);
      own_.y1 = rows.unclaimed_end;
      Paint(rows.begin, rows.end);
      progress.Finished(rows.size());
    }
  }

  bool soft() const { return soft_; }
  const BandShares& shares() const { return shares_; }

 private:
  // Begins a range of rows.
  void Begin(int y) {
    for (std::vector<Region>& regions : memory_.regions) regions.clear();
    for (TileScratch& seeds : memory_.seeds) seeds.begun = false;
    field_.first_row = end_ = std::max(0, y - radius_);
    own_ = {frame_.region.x0, y, frame_.region.x1, y};
  }

  void Paint(int y0, int y1) {
    Forget(std::max(0, y0 - radius_));
    const int begin = end_;
    end_ = std::min(field_.height, y1 + radius_);
    Start(begin);
    for (std::size_t s = 0; s < styles_.size(); ++s) {
      const Region painted{own_.x0, y0, own_.x1, y1};
      if (!memory_.regions[s].empty()) {
        PaintStyle(static_cast<int>(s), begin, painted);
      } else if (!fragments_.empty()) {
        PaintFragments(static_cast<int>(s), painted, frame_.map ? memory_.active : memory_.covered);
      }
    }
  }

  ActiveRows Covered() const { return {memory_.covered.data(), field_.width, field_.first_row}; }
  ActiveRows Active() const { return {memory_.active.data(), field_.width, field_.first_row}; }
  const std::vector<Region>& RegionsOf(int s) const { return memory_.regions[static_cast<std::size_t>(s)]; }

  // Rows above y are not needed any more.
  void Forget(int y) {
    const std::ptrdiff_t from = std::ptrdiff_t(field_.Index(0, y)), to = std::ptrdiff_t(field_.Index(0, end_));
    if (from > 0) {
      const auto move = [&](auto& plane) { std::copy(plane.begin() + from, plane.begin() + to, plane.begin()); };
      move(field_.x), move(field_.y), move(field_.level), move(field_.exemplar), move(memory_.covered);
    }
    field_.first_row = y;
    for (std::vector<Region>& regions : memory_.regions) {
      std::erase_if(regions, [&](const Region& region) { return region.y1 <= y; });
      for (Region& region : regions) region.y0 = std::max(region.y0, y);
    }
  }

  // Sets up rows from `begin` on.
  void Start(int begin) {
    StartedRows& rows = memory_.rows;
    rows.tiles.clear(), rows.soft = false;
    const FrameInput cleared{frame_.guides, frame_.map, frame_.styles, own_};  // other threads clear the other rows
    StartRows(cleared, begin, end_, Covered(), out_, rows);
    soft_ = soft_ || rows.soft;
    for (const auto& [style, tile] : rows.tiles) memory_.regions[style].push_back(tile);
    shares_.start += watch_.Lap();
  }

  // Matches a style's pixels from row `begin` on, and votes on those of `painted`.
  void PaintStyle(int s, int begin, const Region& painted) {
    if (frame_.map) {
      for (const Region& region : RegionsOf(s)) ActivateTile(frame_, s, region, Covered(), Active());
    }
    const std::span<const std::uint8_t> active = frame_.map ? memory_.active : memory_.covered;
    Match(s, begin, active);
    shares_.match += watch_.Lap();
    Vote(s, painted, active);
    if (!fragments_.empty()) PaintFragments(s, painted, active);
    if (frame_.map) {
      for (const Region& region : RegionsOf(s)) DeactivateTile(region, Active());
    }
    shares_.vote += watch_.Lap();
  }

  void Match(int s, int begin, std::span<const std::uint8_t> active) {
    const std::vector<Region>& regions = RegionsOf(s);
    // New ones come last, from left to right.
    auto region = std::ranges::find_if(regions, [&](const Region& one) { return one.y1 > begin; });
    while (region != regions.end()) {
      const int x0 = region->x0, end = (x0 / kTileWidth + 1) * kTileWidth;
      int x1 = x0;
      for (; region != regions.end() && region->x0 < end; ++region) x1 = region->x1;
      MatchRows(s, {x0, begin, x1, end_}, active);
    }
  }

  void MatchRows(int s, const Region& part, std::span<const std::uint8_t> active) {
    if (part.empty()) return;
    const SharedStyle& shared = styles_[static_cast<std::size_t>(s)];
    const int column = part.x0 / kTileWidth;
    MatchTile({shared.style.match, shared.exemplar, column, part.x0, part.x1, part.y0, part.y1, active,
               memory_.seeds[static_cast<std::size_t>(s) * columns_ + column], field_});
  }

  void Vote(int s, const Region& painted, std::span<const std::uint8_t> active) {
    const SharedStyle& shared = styles_[static_cast<std::size_t>(s)];
    VoteInput votes{field_,
                    active,
                    shared.style.match.exemplar,
                    shared.style.radius,
                    shared.style.edges ? &*shared.style.edges : nullptr,
                    painted};
    const ColorizeInput tint{frame_.guides, active, shared.style.tint, field_.first_row};
    if (shared.tone || tint.tint.active()) {
      votes.finished = [&](int y, int x0, int x1) {
        if (shared.tone) shared.tone->AddToRow(active.data() + field_.Index(0, y), y, x0, x1, base_votes_, out_);
        if (tint.tint.active()) ColorizeRow(tint, y, x0, x1, out_);
      };
    }
    std::vector<std::uint8_t>& words = memory_.words;  // that have pixels of the style
    for (const Region& region : RegionsOf(s)) words[static_cast<std::size_t>(region.x0 / 64)] = 1;
    constexpr std::ptrdiff_t kGap = 2;  // gaps of so few words between two others are processed too
    for (auto from = std::ranges::find(words, 1); from != words.end();) {
      auto to = from + 1, next = std::find(to, words.end(), 1);
      while (next != words.end() && next - to <= kGap) to = next + 1, next = std::find(to, words.end(), 1);
      votes.region.x0 = std::max(painted.x0, 64 * static_cast<int>(from - words.begin()));
      votes.region.x1 = std::min(painted.x1, 64 * static_cast<int>(to - words.begin()));
      if (!votes.region.empty()) {
        if (shared.tone) VoteOnBaseLayers(shared, votes);
        if (shared.wide_votes) {
          shared.wide_votes->Vote(votes, memory_.votes, out_);
        } else {
          shared.small_votes.Vote(votes, out_);
        }
      }
      from = next;
    }
    std::ranges::fill(words, 0);
  }

  void VoteOnBaseLayers(const SharedStyle& shared, const VoteInput& paint) {
    const VoteInput votes{paint.field, paint.active, *shared.style.base, paint.radius, paint.edges, paint.region};
    if (shared.wide_base_votes) {
      shared.wide_base_votes->Vote(votes, memory_.votes, base_votes_);
    } else {
      shared.small_base_votes->Vote(votes, base_votes_);
    }
  }

  void PaintFragments(int s, const Region& painted, std::span<const std::uint8_t> active) {
    const BandStyle& style = styles_[static_cast<std::size_t>(s)].style;
    FragmentStyle settings{style.match, false, style.edges.has_value(), -2.0f, style.base, style.tint};
    if (style.edges) settings.crease_cosine = style.edges->CreaseCosine();
    const VoteInput votes{field_, active, style.match.exemplar, style.radius, nullptr, painted};
    fragments_.Paint(settings, s, votes, painted.y0, painted.y1);
  }

  const FrameInput& frame_;
  std::span<const SharedStyle> styles_;
  FragmentPaint& fragments_;
  Picture& base_votes_;
  Picture& out_;
  const int columns_;  // of tiles
  int radius_ = 0;     // the largest
  Region own_;         // rows that no other thread paints
  BandMemory& memory_;
  SourceField& field_;  // of the rows at hand, from its first_row to end_
  int end_ = 0;
  bool soft_ = false;
  Stopwatch watch_;
  BandShares shares_;
};

}  // namespace

BandResult PaintByBands(const FrameInput& frame, std::span<const BandStyle> styles, FragmentPaint& fragments,
                        std::vector<BandMemory>& memory, Picture& base_votes, Picture& out, RowProgress& progress) {
  const int width = frame.guides.width(), height = frame.guides.height();
  if (out.width != width || out.height != height) out = Picture(width, height);
  std::vector<SharedStyle> shared;
  shared.reserve(styles.size());
  for (const BandStyle& style : styles) {
    SharedStyle& one = shared.emplace_back(
        SharedStyle{style, style.match.exemplar.Rows(), SmallVotes(style.match.exemplar), {}, {}, {}, {}});
    if (style.radius > kSmallRadius) one.wide_votes.emplace(style.match.exemplar);
    if (!style.base) continue;
    one.tone.emplace(HybridLayers{style.match.exemplar, *style.base, style.match.illumination, nullptr},
                     HybridFrame{frame.guides, style.match.luminance, style.match.brightness});
    one.small_base_votes.emplace(*style.base);
    if (style.radius > kSmallRadius) one.wide_base_votes.emplace(*style.base);
    if (base_votes.width != width || base_votes.height != height) base_votes = Picture(width, height);
  }
  const int workers = tbb::this_task_arena::max_concurrency();
  RowRanges row_ranges(frame.region.y0, std::max(frame.region.y0, frame.region.y1), workers);
  std::vector<std::optional<Band>> bands(static_cast<std::size_t>(workers));
  if (memory.size() < bands.size()) memory.resize(bands.size());
  const auto paint = [&](int worker) {
    std::optional<Band>& band = bands[static_cast<std::size_t>(worker)];
    band.emplace(frame, shared, fragments, memory[static_cast<std::size_t>(worker)], base_votes, out);
    band->Paint(row_ranges, worker, progress);
  };
  tbb::parallel_for(0, workers, paint, tbb::simple_partitioner());
  BandResult result;
  result.finished = !progress.cancelled();
  BandShares& sum = result.shares;
  for (const std::optional<Band>& band : bands) {
    if (!band) continue;
    result.softly_covered = result.softly_covered || band->soft();
    sum.start += band->shares().start, sum.match += band->shares().match, sum.vote += band->shares().vote;
  }
  const double all = sum.start + sum.match + sum.vote;
  if (all > 0.0) sum.start /= all, sum.match /= all, sum.vote /= all;
  return result;
}

}  // namespace scumble::internal
