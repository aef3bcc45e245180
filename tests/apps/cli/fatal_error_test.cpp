// Uncaught exceptions: one sentence, exit code 6, and no temporary file of an output left.
#include "apps/cli/app/fatal_error.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>

#include "core/io/pending_temporaries.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::ResultOf;
using testing::StartsWith;

constexpr int kInternal = 6;  // DESIGN: internal error

int Lines(const std::string& text) { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }

class FatalError : public testing::Test {
 protected:
  FatalError() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }

  // In the process of a death test: an output is half written when a second thread ends as it should not.
  [[noreturn]] void EndOnAnotherThread(const std::function<void()>& end) {
    ReportUncaughtExceptions();
    const internal::PendingTemporary file(folder_ / "p.png");
    if (file.descriptor() < 0 || std::filesystem::is_empty(folder_.path())) ::_exit(99);
    std::thread([&] { end(); }).join();
    ::_exit(98);
  }
  void ExpectWords(const std::function<void()>& end, const std::string& start, const std::string& words) {
    EXPECT_EXIT(EndOnAnotherThread(end), testing::ExitedWithCode(kInternal),
                AllOf(StartsWith("scumble: " + start + ": "), HasSubstr(words), EndsWith("\n"), ResultOf(Lines, 1)));
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path())) << words;
  }

  const TemporaryFolder folder_;
};
using FatalErrorDeathTest = FatalError;

TEST_F(FatalErrorDeathTest, OfMemory) {
  ExpectWords([] { throw std::bad_alloc(); }, "error", "out of memory");
}

TEST_F(FatalErrorDeathTest, OfThreads) {
  ExpectWords([] { throw std::system_error(EAGAIN, std::generic_category()); }, "error", "no more threads");
  ExpectWords([] { throw std::runtime_error("pthread_create has failed"); }, "error", "no more threads");
}

TEST_F(FatalErrorDeathTest, OfAnythingElse) {
  ExpectWords([] { throw std::runtime_error("a broken promise"); }, "internal error",
              "a broken promise; please report");
  ExpectWords([] { throw std::system_error(EIO, std::generic_category()); }, "internal error", "please report");
  ExpectWords([] { throw 7; }, "internal error", "of an unknown kind; please report");
}

TEST_F(FatalErrorDeathTest, OfNothing) {
  ExpectWords([] { std::terminate(); }, "error", "a library gave up");
}

}  // namespace
}  // namespace scumble
