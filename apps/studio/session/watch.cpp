#include "apps/studio/session/watch.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "core/image/hash.h"
#include "core/io/atomic_file.h"
#include "pipeline/file_stamp.h"

namespace scumble {
namespace {

constexpr int kLookEveryMs = 500;
constexpr int kRestMs = 5;  // closed and moved files are whole; several that are saved together are taken together
constexpr int kLongestUnrestMs = 1000;  // a file that is written all the time is looked at this often

// Of the bytes, or of the names in a folder; 0 where they cannot be read.
std::uint64_t HashOfFile(const std::string& file) {
  std::error_code failed;
  if (std::filesystem::is_directory(file, failed)) {
    std::set<std::string> names;
    std::filesystem::directory_iterator at(file, failed);
    for (; !failed && at != std::filesystem::directory_iterator(); at.increment(failed)) {
      names.insert(at->path().string());
    }
    return HashText(fmt::format("{}", fmt::join(names, "\n"))) | 1;
  }
  const auto bytes = ReadWholeFile(file);
  if (!bytes) return 0;
  return HashText({reinterpret_cast<const char*>(bytes->data()), bytes->size()}) | 1;
}

}  // namespace

FileWatch::FileWatch(std::function<void(const std::vector<std::string>&)> changed) : changed_(std::move(changed)) {
  inotify_ = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);  // without it, looking is enough
  wake_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  thread_ = std::thread([this] { Run(); });
}

FileWatch::~FileWatch() {
  Stop();
  if (inotify_ >= 0) ::close(inotify_);
  if (wake_ >= 0) ::close(wake_);
}

void FileWatch::Stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(wake_, &one, sizeof one);
  thread_.join();
}

FileWatch::Seen FileWatch::LookAt(const std::string& file) {
  std::error_code failed;
  return {StampOf(file), HashOfFile(file), std::filesystem::is_directory(file, failed)};
}

void FileWatch::Watch(const std::vector<std::string>& files, std::chrono::system_clock::time_point read) {
  std::map<std::string, Seen> next;
  {
    const std::lock_guard lock(mutex_);
    for (const std::string& file : files) {
      const auto known = seen_.find(file);
      if (known != seen_.end()) next[file] = known->second;
    }
  }
  for (const std::string& file : files) {
    if (next.count(file)) continue;
    Seen now = LookAt(file);
    if (HasChangedSince(file, read)) now.stamp.clear(), now.hash = 0;
    next[file] = now;
  }
  const std::lock_guard lock(mutex_);
  seen_ = std::move(next);
  folders_are_stale_ = true;
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(wake_, &one, sizeof one);
}

bool FileWatch::SeesChanges() const {
  const std::lock_guard lock(mutex_);
  for (const auto& [file, seen] : seen_) {
    if (StampOf(file) != seen.stamp) return true;
  }
  return false;
}

// A folder that vanished is watched again once it is back.
void FileWatch::WatchFolders() {
  if (inotify_ < 0) return;
  std::set<std::string> wanted;
  for (const auto& [file, seen] : seen_) {
    const std::string folder = std::filesystem::path(file).parent_path().string();
    wanted.insert(folder.empty() ? "." : folder);
    if (seen.is_folder) wanted.insert(file);
  }
  for (auto it = folders_.begin(); it != folders_.end();) {
    if (wanted.count(it->first)) {
      ++it;
      continue;
    }
    ::inotify_rm_watch(inotify_, it->second);
    it = folders_.erase(it);
  }
  for (const std::string& folder : wanted) {
    const int number = ::inotify_add_watch(inotify_, folder.c_str(),
                                           IN_CLOSE_WRITE | IN_MOVED_TO | IN_DELETE | IN_MOVED_FROM | IN_ONLYDIR);
    if (number >= 0) folders_[folder] = number;
  }
  folders_are_stale_ = false;
}

// Files whose bytes are others than before; a changed time alone is noted and passed over.
std::vector<std::string> FileWatch::Stale() {
  std::vector<std::pair<std::string, Seen>> touched;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [file, seen] : seen_) {
      if (StampOf(file) != seen.stamp) touched.emplace_back(file, seen);
    }
  }
  std::vector<std::string> stale;
  for (auto& [file, seen] : touched) {
    const Seen now = LookAt(file);
    if (now.hash != seen.hash) stale.push_back(file);
    const std::lock_guard lock(mutex_);
    if (seen_.count(file)) seen_[file] = now;
  }
  return stale;
}

void FileWatch::Run() {
  std::array<char, 4096> buffer;
  int unrest_ms = 0;
  bool stirred = false;
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      if (stopped_) return;
      if (folders_are_stale_ || !stirred) WatchFolders();
    }
    std::array<pollfd, 2> waited = {{{wake_, POLLIN, 0}, {inotify_, POLLIN, 0}}};
    const int events = ::poll(waited.data(), inotify_ >= 0 ? 2 : 1, stirred ? kRestMs : kLookEveryMs);
    if (waited[0].revents) {
      while (::read(wake_, buffer.data(), 8) > 0) {
      }
    }
    const bool is_told = events > 0 && waited[1].revents != 0;
    if (is_told) {
      while (::read(inotify_, buffer.data(), buffer.size()) > 0) {
      }
    }
    if (is_told && (unrest_ms += kRestMs) < kLongestUnrestMs) {
      stirred = true;
      continue;
    }
    if (events > 0 && !is_told) continue;  // woken to watch others, or to stop
    if (!stirred && !is_told && !SeesChanges()) continue;
    stirred = false, unrest_ms = 0;
    const std::vector<std::string> stale = Stale();
    if (!stale.empty()) changed_(stale);
  }
}

}  // namespace scumble
