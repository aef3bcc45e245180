// Files that appear whole or not at all.
#include "core/io/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "scumble/picture.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

std::string Content(const fs::path& path) {
  auto bytes = ReadWholeFile(path);
  EXPECT_TRUE(bytes) << bytes.error().message;
  return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()) : std::string();
}

void ExpectFailure(const Status& status, ErrorKind kind, const std::vector<std::string>& words) {
  ASSERT_FALSE(status);
  EXPECT_EQ(static_cast<int>(status.error().kind), static_cast<int>(kind)) << status.error().message;
  for (const std::string& word : words) {
    EXPECT_NE(status.error().message.find(word), std::string::npos)
        << "'" << word << "' in: " << status.error().message;
  }
}

// A picture that no compression makes small.
Picture Noise(int width, int height) {
  Picture picture(width, height);
  std::uint32_t state = 1;
  for (std::uint16_t& value : picture.rgba)
    value = static_cast<std::uint16_t>((state = state * 1664525u + 1013904223u) >> 16);
  return picture;
}

using Names = std::vector<std::string>;

TEST(AtomicFile, WritesReplacesAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a file, with spaces.txt";
  ASSERT_TRUE(WriteFileAtomically(path, "first"));
  EXPECT_EQ(Content(path), "first");
  ASSERT_TRUE(WriteFileAtomically(path, "second, longer"));
  EXPECT_EQ(Content(path), "second, longer");
  ASSERT_TRUE(WriteFileAtomically(path, ""));
  EXPECT_EQ(Content(path), "");
  const std::string binary("\0\r\n\xff\0", 5);
  ASSERT_TRUE(WriteFileAtomically(path, binary));
  EXPECT_EQ(Content(path), binary);
  EXPECT_EQ(folder.List(), Names{"a file, with spaces.txt"});
}

TEST(AtomicFile, AMissingFolderIsAnErrorAndIsNotMade) {
  const TemporaryFolder folder;
  const Status done = WriteFileAtomically(folder / "a/b.txt", "lost");
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().kind, ErrorKind::kOutput);
  EXPECT_NE(done.error().message.find("there is no folder"), std::string::npos) << done.error().message;
  EXPECT_TRUE(folder.List().empty());
}

TEST(AtomicFile, ARelativeNameLandsInTheWorkingFolder) {
  const TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  const Status status = WriteFileAtomically("plain.txt", "x");
  fs::current_path(before);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(folder.List(), Names{"plain.txt"});
}

TEST(AtomicFile, FollowsLinksAndKeepsThem) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "real");
  ASSERT_TRUE(WriteFileAtomically(folder / "real/target.txt", "old"));
  fs::create_symlink("real/target.txt", folder / "link.txt");
  fs::create_symlink("link.txt", folder / "link to link.txt");
  fs::create_directory_symlink("real", folder / "folder link");
  ASSERT_TRUE(WriteFileAtomically(folder / "link to link.txt", "new"));
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_TRUE(fs::is_symlink(folder / "link to link.txt"));
  EXPECT_FALSE(fs::is_symlink(folder / "real/target.txt"));
  EXPECT_EQ(Content(folder / "real/target.txt"), "new");
  ASSERT_TRUE(WriteFileAtomically(folder / "folder link/other.txt", "o"));
  EXPECT_EQ(Content(folder / "real/other.txt"), "o");
}

TEST(AtomicFile, ALinkToNothingYetIsFollowedToo) {
  const TemporaryFolder folder;
  fs::create_symlink("target.txt", folder / "link.txt");
  ASSERT_TRUE(WriteFileAtomically(folder / "link.txt", "new"));
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(Content(folder / "target.txt"), "new");
}

TEST(AtomicFile, ALinkToItselfIsAnErrorAndStays) {
  const TemporaryFolder folder;
  fs::create_symlink("loop.txt", folder / "loop.txt");
  ExpectFailure(WriteFileAtomically(folder / "loop.txt", "x"), ErrorKind::kOutput, {"loop.txt"});
  EXPECT_TRUE(fs::is_symlink(folder / "loop.txt"));
  EXPECT_EQ(folder.List(), Names{"loop.txt"});
}

TEST(AtomicFile, PermissionsOfTheOldFileStay) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteFileAtomically(folder / "private.txt", "old"));
  fs::permissions(folder / "private.txt", fs::perms::owner_read | fs::perms::owner_write);
  ASSERT_TRUE(WriteFileAtomically(folder / "private.txt", "new"));
  EXPECT_EQ(fs::status(folder / "private.txt").permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(Content(folder / "private.txt"), "new");
}

// As another user, because root may write any file.
TEST(AtomicFile, AWriteProtectedFileStaysAsItIs) {
  const TemporaryFolder folder;
  const fs::path locked = folder / "locked.png";
  std::ofstream(locked) << "approved";
  fs::permissions(folder.path(), fs::perms::all);
  fs::permissions(locked, fs::perms::owner_read | fs::perms::others_read);
  const pid_t child = ::fork();
  if (child == 0) {
    if (::geteuid() == 0 && ::seteuid(65534) != 0) ::_exit(2);
    const Status checked = CheckWritable(locked), written = WriteFileAtomically(locked, "other");
    const bool is_told = !written && written.error().kind == ErrorKind::kOutput &&
                         written.error().message.find("write-protected") != std::string::npos;
    const Status another = WriteFileAtomically(folder / "new.png", "new");
    ::_exit(!checked && is_told && another && IsWriteProtected(locked) ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  std::string text;
  std::ifstream(locked) >> text;
  EXPECT_EQ(text, "approved");
  EXPECT_FALSE(IsWriteProtected(folder / "lost.png"));
}

TEST(AtomicFile, AFolderThatCannotBeWrittenIsNamed) {
  const TemporaryFolder folder;
  const fs::path locked = folder / "locked";
  fs::create_directory(locked);
  fs::permissions(folder.path(), fs::perms::all);
  fs::permissions(locked, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec);
  const pid_t child = ::fork();
  if (child == 0) {
    if (::geteuid() == 0 && ::seteuid(65534) != 0) ::_exit(2);
    const std::string told = "no file can be made in the folder " + locked.string() + " (Permission denied)";
    for (const Status& status : {CheckWritable(locked / "a.png"), WriteFileAtomically(locked / "a.png", "new")}) {
      if (status || status.error().message.find(told) == std::string::npos) ::_exit(1);
    }
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(AtomicFile, AFolderIsNotOverwritten) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "x.png");
  ExpectFailure(WriteFileAtomically(folder / "x.png", "x"), ErrorKind::kOutput, {"x.png", "folder"});
  ExpectFailure(WritePicture(folder / "x.png", Noise(2, 2)), ErrorKind::kOutput, {"x.png", "folder"});
  EXPECT_EQ(folder.List(), Names{"x.png"});
}

TEST(AtomicFile, BelowARegularFileNothingCanBeWritten) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteFileAtomically(folder / "file", "content"));
  ExpectFailure(WriteFileAtomically(folder / "file/x.txt", "x"), ErrorKind::kOutput, {"file/x.txt", "Not a directory"});
  ExpectFailure(WritePicture(folder / "file/deep/x.png", Noise(2, 2)), ErrorKind::kOutput, {"file/deep", "no folder"});
  EXPECT_EQ(Content(folder / "file"), "content");
}

TEST(AtomicFile, TheLongestNameIsStillWritten) {
  const TemporaryFolder folder;
  const std::string name(255, 'n');
  ASSERT_TRUE(WriteFileAtomically(folder / name, "x"));
  EXPECT_EQ(folder.List(), Names{name});
  ExpectFailure(WriteFileAtomically(folder / (name + "n"), "x"), ErrorKind::kOutput, {"File name too long"});
}

TEST(AtomicFile, AFullDeviceIsSaidInWords) {
  ASSERT_TRUE(fs::exists("/dev/full"));
  const TemporaryFolder folder;
  for (const char* name : {"x.png", "x.jpg", "x.tif", "x.exr"}) {
    fs::create_symlink("/dev/full", folder / name);
    ExpectFailure(WritePicture(folder / name, Noise(64, 64)), ErrorKind::kOutput, {name, "No space left"});
    EXPECT_TRUE(fs::is_symlink(folder / name));
  }
  GuideSet guides(3, 3);
  guides.Add(Layer::kCoverage);
  guides.Add(Layer::kNormal);
  ExpectFailure(WriteGuides(folder / "x.exr", guides), ErrorKind::kOutput, {"x.exr", "No space left"});
  EXPECT_EQ(folder.List(), (Names{"x.exr", "x.jpg", "x.png", "x.tif"}));
}

// While it lives, this process can write no file beyond 4 KiB, like on a full disk. A forked child would not do,
// because the picture library's threads do not survive in it.
class SmallFilesOnly {
 public:
  SmallFilesOnly() : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    EXPECT_EQ(::getrlimit(RLIMIT_FSIZE, &old_limit_), 0);
    const rlimit limit{4096, old_limit_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  }
  ~SmallFilesOnly() {
    ::setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  void (*old_handler_)(int);
  rlimit old_limit_{};
};

TEST(AtomicFile, AFullDiskLeavesTheOldFileAndNoTemporary) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteFileAtomically(folder / "old.txt", "old"));
  ASSERT_TRUE(WritePicture(folder / "old.png", Noise(3, 3)));
  const std::string old_png = Content(folder / "old.png");
  std::vector<Status> failures;
  Status small = Ok();
  {
    const SmallFilesOnly limited;
    failures.push_back(WriteFileAtomically(folder / "old.txt", std::string(20000, 'b')));
    for (const char* name : {"old.png", "fresh.exr", "fresh.tif"}) {
      failures.push_back(WritePicture(folder / name, Noise(64, 64)));
    }
    small = WriteFileAtomically(folder / "small.txt", "fits");
  }
  const char* names[] = {"old.txt", "old.png", "fresh.exr", "fresh.tif"};
  for (std::size_t i = 0; i < failures.size(); ++i) {
    ExpectFailure(failures[i], ErrorKind::kOutput, {names[i], std::strerror(EFBIG)});
  }
  EXPECT_TRUE(small);
  EXPECT_EQ(Content(folder / "old.txt"), "old");
  EXPECT_EQ(Content(folder / "old.png"), old_png);
  EXPECT_EQ(folder.List(), (Names{"old.png", "old.txt", "small.txt"}));
}

TEST(ReadWholeFile, FailuresNameTheFile) {
  const TemporaryFolder folder;
  const auto missing = ReadWholeFile(folder / "missing.txt");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::kInput);
  EXPECT_NE(missing.error().message.find("missing.txt"), std::string::npos);
  EXPECT_NE(missing.error().message.find("no such file"), std::string::npos);
  const auto a_folder = ReadWholeFile(folder.path());
  ASSERT_FALSE(a_folder);
  EXPECT_NE(a_folder.error().message.find("folder"), std::string::npos);
}

TEST(ReadWholeFile, TheLimitIsInclusive) {
  const TemporaryFolder folder;
  for (const std::size_t size :
       {std::size_t(0), std::size_t(1), std::size_t(65536), std::size_t(65537), std::size_t(200000)}) {
    const std::string text(size, 't');
    ASSERT_TRUE(WriteFileAtomically(folder / "f", text));
    EXPECT_EQ(Content(folder / "f").size(), size);
    EXPECT_TRUE(ReadWholeFile(folder / "f", size));
    if (size == 0) continue;
    const auto over = ReadWholeFile(folder / "f", size - 1);
    ASSERT_FALSE(over);
    EXPECT_NE(over.error().message.find("larger than " + std::to_string(size - 1)), std::string::npos);
  }
}

}  // namespace
}  // namespace scumble
