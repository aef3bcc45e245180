// Frame rates as text and as numbers.
#include "pipeline/frame_rate.h"

#include <gtest/gtest.h>

#include <string>

namespace scumble {
namespace {

TEST(FrameRate, ANumberIsTheRateThatItsTextIs) {
  for (const int rate : {24, 30, 48, 60, 100}) {
    const auto television = ParseFrameRate(std::to_string(1000 * rate) + "/1001");
    ASSERT_TRUE(television);
    EXPECT_EQ(NearestFrameRate(1000.0 * rate / 1001.0), *television);
    EXPECT_EQ(NearestFrameRate(static_cast<float>(1000.0 * rate / 1001.0)), *television);
    EXPECT_EQ(FrameRateToText(*television), std::to_string(1000 * rate) + "/1001");
    EXPECT_EQ(NearestFrameRate(rate), *ParseFrameRate(std::to_string(rate)));
  }
  for (const char* const text :
       {"0.001", "0.5", "8", "12.5", "15", "23.976", "29.97", "59.94", "119.88", "1000", "1e5"}) {
    EXPECT_EQ(NearestFrameRate(std::stod(text)), *ParseFrameRate(text)) << text;
  }
  EXPECT_EQ(FrameRateToText(NearestFrameRate(120000.0 / 1001.0)), "119.88") << "no text has 120000";
  EXPECT_EQ(NearestFrameRate(1.0 / 3.0), *ParseFrameRate("0.333"));
}

}  // namespace
}  // namespace scumble
