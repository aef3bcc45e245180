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

  // An entry's bytes, `limit` at most: what an archive says of its sizes is not believed, so a small file that unpacks
  // to something huge is an error. So are a missing entry, a wrong checksum and encryption.
  Expected<std::vector<std::byte>> Read(const std::string& name, std::size_t limit) const;
  // Its first `count` bytes, or all where it has fewer: what they are is known before the rest is unpacked.
  Expected<std::vector<std::byte>> ReadStart(const std::string& name, std::size_t count) const;

 private:
  struct Archive;
  ZipReader(std::unique_ptr<Archive> archive, std::string file, std::vector<std::string> names);

  // A longer entry is an error where the `whole` of it is asked for, else cut.
  Expected<std::vector<std::byte>> ReadAtMost(const std::string& name, std::size_t limit, bool whole) const;

  std::unique_ptr<Archive> archive_;
  std::string file_;
  std::vector<std::string> names_;
};

}  // namespace scumble
