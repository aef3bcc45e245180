#include "pipeline/file_stamp.h"

#include <fmt/format.h>
#include <sys/stat.h>

namespace scumble {

std::string StampOf(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return path + " gone";
  return fmt::format("{} {} {} {}.{}", path, file.st_ino, file.st_size, file.st_mtim.tv_sec, file.st_mtim.tv_nsec);
}

}  // namespace scumble
