#include "core/io/readable_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

namespace scumble::internal {

bool Exists(const std::filesystem::path& path) {
  std::error_code failed;
  return std::filesystem::exists(path, failed);
}

Status CheckReadable(const std::filesystem::path& path) {
  const auto refuse = [&](const std::string& why) { return InputError("cannot read " + path.string() + ": " + why); };
  std::error_code failed;
  const auto status = std::filesystem::status(path, failed);
  if (status.type() == std::filesystem::file_type::none) return refuse(failed.message());
  if (!std::filesystem::exists(status)) return refuse("there is no such file");
  if (std::filesystem::is_directory(status)) return refuse("it is a folder");
  // Reading a pipe would wait without end, and the readers seek.
  if (!std::filesystem::is_regular_file(status)) return refuse("it is no regular file");
  if (::access(path.c_str(), R_OK) != 0) return refuse(std::strerror(errno));
  if (std::filesystem::file_size(path, failed) == 0) return refuse("the file is empty");
  return Ok();
}

}  // namespace scumble::internal
