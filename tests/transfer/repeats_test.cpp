// The bench's summary of its times.
#include "bench/performance/repeats.h"

#include <gtest/gtest.h>

#include <string>

namespace scumble::bench {
namespace {

Times Taken(const std::vector<double>& wall_ms, double thread_share) {
  Times times;
  for (const double ms : wall_ms) times.Add({ms, ms * thread_share, ms});
  return times;
}

TEST(Repeats, QuartilesLieBetweenTheValues) {
  const Spread spread = SpreadOf({4.0, 1.0, 2.0, 3.0});
  EXPECT_DOUBLE_EQ(spread.median, 2.5);
  EXPECT_DOUBLE_EQ(spread.low, 1.75);
  EXPECT_DOUBLE_EQ(spread.high, 3.25);
  EXPECT_DOUBLE_EQ(spread.least, 1.0);
  EXPECT_EQ(spread.count, 4);
  EXPECT_DOUBLE_EQ(SpreadOf({7.0}).high, 7.0);
  EXPECT_EQ(SpreadOf({}).count, 0);
}

// A machine that is slow in one round slows both: the ratio does not feel it, the times do.
TEST(Repeats, RatiosAreTakenWithinARound) {
  const Times slow = Taken({20.0, 200.0, 24.0}, 0.5), quick = Taken({10.0, 100.0, 12.0}, 1.0);
  EXPECT_DOUBLE_EQ(Ratio(slow, quick, Clock::kWall).median, 2.0);
  EXPECT_DOUBLE_EQ(Ratio(slow, quick, Clock::kWall).high, 2.0);
  EXPECT_DOUBLE_EQ(Ratio(slow, quick, Clock::kThread, 3.0).median, 3.0);
  EXPECT_DOUBLE_EQ(slow.Milliseconds(Clock::kWall).median, 24.0);
  EXPECT_DOUBLE_EQ(slow.Waiting(), 2.0);
}

TEST(Repeats, ContestantsTakeTurns) {
  std::string order;
  const std::function<void()> contestants[] = {[&] { order += 'a'; }, [&] { order += 'b'; }};
  RepeatOptions options;
  options.least_rounds = options.most_rounds = 3;
  options.most_runs = 2;
  const std::vector<Times> times = TakeTurns(contestants, options);
  EXPECT_EQ(order,
            "ab"
            "aabb"
            "aabb"
            "aabb");  // once unmeasured, then in rounds
  ASSERT_EQ(times.size(), 2u);
  EXPECT_EQ(times[0].rounds(), 3);
  EXPECT_GE(times[1].Of(2, Clock::kWall), 0.0);
}

}  // namespace
}  // namespace scumble::bench
