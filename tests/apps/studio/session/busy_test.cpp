#include "apps/studio/session/busy.h"

#include <gtest/gtest.h>

namespace scumble {
namespace {

TEST(Busy, EndsWithItsWork) {
  EventHub events;
  Progress progress = BusyReports(events, std::chrono::milliseconds(0))("stylize");
  EXPECT_TRUE(progress(0.25));
  Progress copy = progress;
  progress = nullptr;
  const auto told = events.After(0, std::chrono::milliseconds(0));
  ASSERT_TRUE(told);
  EXPECT_EQ(told->name, "busy");
  EXPECT_EQ(told->data, R"({"label":"stylize","share":0.25})");
  EXPECT_EQ(events.last_id(), told->id) << "it has not ended yet";
  copy = nullptr;
  const auto ended = events.After(told->id, std::chrono::milliseconds(0));
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->name, "busy");
  EXPECT_EQ(ended->data, "null");
}

TEST(Busy, ShortWorkIsNotTold) {
  EventHub events;
  BusyReports(events)("stylize")(0.5);
  EXPECT_EQ(events.last_id(), 0u);
}

}  // namespace
}  // namespace scumble
