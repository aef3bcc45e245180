#include "pipeline/machine/file_cache.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "core/image/hash.h"
#include "core/io/atomic_file.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "scumble table 1\n";
constexpr std::size_t kHeader = kMagic.size() + sizeof(std::uint64_t);
constexpr std::size_t kMostBytes = std::size_t(2) << 30;

// Of the key too: a file that was renamed is another one's.
std::uint64_t Checksum(const std::string& key, std::span<const std::byte> bytes) {
  return Hash(HashText(key), HashText({reinterpret_cast<const char*>(bytes.data()), bytes.size()}), bytes.size());
}

void RemoveOldest(const fs::path& folder) {
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    if (entry.path().extension() != ".table") continue;
    files.emplace_back(entry.last_write_time(failed), entry.path());
  }
  if (files.size() <= FileCache::kMostFiles) return;
  std::sort(files.begin(), files.end());
  for (std::size_t i = 0; i < files.size() - FileCache::kMostFiles; ++i) fs::remove(files[i].second, failed);
}

}  // namespace

std::optional<std::vector<std::byte>> FileCache::Load(const std::string& key) {
  std::error_code failed;
  if (folder_.empty() || !fs::is_regular_file(FileOf(key), failed)) return std::nullopt;
  auto bytes = ReadWholeFile(FileOf(key), kMostBytes);
  if (!bytes || bytes->size() < kHeader || std::memcmp(bytes->data(), kMagic.data(), kMagic.size()) != 0) {
    return std::nullopt;
  }
  std::uint64_t stated = 0;
  std::memcpy(&stated, bytes->data() + kMagic.size(), sizeof stated);
  bytes->erase(bytes->begin(), bytes->begin() + kHeader);
  if (stated != Checksum(key, *bytes)) return std::nullopt;
  return std::move(*bytes);
}

void FileCache::Store(const std::string& key, std::span<const std::byte> bytes) {
  if (folder_.empty()) return;
  std::error_code failed;
  fs::create_directories(folder_, failed);
  if (failed) return;
  std::vector<std::byte> file(kHeader);
  const std::uint64_t checksum = Checksum(key, bytes);
  std::memcpy(file.data(), kMagic.data(), kMagic.size());
  std::memcpy(file.data() + kMagic.size(), &checksum, sizeof checksum);
  file.insert(file.end(), bytes.begin(), bytes.end());
  if (!WriteFileAtomically(FileOf(key), file)) return;
  RemoveOldest(folder_);
}

}  // namespace scumble
