#include "measure/coherence.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/image/check.h"

namespace scumble {
namespace {

// Disjoint sets of pixels, with path halving; the smaller index is always the root.
class PixelSets {
 public:
  explicit PixelSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::uint32_t Root(std::uint32_t pixel) {
    while (parent_[pixel] != pixel) {
      parent_[pixel] = parent_[parent_[pixel]];
      pixel = parent_[pixel];
    }
    return pixel;
  }

  void Join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t root_a = Root(a);
    const std::uint32_t root_b = Root(b);
    parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

// Whether p and q, (dx, dy) apart, have sources that are equally far apart.
bool SameOffset(const SourcePlanes& planes, std::size_t p, std::size_t q, int dx, int dy) {
  if (!planes.exemplar.empty() && planes.exemplar[p] != planes.exemplar[q]) return false;
  return planes.source_x[q] - planes.source_x[p] == dx && planes.source_y[q] - planes.source_y[p] == dy;
}

}  // namespace

CoherenceReport MeasureCoherence(const SourcePlanes& planes) {
  SCUMBLE_CHECK(planes.width >= 0 && planes.height >= 0);
  const std::size_t width = static_cast<std::size_t>(planes.width);
  const std::size_t count = width * static_cast<std::size_t>(planes.height);
  SCUMBLE_CHECK_EQ(planes.source_x.size(), count);
  SCUMBLE_CHECK_EQ(planes.source_y.size(), count);
  SCUMBLE_CHECK_EQ(planes.covered.size(), count);
  SCUMBLE_CHECK(planes.exemplar.empty() || planes.exemplar.size() == count);

  CoherenceReport report;
  PixelSets sets(count);
  const auto visit_pair = [&](std::size_t p, std::size_t q, int dx, int dy) {
    if (!planes.covered[q]) return;
    ++report.pairs;
    if (!SameOffset(planes, p, q, dx, dy)) return;
    ++report.coherent_pairs;
    sets.Join(static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(q));
  };
  for (std::size_t p = 0; p < count; ++p) {
    if (!planes.covered[p]) continue;
    ++report.covered;
    if ((p + 1) % width != 0) visit_pair(p, p + 1, 1, 0);
    if (p + width < count) visit_pair(p, p + width, 0, 1);
  }
  std::vector<std::uint32_t> area(count, 0);
  for (std::size_t p = 0; p < count; ++p) {
    if (planes.covered[p]) ++area[sets.Root(static_cast<std::uint32_t>(p))];
  }
  for (const std::uint32_t pixels : area) {
    report.chunks += pixels > 0;
    report.largest_chunk = std::max<std::size_t>(report.largest_chunk, pixels);
  }
  if (report.pairs > 0) report.share = static_cast<double>(report.coherent_pairs) / static_cast<double>(report.pairs);
  if (report.chunks > 0) {
    report.mean_chunk_area = static_cast<double>(report.covered) / static_cast<double>(report.chunks);
  }
  return report;
}

}  // namespace scumble
