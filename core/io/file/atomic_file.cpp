#include "core/io/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>

#include "core/io/pending_temporaries.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constinit thread_local std::uint64_t bytes_written = 0;

Error WriteFailure(const fs::path& path, int error_number) {
  return OutputError("cannot write " + path.string() + ": " + std::strerror(error_number));
}

// Where no temporary file could be made: the file itself may be one that can be written.
Error FolderFailure(const fs::path& path, const fs::path& target, int error_number) {
  const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
  return OutputError("cannot write " + path.string() + ": no file can be made in the folder " + folder.string() + " (" +
                     std::strerror(error_number) + "); name another one");
}

// Writes everything and closes; 0 or the errno of what failed. Some file systems report a full disk only when the data
// is flushed or the file closed, so both are checked.
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

// The target of the name once all links are followed, also where the last link points to nothing yet: renaming onto a
// link would replace the link. A circle of links is a failure.
Expected<fs::path> FollowLinks(const fs::path& path) {
  constexpr int kMaxLinks = 40;  // the kernel's own limit
  std::error_code failed;
  fs::path target = path;
  for (int links = 0; fs::is_symlink(fs::symlink_status(target, failed)); ++links) {
    if (links == kMaxLinks) return WriteFailure(path, ELOOP);
    const fs::path next = fs::read_symlink(target, failed);
    if (failed) return WriteFailure(path, failed.value());
    target = target.parent_path() / next;
  }
  const fs::path canonical = fs::weakly_canonical(target, failed);
  return failed || canonical.empty() ? target : canonical;
}

// The process's umask. The system call that reads it also sets it. Linux has the value in proc(5) too (4.7 and later),
// so that other threads' files are not affected. Elsewhere it is read once.
mode_t FileModeMask() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    unsigned mask = 0;
    if (std::sscanf(line.c_str(), "Umask: %o", &mask) == 1) return static_cast<mode_t>(mask);
  }
  static const mode_t kMask = [] {
    const mode_t mask = ::umask(077);
    ::umask(mask);
    return mask;
  }();
  return kMask;
}

// mkostemp makes private files. A new file gets the mode that the umask allows; a replaced file keeps its mode.
mode_t ModeFor(const fs::file_status& replaced) {
  if (fs::exists(replaced)) return static_cast<mode_t>(replaced.permissions());
  return 0666 & ~FileModeMask();
}

// A target with its links followed, and whether it is a device or a pipe, which is written directly.
struct Target {
  fs::path path;
  fs::file_status status;
  bool is_special = false;
};

// The mode of a file is its owner's to change, or root's.
std::string RemedyForProtected(const fs::path& target) {
  struct stat file;
  const uid_t user = ::geteuid();
  const bool is_of_another = user != 0 && ::stat(target.c_str(), &file) == 0 && file.st_uid != user;
  return is_of_another ? "it belongs to another user: give another name"
                       : "make it writable, as chmod u+w does, or give another name";
}

Expected<Target> CheckTarget(const fs::path& path) {
  SCUMBLE_ASSIGN(const fs::path target, FollowLinks(path));
  std::error_code ignored;
  const fs::file_status status = fs::status(target, ignored);
  if (fs::is_directory(status)) return OutputError("cannot write " + path.string() + ": it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) return Target{target, status, true};
  if (fs::exists(status) && IsWriteProtected(target)) {
    const std::string reason = std::strerror(errno);  // before the remedy looks at the file
    return OutputError("cannot write " + path.string() + ": it is write-protected (" + reason +
                       "): " + RemedyForProtected(target));
  }
  const fs::path folder = target.parent_path();
  if (!folder.empty() && !fs::exists(folder, ignored)) {
    return OutputError("cannot write " + path.string() + ": there is no folder " + folder.string() + "; make it first");
  }
  return Target{target, status, false};
}

}  // namespace

bool IsWriteProtected(const fs::path& path) {
  return ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0 && errno != ENOENT && errno != ENOTDIR;
}

bool MayRefuseWriting(const fs::path& path) {
  std::error_code failed;
  return IsWriteProtected(path) || fs::is_symlink(path, failed) || fs::is_directory(path, failed);
}

Status CheckWritable(const fs::path& path) {
  SCUMBLE_ASSIGN(const Target target, CheckTarget(path));
  if (target.is_special) return ::access(target.path.c_str(), W_OK) == 0 ? Ok() : Status(WriteFailure(path, errno));
  const internal::PendingTemporary temporary(target.path);
  if (temporary.descriptor() < 0) return FolderFailure(path, target.path, errno);
  ::close(temporary.descriptor());
  return Ok();
}

Status WriteFileAtomically(const fs::path& path, std::span<const std::byte> bytes) {
  SCUMBLE_ASSIGN(const Target checked, CheckTarget(path));
  const fs::path& target = checked.path;
  if (checked.is_special) {
    const int descriptor = ::open(target.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor < 0) return WriteFailure(path, errno);
    const int failure = WriteAllAndClose(descriptor, bytes, false);
    if (failure == 0) bytes_written += bytes.size();
    return failure == 0 ? Ok() : Status(WriteFailure(path, failure));
  }
  internal::PendingTemporary temporary(target);
  const int descriptor = temporary.descriptor();
  if (descriptor < 0) return FolderFailure(path, target, errno);
  // On file systems without permissions this fails, and that is no failure to write.
  [[maybe_unused]] const int kept = ::fchmod(descriptor, ModeFor(checked.status));
  int failure = WriteAllAndClose(descriptor, bytes, true);
  if (failure == 0) failure = temporary.Finish(target);
  if (failure == 0) bytes_written += bytes.size();
  return failure == 0 ? Ok() : Status(WriteFailure(path, failure));
}

std::uint64_t BytesWrittenByThisThread() { return bytes_written; }

Status WriteFileAtomically(const fs::path& path, std::string_view text) {
  return WriteFileAtomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

Expected<std::vector<std::byte>> ReadWholeFile(const fs::path& path, std::size_t limit, std::string_view remedy) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (!fs::exists(status)) return InputError("cannot read " + path.string() + ": there is no such file");
  if (fs::is_directory(status)) return InputError("cannot read " + path.string() + ": it is a folder");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return InputError("cannot read " + path.string() + ": " + std::strerror(errno));
  std::vector<std::byte> bytes;
  char block[1 << 16];
  while (stream) {
    // One byte beyond the limit shows that the file is larger.
    const std::size_t room = limit - bytes.size();
    stream.read(block, static_cast<std::streamsize>(room < sizeof block ? room + 1 : sizeof block));
    const auto* begin = reinterpret_cast<const std::byte*>(block);
    bytes.insert(bytes.end(), begin, begin + stream.gcount());
    if (bytes.size() > limit) {
      return InputError(path.string() + " is larger than " + std::to_string(limit) + " bytes" + std::string(remedy));
    }
  }
  if (stream.bad()) return InputError("cannot read " + path.string() + ": " + std::strerror(errno));
  return bytes;
}

}  // namespace scumble
