// The main() of every test program. It fails where no case was selected, and with SCUMBLE_CASE_SECONDS set where a case
// takes more processor time than that. XML and JSON reports have each case's processor time as `processor_seconds`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

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
  bool exceeded() const { return exceeded_; }

 private:
  void OnTestStart(const testing::TestInfo&) override { start_ = ProcessorSeconds(); }
  void OnTestEnd(const testing::TestInfo& test) override {
    const double seconds = ProcessorSeconds() - start_;
    testing::Test::RecordProperty("processor_seconds", std::to_string(seconds));
    if (limit_ <= 0.0 || seconds <= limit_) return;
    exceeded_ = true;
    std::printf("%s.%s took %.2f s of processor time, its tier allows %.2f s: name it in tests/slow_cases.txt\n",
                test.test_suite_name(), test.name(), seconds, limit_);
  }

  double limit_ = std::getenv("SCUMBLE_CASE_SECONDS") ? std::atof(std::getenv("SCUMBLE_CASE_SECONDS")) : 0.0;
  double start_ = 0.0;
  bool exceeded_ = false;
};

}  // namespace

int main(int count, char** arguments) {
  testing::InitGoogleMock(&count, arguments);
  auto* const timer = new CaseTimer;  // GoogleTest's from here on
  testing::UnitTest::GetInstance()->listeners().Append(timer);
  const int result = RUN_ALL_TESTS();
  if (testing::GTEST_FLAG(list_tests)) return result;
  if (testing::UnitTest::GetInstance()->test_to_run_count() == 0) {
    std::printf("No case has a name that --gtest_filter selects.\n");
    return 1;
  }
  return timer->exceeded() ? 1 : result;
}
