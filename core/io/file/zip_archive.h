// Zip archives from and to memory and disk, by libzip.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"

namespace scumble {

struct ZipEntry {
  std::string name;  // UTF-8, with '/' between folders
  std::vector<std::byte> bytes;
  bool deflate = false;  // pictures are packed already, text is not
};

// The archive's bytes, entries in the order given. All are dated 1 January 1980, where a zip file's calendar begins, so
// that the same entries make the same bytes. `name` stands for the archive in messages. Thread-safe.
Expected<std::vector<std::byte>> EncodeZip(std::span<const ZipEntry> entries, const std::string& name);

// Whether a regular file begins as a zip archive does.
bool IsZip(const std::filesystem::path& path);

// An archive that is open for reading. Not thread-safe.
class ZipReader {
 public:
  static Expected<ZipReader> Open(const std::filesystem::path& path);
  ~ZipReader();
  ZipReader(ZipReader&&) noexcept;
  ZipReader& operator=(ZipReader&&) noexcept;

  // In the order of the archive's directory.
  const std::vector<std::string>& names() const { return names_; }
  bool Has(const std::string& name) const;

  // An entry's bytes, `limit` at most. The sizes in an archive are not trusted, so a small file that unpacks to
  // something huge is an error. So are a missing entry, a wrong checksum and encryption.
  Expected<std::vector<std::byte>> Read(const std::string& name, std::size_t limit) const;
  // The entry's first `count` bytes, or all where it has fewer: these are checked before the rest is unpacked.
  Expected<std::vector<std::byte>> ReadStart(const std::string& name, std::size_t count) const;

 private:
  struct Archive;
  ZipReader(std::unique_ptr<Archive> archive, std::string file, std::vector<std::string> names);

  // Where `whole` is set, a longer entry is an error; otherwise it is cut.
  Expected<std::vector<std::byte>> ReadAtMost(const std::string& name, std::size_t limit, bool whole) const;

  std::unique_ptr<Archive> archive_;
  std::string file_;
  std::vector<std::string> names_;
};

}  // namespace scumble
