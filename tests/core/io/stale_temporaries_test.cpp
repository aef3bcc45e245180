// Temporary files of killed runs: which are removed, and which are not.
#include "core/io/stale_temporaries.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/io/atomic_file.h"
#include "core/io/pending_temporaries.h"
#include "tests/support/temporary_folder.h"

namespace scumble::internal {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> Names(const TemporaryFolder& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder.path())) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

void WriteText(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

// The files of a process that ends in the middle of a write, without a chance to clean up.
void LeaveOne(const fs::path& target) {
  const pid_t child = ::fork();
  if (child == 0) {
    const PendingTemporary file(target);
    if (::write(file.descriptor(), "half", 4) != 4) ::_exit(1);
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
}

void MakeOld(const fs::path& path, std::chrono::hours age) {
  fs::last_write_time(path, fs::file_time_type::clock::now() - age);
}

TEST(LeftoverFiles, AreThoseOfProcessesThatAreNoMore) {
  const TemporaryFolder folder;
  RemoveStaleTemporariesOnce(folder.path());  // or the second process would take away what the first one left
  LeaveOne(folder / "a picture.png");
  LeaveOne(folder / std::string(250, 'n'));
  ASSERT_EQ(Names(folder).size(), 2u);
  for (const std::string& name : Names(folder)) {
    EXPECT_TRUE(name.starts_with(".") && name.ends_with(kTemporarySuffix)) << name;
    EXPECT_NE(name.find("." + KernelMark() + "-"), std::string::npos) << name;
  }
  const PendingTemporary alive(folder / "mine.png");
  ASSERT_GE(alive.descriptor(), 0);
  ::close(alive.descriptor());  // as writers do before it gets its name: it stays locked
  RemoveStaleTemporaries(folder.path());
  ASSERT_EQ(Names(folder).size(), 1u) << "what is being written stays";
  EXPECT_TRUE(Names(folder).front().starts_with(".mine.png."));
  EXPECT_EQ(const_cast<PendingTemporary&>(alive).Finish(folder / "mine.png"), 0);
  EXPECT_EQ(Names(folder), std::vector<std::string>{"mine.png"});
}

// With one descriptor left the file can be made and cannot be locked: another run would take it for a leftover.
TEST(LeftoverFiles, AFolderOfAKilledProcessIsRemoved) {
  const TemporaryFolder folder;
  const LockedFolder used = MakeLockedFolder(folder.path());
  WriteText(used.path / "scene.glb", "x");
  fs::create_directory(folder / "scumble-abcdef");
  const pid_t child = ::fork();
  if (child == 0) {
    WriteText(MakeLockedFolder(folder.path()).path / "scene.glb", "x");
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(Names(folder).size(), 3u);
  const LockedFolder next = MakeLockedFolder(folder.path());
  const std::vector<std::string> names = Names(folder);
  EXPECT_EQ(names.size(), 3u) << "the killed one's is gone";
  EXPECT_TRUE(fs::exists(used.path / "scene.glb") && fs::exists(next.path) && fs::exists(folder / "scumble-abcdef"));
  ::close(used.lock);
  ::close(next.lock);
}

TEST(LeftoverFiles, AFileThatCannotBeLockedIsNotWritten) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP()
      << "UndefinedBehaviorSanitizer looks at an object's type through a pipe, and here is no descriptor for one";
#endif
  const TemporaryFolder folder;
  RemoveStaleTemporariesOnce(folder.path());
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const int next = ::dup(0);
  ASSERT_GE(next, 0);
  ::close(next);  // the lowest that is free
  const auto descriptor_with = [&](int descriptors) {
    const rlimit limit{static_cast<rlim_t>(next + descriptors), before.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);
    const PendingTemporary file(folder / "p.png");
    const int reason = file.descriptor() < 0 ? errno : 0;
    if (file.descriptor() >= 0) ::close(file.descriptor());
    EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
    return reason;
  };
  EXPECT_EQ(descriptor_with(1), EMFILE);
  EXPECT_EQ(Names(folder), std::vector<std::string>{}) << "and nothing is left";
  EXPECT_EQ(descriptor_with(0), EMFILE);
  EXPECT_EQ(descriptor_with(2), 0);
}

TEST(LeftoverFiles, OfAnotherMachineStayForADay) {
  const TemporaryFolder folder;
  // Boot ids are random hexadecimal digits: none is spelt so.
  const std::string fresh = ".a.png.another1-abcdef.scumble-tmp", old = ".b.png.another1-abcdef.scumble-tmp",
                    locked = ".c.png.another1-abcdef.scumble-tmp";
  for (const std::string& name : {fresh, old}) WriteText(folder / name, "half");
  MakeOld(folder / fresh, std::chrono::hours(23));
  MakeOld(folder / old, std::chrono::hours(25));
  PendingTemporary writer(folder / "c.png");
  ::close(writer.descriptor());
  for (const std::string& name : Names(folder)) {
    if (name.starts_with(".c.png")) fs::rename(folder / name, folder / locked);
  }
  MakeOld(folder / locked, std::chrono::hours(25));
  RemoveStaleTemporaries(folder.path());
  EXPECT_EQ(Names(folder), (std::vector<std::string>{fresh, locked}));
}

TEST(LeftoverFiles, AreNotWhatOnlyLooksAlike) {
  const TemporaryFolder folder;
  const std::string mark = KernelMark();
  WriteText(folder / "kept", "kept");
  const std::vector<std::string> others = {"a.png." + mark + "-abcdef.scumble-tmp",  // not hidden
                                           ".a.png." + mark + "abcdef.scumble-tmp",  // no stroke
                                           ".a.png." + mark + "-abcdef.tmp",         // another ending
                                           ".scumble-tmp", "." + mark + "-abcdef.scumble-tmp"};
  for (const std::string& name : others) WriteText(folder / name, "somebody's");
  const auto like = [&](const std::string& name) { return folder / ("." + name + "." + mark + "-abcdef.scumble-tmp"); };
  fs::create_directory(like("folder"));
  fs::create_symlink("kept", like("link"));
  ASSERT_EQ(::mkfifo(like("pipe").c_str(), 0600), 0);
  const std::vector<std::string> before = Names(folder);
  for (const std::string& name : others) MakeOld(folder / name, std::chrono::hours(1000));
  RemoveStaleTemporaries(folder.path());
  EXPECT_EQ(Names(folder), before);
  RemoveStaleTemporaries(folder / "there is none");
}

TEST(LeftoverFiles, AreTakenAwayByTheFirstWriteToTheirFolder) {
  const TemporaryFolder folder;
  LeaveOne(folder / "another.png");
  ASSERT_TRUE(WriteFileAtomically(folder / "new.txt", "new"));
  EXPECT_EQ(Names(folder), std::vector<std::string>{"new.txt"});
  LeaveOne(folder / "another.png");
  ASSERT_TRUE(WriteFileAtomically(folder / "new.txt", "newer"));
  EXPECT_EQ(Names(folder).size(), 2u) << "a run looks once: folders of sequences are large";
}

}  // namespace
}  // namespace scumble::internal
