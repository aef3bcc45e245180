// Outputs are checked before the work. Those of a range that is resumed may be kept: they need not be writable.
#include "pipeline/run_inputs.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "pipeline/sequence.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

// In a child process, as a user who may not write into the folder. Root may write anywhere.
TEST(RunInputs, AResumedRangeWritesOnlyWhatItDoesNotKeep) {
  const TemporaryFolder folder;
  const fs::path locked = folder / "locked";
  fs::create_directory(locked);
  const std::vector<std::string> outputs = {(locked / "p.1.png").string(), (locked / "p.2.png").string()};
  for (const std::string& output : outputs) {
    std::ofstream(output) << "painted";
    fs::permissions(output, fs::perms::all);
  }
  fs::permissions(folder.path(), fs::perms::all);
  fs::permissions(locked, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec);
  const pid_t child = ::fork();
  if (child == 0) {
    if (::geteuid() == 0 && ::seteuid(65534) != 0) ::_exit(2);
    const bool anew = RunInputs().CheckOutputs(outputs, "-o", false).ok();
    const bool resumed = RunInputs().CheckOutputs(outputs, "-o", true).ok();
    Sequence sequence{{1, 2}, *FrameName::Parse((locked / "p.#.png").string()), true};
    bool begun = false;
    SequenceWork work;
    work.check = [&](int frame, const std::string&) { return frame == 1 ? Ok() : Status(InputError("torn")); };
    work.begin = [&](std::span<const int>, const Progress&, std::optional<int>&) {
      begun = true;
      return Ok();
    };
    const auto totals = RunSequence(sequence, work, {}, RunContext(), {});
    const bool told = totals && totals->kept == 1 && totals->ended_by &&
                      totals->ended_by->message.find("p.2.png: no file can be made in the folder") != std::string::npos;
    ::_exit(!anew && resumed && told && !begun ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

// A full disk, say, ends a sequence, and a farm reads at which frame.
TEST(RunInputs, TheFrameThatEndsASequenceIsNamed) {
  const TemporaryFolder folder;
  for (const bool is_cancelled : {false, true}) {
    const Sequence sequence{{1, 2, 3}, *FrameName::Parse((folder / "p.#.png").string()), false};
    std::vector<int> made, failed;
    SequenceWork work;
    work.begin = [](std::span<const int>, const Progress&, std::optional<int>&) { return Ok(); };
    work.make = [&](int frame, const std::string& output, const Progress&) -> Expected<FrameWrite> {
      return FrameWrite([=]() -> Expected<FrameReport> {
        if (frame == 2) return Error{is_cancelled ? ErrorKind::kCancelled : ErrorKind::kOutput, output + ": full"};
        return FrameReport();
      });
    };
    SequenceListener listener;
    listener.made = [&](int frame, const std::string&, const FrameReport&) { made.push_back(frame); };
    listener.failed = [&](int frame, const std::string&, const std::string&) { failed.push_back(frame); };
    const auto totals = RunSequence(sequence, work, listener, RunContext(), {});
    ASSERT_TRUE(totals);
    EXPECT_EQ(made, std::vector{1});
    EXPECT_EQ(failed, is_cancelled ? std::vector<int>() : std::vector{2});
    EXPECT_EQ(totals->failed, failed);
    ASSERT_TRUE(totals->ended_by);
    EXPECT_NE(StatusOf(*totals).error().message.find("frame 2"), std::string::npos);
  }
}

}  // namespace
}  // namespace scumble
