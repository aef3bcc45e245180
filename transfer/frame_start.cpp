#include "transfer/frame_start.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "image/check.h"

namespace scumble::internal {
namespace {

constexpr int kTileWidth = 64, kTileHeight = 16;

Region Around(const Region& a, const Region& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

class Starter {
 public:
  // `field`: null where no field is kept.
  Starter(const FrameInput& input, SourceField* field, const ActiveRows& active, Picture& out)
      : input_(input),
        width_(input.guides.width()),
        coverage_(input.guides.Plane(Layer::kCoverage)),
        field_(field),
        active_(active),
        out_(out) {}

  void Start(int y0, int y1, StartedRows& rows) {
    for (int x0 = 0; x0 < width_; x0 += kTileWidth) {
      const int x1 = std::min(width_, x0 + kTileWidth);
      const Region tile{x0, y0, x1, y1};
      const std::size_t known = rows.tiles.size();
      int covered = 0;
      for (int y = y0; y < y1; ++y) {
        const int painted = input_.map ? ReadMap(y, known, tile, rows) : Cover(x0, x1, y);
        Clear(x0, x1, y, painted);
        covered += painted;
        rows.soft = rows.soft || (painted > 0 && Soft(x0, x1, y));
      }
      if (!input_.map && covered > 0) rows.tiles.push_back({std::uint16_t{0}, tile});
    }
  }

 private:
  // The pixels that are covered; marks them.
  int Cover(int x0, int x1, int y) {
    const float* coverage = coverage_.data() + input_.guides.Index(x0, y);
    std::uint8_t* active = active_.At(x0, y);
    int count = 0;
    for (int i = 0; i < x1 - x0; ++i) active[i] = coverage[i] > 0.0f;
    for (int i = 0; i < x1 - x0; ++i) count += active[i];
    return count;
  }

  bool Soft(int x0, int x1, int y) const {
    const float* coverage = coverage_.data() + input_.guides.Index(x0, y);
    int soft = 0;
    for (int i = 0; i < x1 - x0; ++i) soft |= (coverage[i] > 0.0f) & (coverage[i] < 1.0f);
    return soft != 0;
  }

  // The pixels that some style paints; notes which and where.
  int ReadMap(int y, std::size_t known, const Region& tile, StartedRows& rows) {
    const int x0 = tile.x0, x1 = tile.x1;
    const std::size_t begin = input_.guides.Index(x0, y);
    std::fill_n(active_.At(x0, y), x1 - x0, std::uint8_t{0});
    const float* coverage = coverage_.data() + begin;
    const std::uint16_t* style = input_.map->style.data() + begin;
    int count = 0;
    for (int i = 0; i < x1 - x0;) {
      const std::uint16_t here = style[i];
      int end = i + 1;
      while (end < x1 - x0 && style[end] == here) ++end;
      const int first = i;
      i = end;
      if (here == StyleMap::kLeave || here == StyleMap::kCatch) continue;
      int from = first, to = end;
      while (from < to && !(coverage[from] > 0.0f)) ++from;
      while (to > from && !(coverage[to - 1] > 0.0f)) --to;
      if (from == to) continue;
      for (int k = from; k < to; ++k) count += coverage[k] > 0.0f;
      SCUMBLE_CHECK(here < input_.styles);
      if (!rows.extents.empty()) rows.extents[here] = Around(rows.extents[here], {x0 + from, y, x0 + to, y + 1});
      const auto listed = [&](const auto& one) { return one.first == here; };
      if (std::none_of(rows.tiles.begin() + std::ptrdiff_t(known), rows.tiles.end(), listed)) {
        rows.tiles.push_back({here, tile});
      }
    }
    return count;
  }

  // Where all pixels are going to be painted nothing need be cleared.
  void Clear(int x0, int x1, int y, int painted) {
    const Region& region = input_.region;
    const bool row_inside = y >= region.y0 && y < region.y1;
    const int from = row_inside ? std::max(x0, region.x0) : x0, to = row_inside ? std::min(x1, region.x1) : x0;
    if (painted == x1 - x0 && row_inside && from == x0 && to == x1) return;
    if (field_) {
      const std::size_t begin = field_->Index(x0, y), count = std::size_t(x1 - x0);
      std::fill_n(field_->x.data() + begin, count, std::int16_t{0});
      std::fill_n(field_->y.data() + begin, count, std::int16_t{0});
      std::fill_n(field_->level.data() + begin, count, SourceField::kNoSource);
      std::fill_n(field_->exemplar.data() + begin, count, std::uint8_t{0});
    }
    if (from < to) std::fill_n(out_.At(from, y), 4 * std::size_t(to - from), std::uint16_t{0});
  }

  const FrameInput& input_;
  const int width_;
  std::span<const float> coverage_;
  SourceField* field_;
  ActiveRows active_;
  Picture& out_;
};

}  // namespace

void StartRows(const FrameInput& input, int y0, int y1, const ActiveRows& active, Picture& out, StartedRows& rows) {
  Starter(input, nullptr, active, out).Start(y0, y1, rows);
}

FrameStart StartFrame(const FrameInput& input, SourceField& field, std::vector<std::uint8_t>& active, Picture& out) {
  const int width = input.guides.width(), height = input.guides.height();
  field.Resize(width, height);
  active.resize(input.guides.pixel_count());
  if (out.width != width || out.height != height) out = Picture(width, height);
  const int count = (height + kTileHeight - 1) / kTileHeight;
  std::vector<StartedRows> bands(static_cast<std::size_t>(count));
  tbb::parallel_for(0, count, [&](int b) {
    StartedRows& rows = bands[std::size_t(b)];
    if (input.map) rows.extents.resize(input.styles);
    const int y0 = b * kTileHeight, y1 = std::min(height, y0 + kTileHeight);
    Starter(input, &field, {active.data(), width}, out).Start(y0, y1, rows);
  });
  FrameStart start;
  for (const StartedRows& band : bands) start.softly_covered = start.softly_covered || band.soft;
  if (!input.map) {
    start.extents = {Region{0, 0, width, height}};
    return start;
  }
  start.extents.resize(input.styles);
  start.tiles.resize(input.styles);
  for (const StartedRows& band : bands) {
    for (std::size_t s = 0; s < input.styles; ++s) start.extents[s] = Around(start.extents[s], band.extents[s]);
    for (const auto& [style, tile] : band.tiles) start.tiles[style].push_back(tile);
  }
  return start;
}

void ActivateTile(const FrameInput& input, int style, const Region& tile, const ActiveRows& active) {
  const float* coverage = input.guides.Plane(Layer::kCoverage).data();
  for (int y = tile.y0; y < tile.y1; ++y) {
    const std::size_t begin = input.guides.Index(tile.x0, y);
    const float* covered = coverage + begin;
    const std::uint16_t* painter = input.map->style.data() + begin;
    std::uint8_t* out = active.At(tile.x0, y);
    for (int i = 0; i < tile.x1 - tile.x0; ++i) {
      out[i] = static_cast<std::uint8_t>((covered[i] > 0.0f) & (painter[i] == style));
    }
  }
}

void DeactivateTile(const Region& tile, const ActiveRows& active) {
  for (int y = tile.y0; y < tile.y1; ++y) std::fill_n(active.At(tile.x0, y), tile.x1 - tile.x0, std::uint8_t{0});
}

void Activate(const FrameInput& input, int style, const std::vector<Region>& tiles, std::vector<std::uint8_t>& active) {
  const ActiveRows rows{active.data(), input.guides.width()};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tiles.size(), 16), [&](const auto& some) {
    for (std::size_t t = some.begin(); t != some.end(); ++t) ActivateTile(input, style, tiles[t], rows);
  });
}

void Deactivate(const FrameInput& input, const std::vector<Region>& tiles, std::vector<std::uint8_t>& active) {
  for (const Region& tile : tiles) DeactivateTile(tile, {active.data(), input.guides.width()});
}

}  // namespace scumble::internal
