#include "core/io/stale_temporaries.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <mutex>
#include <set>
#include <system_error>

namespace scumble::internal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNoMark = "00000000";
constexpr std::size_t kMarkLength = 8, kRandomLength = 6;
constexpr std::time_t kDay = 24 * 60 * 60;

// The mark in a name of the form of temporary files; empty where it has another form.
std::string MarkIn(const std::string& name) {
  constexpr std::size_t kEnd = kMarkLength + 1 + kRandomLength + kTemporarySuffix.size();
  if (name.size() < kEnd + 2 || name.front() != '.' || !name.ends_with(kTemporarySuffix)) return "";
  const std::size_t mark = name.size() - kEnd;
  const bool has_form = name[mark - 1] == '.' && name[mark + kMarkLength] == '-';
  return has_form ? name.substr(mark, kMarkLength) : "";
}

constexpr std::string_view kFolderPrefix = "scumble-";

bool IsFolderOfOurs(int file, struct stat& found) {
  return ::fstat(file, &found) == 0 && S_ISDIR(found.st_mode) && found.st_uid == ::geteuid();
}

int OpenFolder(const fs::path& path) { return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_DIRECTORY); }

void RemoveFolderIfLeft(const fs::path& path, bool lock_is_seen) {
  const int file = OpenFolder(path);
  if (file < 0) return;
  struct stat found;
  const bool is_ours = IsFolderOfOurs(file, found);
  const bool is_old = is_ours && std::time(nullptr) - found.st_mtime > kDay;
  std::error_code failed;
  if (is_ours && (lock_is_seen || is_old) && ::flock(file, LOCK_EX | LOCK_NB) == 0) fs::remove_all(path, failed);
  ::close(file);
}

void RemoveStaleFolders(const fs::path& parent) {
  std::error_code failed;
  for (fs::directory_iterator entry(parent, failed); !failed && entry != fs::directory_iterator();
       entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    const std::size_t stroke = kFolderPrefix.size() + kMarkLength;
    if (name.size() != stroke + 1 + kRandomLength || !name.starts_with(kFolderPrefix) || name[stroke] != '-') continue;
    const std::string mark = name.substr(kFolderPrefix.size(), kMarkLength);
    RemoveFolderIfLeft(entry->path(), mark == KernelMark() && mark != kNoMark);
  }
}

void RemoveIfLeft(const fs::path& path, bool lock_is_seen) {
  // Does not follow links or wait for a pipe, because a name proves nothing.
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return;
  struct stat found;
  const bool is_plain = ::fstat(file, &found) == 0 && S_ISREG(found.st_mode);
  const bool is_old = is_plain && std::time(nullptr) - found.st_mtime > kDay;
  // The lock is held until the file is gone. A writer that has just created it under this name finds out when it takes
  // the lock.
  if (is_plain && (lock_is_seen || is_old) && ::flock(file, LOCK_EX | LOCK_NB) == 0) ::unlink(path.c_str());
  ::close(file);
}

}  // namespace

const std::string& KernelMark() {
  static const std::string kMark = [] {
    std::string id;
    std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
    return id.size() >= kMarkLength ? id.substr(0, kMarkLength) : std::string(kNoMark);
  }();
  return kMark;
}

void RemoveStaleTemporaries(const fs::path& folder) {
  std::error_code failed;
  fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, failed);
  for (; !failed && entry != fs::directory_iterator(); entry.increment(failed)) {
    const std::string mark = MarkIn(entry->path().filename().string());
    if (!mark.empty()) RemoveIfLeft(entry->path(), mark == KernelMark() && mark != kNoMark);
  }
}

void RemoveStaleTemporariesOnce(const fs::path& folder) {
  static std::mutex mutex;
  static std::set<fs::path>& done = *new std::set<fs::path>;
  {
    const std::lock_guard lock(mutex);
    if (!done.insert(folder).second) return;
  }
  RemoveStaleTemporaries(folder);
}

LockedFolder MakeLockedFolder(const fs::path& parent) {
  RemoveStaleFolders(parent);
  for (int tries = 0; tries < 10; ++tries) {
    std::string name = (parent / (std::string(kFolderPrefix) + KernelMark() + "-XXXXXX")).string();
    if (!::mkdtemp(name.data())) return {{}, -1, errno};
    const int lock = OpenFolder(name);
    if (lock < 0) return {name, -1};
    // Another run may have taken it for a stale one, until it was locked: then it is gone, or soon will be.
    struct stat held, there;
    const bool is_held =
        ::flock(lock, LOCK_EX) != 0 ||
        (::fstat(lock, &held) == 0 && ::stat(name.c_str(), &there) == 0 && held.st_ino == there.st_ino);
    if (is_held) return {name, lock};
    ::close(lock);
  }
  return {{}, -1, EBUSY};
}

}  // namespace scumble::internal
