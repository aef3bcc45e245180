#include "transfer/frame/frame_setup.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>

#include "core/image/check.h"

namespace scumble::internal {
namespace {

constexpr int kSetupTileWidth = 64, kSetupTileHeight = 16;

Region Around(const Region& a, const Region& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

bool FourAre(const std::uint16_t* styles, std::uint16_t style) {
  std::uint64_t four;
  std::memcpy(&four, styles, sizeof four);
  return four == style * 0x0001000100010001ull;
}

class Starter {
 public:
  // `field`: null where no field is kept. `covered` becomes 1 where coverage is above 0; null: not needed.
  Starter(const FrameInput& input, SourceField* field, const ActiveRows* covered, Picture& out)
      : input_(input),
        width_(input.guides.width()),
        coverage_(input.guides.Plane(Layer::kCoverage)),
        field_(field),
        covered_(covered),
        out_(out) {}

  void Start(int y0, int y1, StartedRows& rows) {
    if (input_.map) {
      for (int x0 = 0; x0 < width_; x0 += kSetupTileWidth) {
        const std::size_t known = rows.tiles.size();
        for (int y = y0; y < y1; ++y) ReadMap(y, known, {x0, y0, std::min(width_, x0 + kSetupTileWidth), y1}, rows);
      }
      return;
    }
    std::vector<std::uint8_t> any(static_cast<std::size_t>((width_ + kSetupTileWidth - 1) / kSetupTileWidth));
    for (int y = y0; y < y1; ++y) {
      for (int x0 = 0; x0 < width_; x0 += kSetupTileWidth) {
        const int x1 = std::min(width_, x0 + kSetupTileWidth), painted = Cover(x0, x1, y, covered_->At(x0, y));
        Finish(x0, x1, y, painted, rows);
        any[std::size_t(x0 / kSetupTileWidth)] |= painted > 0;
      }
    }
    for (int x0 = 0; x0 < width_; x0 += kSetupTileWidth) {
      if (any[std::size_t(x0 / kSetupTileWidth)])
        rows.tiles.push_back({0, {x0, y0, std::min(width_, x0 + kSetupTileWidth), y1}});
    }
  }

 private:
  // Marks the covered pixels and returns their number.
  int Cover(int x0, int x1, int y, std::uint8_t* covered) const {
    const float* coverage = coverage_.data() + input_.guides.Index(x0, y);
    int count = 0;
    for (int i = 0; i < x1 - x0; ++i) covered[i] = coverage[i] > 0.0f;
    for (int i = 0; i < x1 - x0; ++i) count += covered[i];
    return count;
  }

  void Finish(int x0, int x1, int y, int painted, StartedRows& rows) {
    Clear(x0, x1, y, painted);
    rows.soft = rows.soft || (painted > 0 && Soft(x0, x1, y));
  }

  bool Soft(int x0, int x1, int y) const {
    const float* coverage = coverage_.data() + input_.guides.Index(x0, y);
    int soft = 0;
    for (int i = 0; i < x1 - x0; ++i) soft |= (coverage[i] > 0.0f) & (coverage[i] < 1.0f);
    return soft != 0;
  }

  // Finds the pixels that some style paints, and records their styles and regions.
  void ReadMap(int y, std::size_t known, const Region& tile, StartedRows& rows) {
    const int x0 = tile.x0, x1 = tile.x1;
    std::uint8_t here_covered[kSetupTileWidth];
    std::uint8_t* const covered = covered_ ? covered_->At(x0, y) : here_covered;
    int painted = 0;
    if (Cover(x0, x1, y, covered) > 0) painted = CountPainted(y, known, tile, covered, rows);
    Finish(x0, x1, y, painted, rows);
  }

  int CountPainted(int y, std::size_t known, const Region& tile, const std::uint8_t* covered, StartedRows& rows) {
    const int x0 = tile.x0, x1 = tile.x1;
    const std::uint16_t* style = input_.map->style.data() + input_.guides.Index(x0, y);
    int count = 0;
    for (int i = 0; i < x1 - x0;) {
      const std::uint16_t here = style[i];
      int end = i + 1;
      while (end + 4 <= x1 - x0 && FourAre(style + end, here)) end += 4;
      while (end < x1 - x0 && style[end] == here) ++end;
      const int first = i;
      i = end;
      if (here == StyleMap::kPassThrough || here == StyleMap::kShadowCatcher) continue;
      int own = 0;
      for (int k = first; k < end; ++k) own += covered[k];
      if (own == 0) continue;
      count += own;
      SCUMBLE_CHECK(here < input_.styles);
      if (!rows.extents.empty()) {
        int from = first, to = end;
        while (!covered[from]) ++from;
        while (!covered[to - 1]) --to;
        rows.extents[here] = Around(rows.extents[here], {x0 + from, y, x0 + to, y + 1});
      }
      const auto listed = [&](const auto& one) { return one.first == here; };
      if (std::none_of(rows.tiles.begin() + std::ptrdiff_t(known), rows.tiles.end(), listed)) {
        rows.tiles.push_back({here, tile});
      }
    }
    return count;
  }

  // If all pixels will be painted, nothing need be cleared.
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
  const ActiveRows* covered_;
  Picture& out_;
};

}  // namespace

void StartRows(const FrameInput& input, int y0, int y1, const ActiveRows& covered, Picture& out, StartedRows& rows) {
  Starter(input, nullptr, &covered, out).Start(y0, y1, rows);
}

FrameSetup StartFrame(const FrameInput& input, SourceField& field, std::vector<std::uint8_t>& active, Picture& out) {
  const int width = input.guides.width(), height = input.guides.height();
  field.Resize(width, height);
  active.resize(input.guides.pixel_count());
  if (out.width != width || out.height != height) out = Picture(width, height);
  const int count = (height + kSetupTileHeight - 1) / kSetupTileHeight;
  std::vector<StartedRows> bands(static_cast<std::size_t>(count));
  tbb::parallel_for(0, count, [&](int b) {
    StartedRows& rows = bands[std::size_t(b)];
    if (input.map) rows.extents.resize(input.styles);
    const int y0 = b * kSetupTileHeight, y1 = std::min(height, y0 + kSetupTileHeight);
    const ActiveRows all{active.data(), width};
    if (input.map) std::fill_n(all.At(0, y0), std::size_t(y1 - y0) * width, std::uint8_t{0});
    Starter(input, &field, input.map ? nullptr : &all, out).Start(y0, y1, rows);
  });
  FrameSetup start;
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

void ActivateTile(const FrameInput& input, int style, const Region& tile, const ActiveRows& covered,
                  const ActiveRows& active) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    const std::uint16_t* painter = input.map->style.data() + input.guides.Index(tile.x0, y);
    const std::uint8_t* some = covered.At(tile.x0, y);
    std::uint8_t* out = active.At(tile.x0, y);
    for (int i = 0; i < tile.x1 - tile.x0; ++i) out[i] = some[i] & static_cast<std::uint8_t>(painter[i] == style);
  }
}

void DeactivateTile(const Region& tile, const ActiveRows& active) {
  for (int y = tile.y0; y < tile.y1; ++y) std::fill_n(active.At(tile.x0, y), tile.x1 - tile.x0, std::uint8_t{0});
}

void Activate(const FrameInput& input, int style, const std::vector<Region>& tiles, std::vector<std::uint8_t>& active) {
  const auto coverage = input.guides.Plane(Layer::kCoverage);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tiles.size(), 16), [&](const auto& some) {
    for (std::size_t t = some.begin(); t != some.end(); ++t) {
      for (int y = tiles[t].y0; y < tiles[t].y1; ++y) {
        const std::size_t begin = input.guides.Index(tiles[t].x0, y);
        const float* covered = coverage.data() + begin;
        const std::uint16_t* painter = input.map->style.data() + begin;
        std::uint8_t* out = active.data() + begin;
        for (int i = 0; i < tiles[t].x1 - tiles[t].x0; ++i) {
          out[i] = static_cast<std::uint8_t>((covered[i] > 0.0f) & (painter[i] == style));
        }
      }
    }
  });
}

void Deactivate(const FrameInput& input, const std::vector<Region>& tiles, std::vector<std::uint8_t>& active) {
  for (const Region& tile : tiles) DeactivateTile(tile, {active.data(), input.guides.width()});
}

}  // namespace scumble::internal
