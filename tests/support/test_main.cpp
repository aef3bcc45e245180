// The main() of every test program. It fails where no case was selected. With SCUMBLE_CASE_SECONDS set it names the
// cases that take longer, and fails. XML and JSON reports have each case's processor time as `processor_seconds`.
//
// A case takes longer if its processor time and its wall time both exceed the limit. On a loaded machine the wall time
// grows; on one of many cores the processor time does, because idle workers spin for a while before they sleep.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

double Seconds(const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); }

// Of all threads, and of the programs that have ended.
double ProcessorSeconds() {
  double seconds = 0.0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    ::getrusage(who, &usage);
    seconds += Seconds(usage.ru_utime) + Seconds(usage.ru_stime);
  }
  return seconds;
}

class CaseTimer : public testing::EmptyTestEventListener {
 public:
  bool AnyTooSlow() const { return any_too_slow_; }

 private:
  using Clock = std::chrono::steady_clock;

  void OnTestStart(const testing::TestInfo&) override {
    start_ = ProcessorSeconds();
    wall_start_ = Clock::now();
  }
  void OnTestEnd(const testing::TestInfo& test) override {
    const double seconds = ProcessorSeconds() - start_;
    const double wall_seconds = std::chrono::duration<double>(Clock::now() - wall_start_).count();
    testing::Test::RecordProperty("processor_seconds", std::to_string(seconds));
    const double lesser = std::min(seconds, wall_seconds);
    if (limit_ <= 0.0 || lesser <= limit_) return;
    any_too_slow_ = true;
    std::printf("%s.%s took %.2f s, its tier allows %.2f s: shorten it or name it in tests/slow_cases.txt\n",
                test.test_suite_name(), test.name(), lesser, limit_);
  }

  double limit_ = std::getenv("SCUMBLE_CASE_SECONDS") ? std::atof(std::getenv("SCUMBLE_CASE_SECONDS")) : 0.0;
  double start_ = 0.0;
  Clock::time_point wall_start_;
  bool any_too_slow_ = false;
};

}  // namespace

int main(int count, char** arguments) {
  testing::InitGoogleMock(&count, arguments);
  auto* const timer = new CaseTimer;  // GoogleTest owns it
  testing::UnitTest::GetInstance()->listeners().Append(timer);
  const int result = RUN_ALL_TESTS();
  if (testing::GTEST_FLAG(list_tests)) return result;
  if (testing::UnitTest::GetInstance()->test_to_run_count() == 0) {
    std::printf("No case has a name that --gtest_filter selects.\n");
    return 1;
  }
  return timer->AnyTooSlow() ? 1 : result;
}
