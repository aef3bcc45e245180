// Watches files that other programs save: by inotify on their folders, since many programs write beside a file and
// rename, and by looking every half second, since network shares tell nothing.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace scumble {

class FileWatch {
 public:
  // `changed` is called on a thread of the watch, once files have been at rest for 5 ms and the bytes of at least one
  // of them differ from those that were seen before, or it is gone, or there again.
  explicit FileWatch(std::function<void(const std::vector<std::string>& files)> changed);
  ~FileWatch();
  FileWatch(const FileWatch&) = delete;
  FileWatch& operator=(const FileWatch&) = delete;

  // Ends the thread: `changed` is not called any more. Watch and SeesChanges may still be called.
  void Stop();

  // Watches these from now on, instead of those before; what is known of a file that stays is kept. One that is new
  // here and has changed since `read` counts as changed. A folder changes with the names in it.
  void Watch(const std::vector<std::string>& files, std::chrono::system_clock::time_point read);

  // Whether a file has changed that `changed` was not yet told of.
  bool SeesChanges() const;

 private:
  struct Seen {
    std::string stamp;  // cheap to compare
    std::uint64_t hash = 0;
    bool is_folder = false;
  };
  static Seen LookAt(const std::string& file);
  void Run();
  void WatchFolders();
  std::vector<std::string> Stale();

  std::function<void(const std::vector<std::string>&)> changed_;
  mutable std::mutex mutex_;
  std::map<std::string, Seen> seen_;
  std::map<std::string, int> folders_;  // inotify's number of each
  bool folders_are_stale_ = false;
  bool stopped_ = false;
  int inotify_ = -1;
  int wake_ = -1;  // an eventfd
  std::thread thread_;
};

}  // namespace scumble
