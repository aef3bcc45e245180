#include "pipeline/file_stamp.h"

#include <fmt/format.h>
#include <sys/stat.h>

namespace scumble {

std::string StampOf(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return path + " gone";
  return fmt::format("{} {} {} {}.{}", path, file.st_ino, file.st_size, file.st_mtim.tv_sec, file.st_mtim.tv_nsec);
}

bool HasChangedSince(const std::string& path, std::chrono::system_clock::time_point moment) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return false;
  const auto since = moment.time_since_epoch() - std::chrono::milliseconds(kFileTimeLagMs);
  const auto is_after = [&](const timespec& time) {
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec) > since;
  };
  return is_after(file.st_mtim) || is_after(file.st_ctim);
}

}  // namespace scumble
