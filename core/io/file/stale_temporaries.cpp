#include "core/io/file/stale_temporaries.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

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

}  // namespace scumble::internal
