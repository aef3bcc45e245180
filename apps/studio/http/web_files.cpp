#include "apps/studio/http/web_files.h"

#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "core/image/hash.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

constexpr const char* kIndex = "index.html";

std::optional<std::string> ReadWebFile(const fs::path& path) {
  std::error_code failed;
  if (!fs::is_regular_file(fs::symlink_status(path, failed))) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(file), {});
  if (!file) return std::nullopt;
  return bytes;
}

}  // namespace

std::string ContentTypeOf(std::string_view name) {
  constexpr std::pair<std::string_view, const char*> kTypes[] = {{".html", "text/html; charset=utf-8"},
                                                                 {".css", "text/css; charset=utf-8"},
                                                                 {".js", "text/javascript; charset=utf-8"},
                                                                 {".svg", "image/svg+xml"},
                                                                 {".png", "image/png"},
                                                                 {".ico", "image/x-icon"}};
  for (const auto& [ending, type] : kTypes) {
    if (name.ends_with(ending)) return type;
  }
  return "";
}

Expected<WebFiles> WebFiles::Open(const fs::path& folder) {
  WebFiles files;
  files.folder_ = folder;
  if (folder.empty()) {
    for (const EmbeddedFile& file : EmbeddedFiles()) files.files_.emplace(file.name, file.bytes);
    return files;
  }
  std::error_code failed;
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().lexically_relative(folder).generic_string();
    if (fs::is_regular_file(entry->symlink_status(failed)) && !ContentTypeOf(name).empty()) files.files_[name] = {};
  }
  if (files.files_.count(kIndex) == 0) {
    return InputError(folder.string() + " has no index.html: --web takes the folder of the studio's page, " +
                      "apps/studio/web of Scumble's sources");
  }
  return files;
}

std::optional<WebFile> WebFiles::Find(const std::string& name) const {
  const auto found = files_.find(name);
  if (found == files_.end()) return std::nullopt;
  WebFile file{ContentTypeOf(name), "", std::string(found->second)};
  if (!folder_.empty()) {
    auto bytes = ReadWebFile(folder_ / name);
    if (!bytes) return std::nullopt;
    file.body = *std::move(bytes);
  }
  file.etag = "\"" + std::to_string(HashText(file.body)) + "\"";
  return file;
}

}  // namespace scumble
