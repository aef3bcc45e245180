// The engine in plain form: without tables, regions, threads, vectors or other optimisations, as a reference for the
// fast one.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/image/guides.h"
#include "core/image/style.h"
#include "scumble/picture.h"
#include "transfer/prepared_exemplar.h"
#include "transfer/seeds/seeds.h"

namespace scumble::testing {

// Of TransferOptions, for what is compared with it.
inline constexpr std::uint64_t kPlainSeed = 21;

// The style's own test of the difference of two normals. Squares and sums are floats, as the style's manual has it; the
// threshold's square is not rounded: double holds it.
inline bool PlainAlike(const glm::vec3& d, const TransferSettings& settings) {
  const double threshold = settings.threshold;
  if (settings.threshold_metric == ThresholdMetric::kL1)
    return std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z) < threshold;
  return d.x * d.x + d.y * d.y + d.z * d.z < threshold * threshold;
}

struct PlainSource {
  int x = 0, y = 0, level = 0;
};

// Section 3.2 of the StyleBlit paper, pixel by pixel.
inline PlainSource PlainSourceAt(const GuideSet& guides, const PreparedExemplar& exemplar,
                                 const TransferSettings& settings, int x, int y, std::uint64_t seed = kPlainSeed) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  const glm::vec3 normal = exemplar.WithinRim(guides.Vec3(Layer::kNormal, guides.Index(x, y)));
  for (int level = settings.levels - 1; level >= 1; --level) {
    PixelPosition q;
    std::int64_t nearest = std::numeric_limits<std::int64_t>::max();
    for (int row = -1; row <= 1; ++row) {
      for (int column = -1; column <= 1; ++column) {
        const PixelPosition s =
            SeedOfCell({seed, 0, settings.jitter, 0}, level, (x >> level) + column, (y >> level) + row);
        const std::int64_t d = std::int64_t(s.x - x) * (s.x - x) + std::int64_t(s.y - y) * (s.y - y);
        if (d < nearest) nearest = d, q = s;
      }
    }
    if (q.x < 0 || q.y < 0 || q.x >= guides.width() || q.y >= guides.height()) continue;
    if (!(coverage[guides.Index(q.x, q.y)] > 0.0f)) continue;
    const Source u = exemplar.NearestNeighbour(exemplar.WithinRim(guides.Vec3(Layer::kNormal, guides.Index(q.x, q.y))));
    const PlainSource candidate{u.x + x - q.x, u.y + y - q.y, level};
    if (!exemplar.Usable(candidate.x, candidate.y)) continue;
    if (PlainAlike(normal - exemplar.Normal(candidate.x, candidate.y), settings)) return candidate;
  }
  const Source own = exemplar.NearestNeighbour(normal);
  return {own.x, own.y, 0};
}

// A random seed with which a level whose cells are larger than the picture has a candidate: the seed of its first cell,
// the only one that may stand in the picture, does, on a covered pixel with a finite normal. One in 4^level / pixels
// does so; this is the first, on every machine.
inline std::uint64_t SeedThatReaches(int level, const GuideSet& guides) {
  constexpr std::uint64_t kMost = std::uint64_t(1) << 24;  // fifteen times what level 15 takes with 1,000 pixels
  for (std::uint64_t seed = 0; seed < kMost; ++seed) {
    const PixelPosition q = SeedOfCell({seed, 0, 1.0f, 0}, level, 0, 0);
    if (q.x >= guides.width() || q.y >= guides.height()) continue;
    const std::size_t i = guides.Index(q.x, q.y);
    const glm::vec3 normal = guides.Vec3(Layer::kNormal, i);
    if (guides.Plane(Layer::kCoverage)[i] > 0.0f && glm::dot(normal, normal) < 4.0f) return seed;
  }
  ADD_FAILURE() << "no random seed reaches level " << level << " on " << guides.width() << "×" << guides.height();
  return 0;
}

// Every neighbour inside the window votes, over at most one cell of its grid; nothing stops at edges.
inline Picture PlainEngine(const Style& style, const GuideSet& guides) {
  const PreparedExemplar exemplar(style.exemplars[0].picture, style.transfer.rim, style.exemplars[0].picture.width);
  const auto coverage = guides.Plane(Layer::kCoverage);
  std::vector<PlainSource> sources(guides.pixel_count());
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      const std::size_t i = guides.Index(x, y);
      if (coverage[i] > 0.0f) sources[i] = PlainSourceAt(guides, exemplar, style.transfer, x, y);
    }
  }
  Picture picture(guides.width(), guides.height());
  const int radius = style.transfer.blend_radius;
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      if (!(coverage[guides.Index(x, y)] > 0.0f)) continue;
      std::uint64_t sum[3] = {0, 0, 0}, votes = 0;
      for (int v = std::max(0, y - radius); v <= std::min(guides.height() - 1, y + radius); ++v) {
        for (int u = std::max(0, x - radius); u <= std::min(guides.width() - 1, x + radius); ++u) {
          const std::size_t q = guides.Index(u, v);
          if (!(coverage[q] > 0.0f)) continue;
          if (std::max(std::abs(u - x), std::abs(v - y)) > 1 << sources[q].level) continue;
          const int sx = sources[q].x + x - u, sy = sources[q].y + y - v;
          if (!exemplar.Usable(sx, sy)) continue;
          for (int c = 0; c < 3; ++c) sum[c] += exemplar.picture().At(sx, sy)[c];
          ++votes;
        }
      }
      std::uint16_t* pixel = picture.At(x, y);
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint16_t>((2 * sum[c] + votes) / (2 * votes));
      pixel[3] = 65535;
    }
  }
  return picture;
}

}  // namespace scumble::testing
