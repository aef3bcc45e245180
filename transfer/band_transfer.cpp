#include "transfer/band_transfer.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <vector>

#include "image/stopwatch.h"
#include "transfer/styleblit_tiles.h"

namespace scumble::internal {
namespace {

constexpr int kStep = 24;        // rows that are started, matched and voted on together; what they need stays in the second cache
constexpr int kLeastShare = 16;  // rows of a stretch that another thread may take over

// The rows that are left, shared out over workers. Each goes down its own stretch; who is done takes the lower half of the
// longest that is left, so stretches are as long as can be: each begins with seeds that must be made, and ends with rows
// that are matched twice.
class RowShares {
 public:
  RowShares(int y0, int y1, int workers) {
    for (int w = 0; w < workers; ++w) {
      const auto part = [&](int k) { return y0 + static_cast<int>(std::int64_t(y1 - y0) * k / workers); };
      left_.push_back({part(w), part(w + 1)});
    }
  }

  struct Rows {
    int begin, end;
    int sure;  // rows from `end` to here are not taken yet, but will be by nobody else
    int size() const { return end - begin; }
  };
  // The next rows for a worker, at most `most`, straight below its last ones unless these were the end of its stretch.
  // None: empty.
  Rows Take(int worker, int most) {
    const std::lock_guard lock(mutex_);
    Stretch& own = left_[static_cast<std::size_t>(worker)];
    if (own.size() == 0) {
      Stretch& longest = *std::ranges::max_element(left_, {}, &Stretch::size);
      if (longest.size() < 2 * kLeastShare) return {0, 0, 0};
      const int middle = longest.begin + longest.size() / 2;
      own = {middle, longest.end};
      longest.end = middle;
    }
    const int begin = own.begin;
    own.begin = std::min(own.end, begin + most);
    return {begin, own.begin, std::min(own.end, own.begin + kLeastShare)};
  }

 private:
  struct Stretch {
    int begin, end;
    int size() const { return end - begin; }
  };
  std::mutex mutex_;
  std::vector<Stretch> left_;  // by worker
};

// What is made once for all threads.
struct SharedStyle {
  const BandStyle& style;
  ExemplarRows exemplar;
  SmallVotes votes;
};

// One thread's share.
class Band {
 public:
  Band(const FrameInput& frame, std::span<const SharedStyle> styles, Picture& out)
      : frame_(frame), styles_(styles), out_(out), columns_((frame.guides.width() + kTileWidth - 1) / kTileWidth) {
    for (const SharedStyle& shared : styles_) radius_ = std::max(radius_, shared.style.radius);
    const int width = frame.guides.width(), height = frame.guides.height();
    const int rows = std::min(height, kStep + 2 * radius_);
    field_.ResizeRows(width, height, rows);
    active_.resize(std::size_t(rows) * width);
    pieces_.resize(styles_.size());
    seeds_.resize(styles_.size() * columns_);
  }

  // Rows of the region, as long as there are any for this worker.
  void Paint(RowShares& shares, int worker, RowProgress& progress) {
    watch_.Lap();
    int last = -1;
    for (RowShares::Rows rows; !progress.cancelled() && (rows = shares.Take(worker, kStep)).size() > 0; last = rows.end) {
      if (rows.begin != last) Begin(rows.begin);
      own_.y1 = rows.sure;
      Paint(rows.begin, rows.end);
      progress.Finished(rows.size());
    }
  }

  bool soft() const { return soft_; }
  const BandShares& shares() const { return shares_; }

 private:
  // A stretch of rows.
  void Begin(int y) {
    for (std::vector<Region>& pieces : pieces_) pieces.clear();
    for (TileScratch& seeds : seeds_) seeds.begun = false;
    field_.first_row = end_ = std::max(0, y - radius_);
    own_ = {frame_.region.x0, y, frame_.region.x1, y};
  }

  void Paint(int y0, int y1) {
    Forget(std::max(0, y0 - radius_));
    const int begin = end_;
    end_ = std::min(field_.height, y1 + radius_);
    Start(begin);
    for (std::size_t s = 0; s < styles_.size(); ++s) {
      if (!pieces_[s].empty()) PaintStyle(static_cast<int>(s), begin, {own_.x0, y0, own_.x1, y1});
    }
  }

  ActiveRows Active() { return {active_.data(), field_.width, field_.first_row}; }

  // Rows above y are not needed any more.
  void Forget(int y) {
    const std::ptrdiff_t from = std::ptrdiff_t(field_.Index(0, y)), to = std::ptrdiff_t(field_.Index(0, end_));
    if (from > 0) {
      const auto move = [&](auto& plane) { std::copy(plane.begin() + from, plane.begin() + to, plane.begin()); };
      move(field_.x), move(field_.y), move(field_.level), move(field_.exemplar), move(active_);
    }
    field_.first_row = y;
    for (std::vector<Region>& pieces : pieces_) std::erase_if(pieces, [&](const Region& piece) { return piece.y1 <= y; });
  }

  // Rows from `begin` on.
  void Start(int begin) {
    rows_.tiles.clear();
    const FrameInput cleared{frame_.guides, frame_.map, frame_.styles, own_};  // other rows are other threads'
    StartRows(cleared, begin, end_, Active(), out_, rows_);
    soft_ = soft_ || rows_.soft;
    for (const auto& [style, tile] : rows_.tiles) pieces_[style].push_back(tile);
    shares_.start += watch_.Lap();
  }

  // Matches a style's pixels from row `begin` on, and votes on those of `painted`.
  void PaintStyle(int s, int begin, const Region& painted) {
    const SharedStyle& shared = styles_[static_cast<std::size_t>(s)];
    if (frame_.map) {
      for (const Region& piece : Held(s)) ActivateTile(frame_, s, piece, Active());
    }
    Match(s, begin);
    shares_.match += watch_.Lap();
    VoteInput votes{field_, active_, shared.style.match.exemplar, shared.style.radius,
                    shared.style.edges ? &*shared.style.edges : nullptr, painted};
    const ColorizeInput tint{frame_.guides, active_, shared.style.tint, field_.first_row};
    if (tint.tint.active()) votes.finished = [&](int y, int x0, int x1) { ColorizeRow(tint, y, x0, x1, out_); };
    int left = painted.x1, right = painted.x0;
    for (const Region& piece : pieces_[static_cast<std::size_t>(s)]) {
      left = std::min(left, piece.x0), right = std::max(right, piece.x1);
    }
    votes.region.x0 = std::max(left, painted.x0), votes.region.x1 = std::min(right, painted.x1);
    if (!votes.region.empty()) shared.votes.Vote(votes, out_);
    if (frame_.map) {
      for (const Region& piece : Held(s)) DeactivateTile(piece, Active());
    }
    shares_.vote += watch_.Lap();
  }

  // The parts of a style's pieces in the rows that are held.
  const std::vector<Region>& Held(int s) {
    held_ = pieces_[static_cast<std::size_t>(s)];
    for (Region& piece : held_) piece.y0 = std::max(piece.y0, field_.first_row);
    return held_;
  }

  void Match(int s, int begin) {
    const BandStyle& style = styles_[static_cast<std::size_t>(s)].style;
    int last = -1;
    for (const Region& piece : pieces_[static_cast<std::size_t>(s)]) {  // in columns from the left, as they were found
      const int column = piece.x0 / kTileWidth;
      if (piece.y1 <= begin || column == last) continue;
      last = column;
      // Rows that another thread matches too are not looked up: both might write what they learn.
      MatchRows(s, column, begin, std::min(end_, own_.y0), nullptr);
      MatchRows(s, column, std::max(begin, own_.y0), std::min(end_, own_.y1), style.match.seed_map);
      MatchRows(s, column, std::max(begin, own_.y1), end_, nullptr);
    }
  }

  void MatchRows(int s, int column, int y0, int y1, SeedMap* map) {
    if (y0 >= y1) return;
    const SharedStyle& shared = styles_[static_cast<std::size_t>(s)];
    MatchTile({shared.style.match, shared.exemplar, column, y0, y1, map, active_,
               seeds_[static_cast<std::size_t>(s) * columns_ + column], field_});
  }

  const FrameInput& frame_;
  std::span<const SharedStyle> styles_;
  Picture& out_;
  const int columns_;  // of tiles
  int radius_ = 0;     // the largest
  Region own_;         // rows that no other thread paints
  SourceField field_;  // of the rows at hand, from its first_row to end_
  int end_ = 0;
  std::vector<std::uint8_t> active_;  // by the field's index; with a map 0 but for the style at work
  StartedRows rows_;
  std::vector<std::vector<Region>> pieces_;  // by style, where the rows at hand have pixels of it
  std::vector<Region> held_;
  std::vector<TileScratch> seeds_;  // by style and column of tiles
  bool soft_ = false;
  Stopwatch watch_;
  BandShares shares_;
};

}  // namespace

BandResult PaintByBands(const FrameInput& frame, std::span<const BandStyle> styles, Picture& out, RowProgress& progress) {
  const int width = frame.guides.width(), height = frame.guides.height();
  if (out.width != width || out.height != height) out = Picture(width, height);
  std::vector<SharedStyle> shared;
  shared.reserve(styles.size());
  for (const BandStyle& style : styles) {
    shared.push_back({style, style.match.exemplar.Rows(), SmallVotes(style.match.exemplar, style.radius)});
  }
  const int workers = tbb::this_task_arena::max_concurrency();
  RowShares shares(frame.region.y0, std::max(frame.region.y0, frame.region.y1), workers);
  std::vector<std::unique_ptr<Band>> bands(static_cast<std::size_t>(workers));
  const auto paint = [&](int worker) {
    std::unique_ptr<Band>& band = bands[static_cast<std::size_t>(worker)];
    band = std::make_unique<Band>(frame, shared, out);
    band->Paint(shares, worker, progress);
  };
  tbb::parallel_for(0, workers, paint, tbb::simple_partitioner());
  BandResult result;
  result.finished = !progress.cancelled();
  BandShares& sum = result.shares;
  for (const std::unique_ptr<Band>& band : bands) {
    if (!band) continue;
    result.softly_covered = result.softly_covered || band->soft();
    sum.start += band->shares().start, sum.match += band->shares().match, sum.vote += band->shares().vote;
  }
  const double all = sum.start + sum.match + sum.vote;
  if (all > 0.0) sum.start /= all, sum.match /= all, sum.vote /= all;
  return result;
}

}  // namespace scumble::internal
