#include "measure/tradeoff/pareto.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/image/hash.h"

namespace scumble {
namespace {

using Places = std::vector<std::size_t>;

Places Front(const std::vector<TradePoint>& points) { return ParetoFront(points); }

TEST(Pareto, KeepsWhatNothingBeatsByRisingTime) {
  //      beaten by none   slower and worse   none      slower, as good   as fast, worse
  EXPECT_EQ(Front({{4, 1}, {5, 3}, {1, 4}, {2, 4}, {4, 2}}), (Places{2, 0}));
  EXPECT_EQ(Front({}), Places{});
  EXPECT_EQ(Front({{7, 7}}), Places{0});
}

TEST(Pareto, EqualPointsAreAllOnTheFrontInTheirOrder) {
  EXPECT_EQ(Front({{2, 5}, {1, 9}, {2, 5}, {3, 5}, {2, 5}}), (Places{1, 0, 2, 4}));
}

TEST(Pareto, WhatWasNotMeasuredIsNowhereAndInfinitiesAreNumbers) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Front({{nan, 0}, {0, nan}, {1, 1}}), Places{2});
  EXPECT_EQ(Front({{inf, 0}, {1, inf}, {2, inf}}), (Places{1, 0}));
}

// The definition, over all pairs, on a grid coarse enough for many ties.
TEST(Pareto, IsTheDefinitionOnChance) {
  for (int run = 0; run < 50; ++run) {
    std::vector<TradePoint> points;
    for (int i = 0; i < 40; ++i) points.push_back({double(Hash(run, i, 0) % 12), double(Hash(run, i, 1) % 12)});
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < points.size(); ++i) {
      bool is_beaten = false;
      for (const TradePoint& other : points) {
        is_beaten |= other.time <= points[i].time && other.error <= points[i].error &&
                     (other.time < points[i].time || other.error < points[i].error);
      }
      if (!is_beaten) expected.push_back(i);
    }
    std::vector<std::size_t> front = Front(points);
    for (std::size_t k = 1; k < front.size(); ++k) EXPECT_LE(points[front[k - 1]].time, points[front[k]].time);
    std::sort(front.begin(), front.end());
    EXPECT_EQ(front, expected) << run;
  }
}

}  // namespace
}  // namespace scumble
