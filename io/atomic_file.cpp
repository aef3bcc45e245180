#include "io/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

namespace scumble {
namespace {

namespace fs = std::filesystem;

Error WriteFailure(const fs::path& path, int error_number) {
  return OutputError("cannot write " + path.string() + ": " + std::strerror(error_number));
}

// Writes everything and closes; 0 or the errno of what failed. Some file systems report a full disk only when the
// data is flushed or the file closed, so both are looked at.
int WriteAllAndClose(int descriptor, std::span<const std::byte> bytes, bool flush) {
  int failure = 0;
  while (!bytes.empty() && failure == 0) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      failure = errno;
    }
  }
  if (failure == 0 && flush && ::fsync(descriptor) != 0) failure = errno;
  if (::close(descriptor) != 0 && failure == 0) failure = errno;
  return failure;
}

}  // namespace

Status WriteFileAtomically(const fs::path& path, std::span<const std::byte> bytes) {
  std::error_code ignored;
  fs::path target = fs::weakly_canonical(path, ignored);
  if (ignored || target.empty()) target = path;
  const fs::file_status status = fs::status(target, ignored);
  if (fs::is_directory(status)) return OutputError("cannot write " + path.string() + ": it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    const int descriptor = ::open(target.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor < 0) return WriteFailure(path, errno);
    const int failure = WriteAllAndClose(descriptor, bytes, false);
    return failure == 0 ? Ok() : Status(WriteFailure(path, failure));
  }
  if (target.has_parent_path()) {
    std::error_code made;
    fs::create_directories(target.parent_path(), made);
    if (made) return OutputError("cannot make the folder " + target.parent_path().string() + ": " + made.message());
  }
  const fs::path temporary = target.parent_path() / ("." + target.filename().string() + "." +
                                                     std::to_string(::getpid()) + ".tmp");
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) return WriteFailure(path, errno);
  int failure = WriteAllAndClose(descriptor, bytes, true);
  if (failure == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) failure = errno;
  if (failure != 0) {
    ::unlink(temporary.c_str());
    return WriteFailure(path, failure);
  }
  return Ok();
}

Status WriteFileAtomically(const fs::path& path, std::string_view text) {
  return WriteFileAtomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

Expected<std::vector<std::byte>> ReadWholeFile(const fs::path& path, std::size_t limit) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (!fs::exists(status)) return InputError("cannot read " + path.string() + ": there is no such file");
  if (fs::is_directory(status)) return InputError("cannot read " + path.string() + ": it is a folder");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return InputError("cannot read " + path.string() + ": " + std::strerror(errno));
  std::vector<std::byte> bytes;
  char block[1 << 16];
  while (stream.read(block, sizeof block) || stream.gcount() > 0) {
    const auto* begin = reinterpret_cast<const std::byte*>(block);
    bytes.insert(bytes.end(), begin, begin + stream.gcount());
    if (bytes.size() > limit) return InputError(path.string() + " is larger than " + std::to_string(limit) + " bytes");
  }
  if (stream.bad()) return InputError("cannot read " + path.string() + ": " + std::strerror(errno));
  return bytes;
}

}  // namespace scumble
