// Coherence, with numbers worked out by hand.
#include "measure/coherence.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

namespace scumble {
namespace {

CoherenceReport Coherence(int width, const std::vector<std::int16_t>& x, const std::vector<std::int16_t>& y,
                          const std::vector<std::uint8_t>& covered, const std::vector<std::uint8_t>& exemplar = {}) {
  return MeasureCoherence({width, static_cast<int>(x.size()) / width, x, y, covered, exemplar});
}

TEST(Coherence, StraightCopyIsOneChunk) {
  const CoherenceReport report = Coherence(3, {5, 6, 7, 5, 6, 7}, {2, 2, 2, 3, 3, 3}, {1, 1, 1, 1, 1, 1});
  EXPECT_EQ(report.covered, 6u);
  EXPECT_EQ(report.pairs, 7u);  // 2 · 2 to the right, 3 downwards
  EXPECT_EQ(report.coherent_pairs, 7u);
  EXPECT_EQ(report.share, 1.0);
  EXPECT_EQ(report.chunks, 1u);
  EXPECT_EQ(report.largest_chunk, 6u);
  EXPECT_EQ(report.mean_chunk_area, 6.0);
}

TEST(Coherence, CutAndBackground) {
  // Top row: two pixels of one offset, then one of another. Bottom row: background under the first, then a pixel that
  // continues the first chunk from above, then one that continues nothing.
  const CoherenceReport report = Coherence(3, {5, 6, 90, 0, 6, 40}, {2, 2, 2, 0, 3, 9}, {1, 1, 1, 0, 1, 1});
  EXPECT_EQ(report.covered, 5u);
  EXPECT_EQ(report.pairs, 5u);
  EXPECT_EQ(report.coherent_pairs, 2u);
  EXPECT_DOUBLE_EQ(report.share, 0.4);
  EXPECT_EQ(report.chunks, 3u);
  EXPECT_EQ(report.largest_chunk, 3u);
  EXPECT_DOUBLE_EQ(report.mean_chunk_area, 5.0 / 3.0);
}

TEST(Coherence, EqualOffsetsThatDoNotTouchAreTwoChunks) {
  const CoherenceReport report = Coherence(3, {0, 1, 2}, {0, 0, 0}, {1, 0, 1});
  EXPECT_EQ(report.pairs, 0u);
  EXPECT_EQ(report.share, 0.0);
  EXPECT_EQ(report.chunks, 2u);
}

TEST(Coherence, RowsDoNotWrapAround) {
  const CoherenceReport report = Coherence(2, {0, 1, 2, 3}, {0, 0, 0, 0}, {1, 1, 1, 1});
  EXPECT_EQ(report.coherent_pairs, 2u);
  EXPECT_EQ(report.chunks, 2u);
}

TEST(Coherence, AnotherExemplarIsAnotherChunk) {
  const CoherenceReport report = Coherence(2, {0, 1}, {0, 0}, {1, 1}, {0, 1});
  EXPECT_EQ(report.coherent_pairs, 0u);
  EXPECT_EQ(report.chunks, 2u);
}

TEST(Coherence, ExtremePositionsDoNotOverflow) {
  const CoherenceReport report = Coherence(2, {32767, -32768}, {-32768, 32767}, {1, 1});
  EXPECT_EQ(report.coherent_pairs, 0u);
}

TEST(Coherence, NothingIsNothing) {
  const CoherenceReport report = MeasureCoherence({});
  EXPECT_EQ(report.covered, 0u);
  EXPECT_EQ(report.chunks, 0u);
  EXPECT_EQ(report.mean_chunk_area, 0.0);
}

}  // namespace
}  // namespace scumble
