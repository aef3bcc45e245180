// The user's cache folder: look-up tables of exemplars, kept between runs. Style folders may be read-only and shared,
// so nothing is ever kept there.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "transfer/table_cache.h"

namespace scumble {

// One file a key, written whole or not at all, with a checksum. A file that is missing, cut short or altered is as if
// it were not there; a folder that cannot be written keeps nothing, and neither is an error. Beyond kMostFiles the
// oldest files are removed.
class FileCache : public TableCache {
 public:
  static constexpr std::size_t kMostFiles = 256;

  // An empty path keeps nothing.
  explicit FileCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::optional<std::vector<std::byte>> Load(const std::string& key) override;
  void Store(const std::string& key, std::span<const std::byte> bytes) override;

 private:
  std::filesystem::path FileOf(const std::string& key) const { return folder_ / (key + ".table"); }

  std::filesystem::path folder_;
};

}  // namespace scumble
