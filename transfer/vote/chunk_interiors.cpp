#include "transfer/vote/chunk_interiors.h"

#include <algorithm>

#include "core/filter/parallel.h"

namespace scumble::internal {
namespace {

constexpr std::uint8_t kMixedRow = 1;      // the window's part of this row changes somewhere
constexpr std::uint8_t kUnlikeAbove = 2;   // this pixel is not of the chunk of the one above

// Whether two active pixels, dx and dy apart, are of one chunk; inactive ones are of none.
bool OneChunk(const SourceField& field, std::span<const std::uint8_t> active, std::size_t i, std::size_t j, int dx, int dy) {
  return active[i] && active[j] && field.x[j] - field.x[i] == dx && field.y[j] - field.y[i] == dy &&
         field.exemplar[i] == field.exemplar[j];
}

}  // namespace

std::vector<std::uint8_t> ChunkInteriors(const SourceField& field, std::span<const std::uint8_t> active, int radius,
                                         const Region& region) {
  if (region.empty()) return {};
  const Region grown = region.GrownBy(radius, field.width, field.height);
  const int columns = region.x1 - region.x0;
  std::vector<std::uint8_t> changes(std::size_t(columns) * (grown.y1 - grown.y0));
  tbb::parallel_for(tbb::blocked_range<int>(grown.y0, grown.y1, 8), [&](const auto& rows) {
    std::vector<int> start(std::size_t(grown.x1 - grown.x0));  // of the run of one chunk that a pixel stands in
    for (int y = rows.begin(); y != rows.end(); ++y) {
      for (int x = grown.x0; x < grown.x1; ++x) {
        const std::size_t i = field.Index(x, y);
        const bool goes_on = x > grown.x0 && OneChunk(field, active, i - 1, i, 1, 0);
        start[x - grown.x0] = goes_on ? start[x - grown.x0 - 1] : x;
      }
      std::uint8_t* out = changes.data() + std::size_t(y - grown.y0) * columns;
      for (int x = region.x0; x < region.x1; ++x) {
        const std::size_t i = field.Index(x, y);
        const int first = std::max(grown.x0, x - radius), last = std::min(grown.x1 - 1, x + radius);
        const bool mixed = !active[i] || start[last - grown.x0] > first;
        const bool unlike = y > grown.y0 && !OneChunk(field, active, i - field.width, i, 0, 1);
        *out++ = static_cast<std::uint8_t>((mixed ? kMixedRow : 0) | (unlike ? kUnlikeAbove : 0));
      }
    }
  });

  std::vector<std::uint8_t> inside(std::size_t(columns) * (region.y1 - region.y0));
  tbb::parallel_for(tbb::blocked_range<int>(0, columns, 64), [&](const auto& strip) {
    // The last row so far with either; rows are read in as windows reach them.
    std::vector<int> mixed(strip.size(), grown.y0 - 1), unlike(strip.size(), grown.y0 - 1);
    int next = grown.y0;
    for (int y = region.y0; y < region.y1; ++y) {
      const int first = std::max(grown.y0, y - radius), last = std::min(grown.y1 - 1, y + radius);
      for (; next <= last; ++next) {
        const std::uint8_t* row = changes.data() + std::size_t(next - grown.y0) * columns;
        for (int x = strip.begin(); x != strip.end(); ++x) {
          if (row[x] & kMixedRow) mixed[x - strip.begin()] = next;
          if (row[x] & kUnlikeAbove) unlike[x - strip.begin()] = next;
        }
      }
      std::uint8_t* out = inside.data() + std::size_t(y - region.y0) * columns;
      for (int x = strip.begin(); x != strip.end(); ++x) {
        out[x] = mixed[x - strip.begin()] < first && unlike[x - strip.begin()] <= first;
      }
    }
  });
  return inside;
}

}  // namespace scumble::internal
