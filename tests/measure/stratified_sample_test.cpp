// Stratified samples: the drawn places, and mean and standard error by the formula of the sampling.
#include "measure/mosaic/stratified_sample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace scumble::internal {
namespace {

TEST(StratifiedSample, IsTwoPlacesOfEachPiece) {
  for (const std::size_t count : {5u, 64u, 1001u}) {
    for (const std::size_t samples : {1u, 2u, 3u, 4u}) {
      const StratifiedSample sample = ChooseStratified(count, samples, 7);
      ASSERT_EQ(sample.strata.size(), (samples + 1) / 2);
      ASSERT_EQ(sample.places.size(), 2 * sample.strata.size());
      EXPECT_EQ(std::accumulate(sample.strata.begin(), sample.strata.end(), std::size_t(0)), count);
      std::size_t begin = 0;
      for (std::size_t s = 0; s < sample.strata.size(); begin += sample.strata[s++]) {
        EXPECT_NE(sample.places[2 * s], sample.places[2 * s + 1]);
        for (const std::size_t i : {2 * s, 2 * s + 1}) {
          EXPECT_GE(sample.places[i], begin);
          EXPECT_LT(sample.places[i], begin + sample.strata[s]);
        }
      }
    }
  }
}

TEST(StratifiedSample, OfAsManyAsThereAreIsAllOfThem) {
  for (const std::size_t samples : {0u, 9u, 10u, 1000u}) {
    const StratifiedSample sample = ChooseStratified(10, samples, 7);
    EXPECT_TRUE(sample.strata.empty());
    std::vector<double> values(sample.places.begin(), sample.places.end());
    ASSERT_EQ(values.size(), 10u);
    EXPECT_EQ(MeanOf(sample, values).mean, 4.5);
    EXPECT_EQ(MeanOf(sample, values).standard_error, 0.0);
  }
  EXPECT_EQ(MeanOf(ChooseStratified(0, 4, 7), {}).mean, 0.0);
}

// By hand: strata of 4 and 4 with values 0, 2 and 10, 14 drawn. Mean (1 + 12) / 2; variance of a stratum's mean (1 −
// 2/4) (a − b)² / 4 = 0.5 and 2, of their mean a quarter of the sum.
TEST(StratifiedSample, ByHand) {
  const Estimate estimate = MeanOf({{0, 1, 4, 5}, {4, 4}}, std::vector<double>{0, 2, 10, 14});
  EXPECT_EQ(estimate.mean, 6.5);
  EXPECT_DOUBLE_EQ(estimate.standard_error, std::sqrt((0.5 + 2.0) / 4.0));
}

// Squares of 0 … 99 in 10 strata. Over many seeds the mean of the means is the true one, and the mean of the estimated
// variances the variance of the means: both within 5 of their own standard errors.
TEST(StratifiedSample, IsUnbiased) {
  double truth = 0.0;
  for (int i = 0; i < 100; ++i) truth += i * i / 100.0;
  constexpr int kSeeds = 20000;
  double sum = 0.0, squares = 0.0, fourths = 0.0, estimated = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const StratifiedSample sample = ChooseStratified(100, 20, static_cast<std::uint64_t>(seed));
    std::vector<double> values;
    for (const std::size_t place : sample.places) values.push_back(double(place) * double(place));
    const Estimate estimate = MeanOf(sample, values);
    const double off = estimate.mean - truth;
    sum += off, squares += off * off, fourths += off * off * off * off;
    estimated += estimate.standard_error * estimate.standard_error;
  }
  const double variance = squares / kSeeds;
  EXPECT_LT(std::fabs(sum / kSeeds), 5 * std::sqrt(variance / kSeeds));
  // Twice: the estimated variances spread no more than the squares themselves.
  EXPECT_LT(std::fabs(estimated / kSeeds - variance),
            5 * std::sqrt(2 * (fourths / kSeeds - variance * variance) / kSeeds));
}

}  // namespace
}  // namespace scumble::internal
