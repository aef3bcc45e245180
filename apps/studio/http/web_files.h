// The page's files: those that are in the program, or those of a folder while the page is worked on.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/image/status.h"

namespace scumble {

// Made at build time of every file of the page that a browser gets (apps/studio/embed.cmake).
struct EmbeddedFile {
  std::string_view name;  // "page.js", from the folder apps/studio/web/
  std::string_view bytes;
};
std::span<const EmbeddedFile> EmbeddedFiles();

struct WebFile {
  std::string content_type;
  std::string etag;
  std::string body;
};

// What a file of this name is served as; empty: it is not served.
std::string ContentTypeOf(std::string_view name);

// Only names of a list that is made at the start are served, whatever is asked for. Safe from any thread.
class WebFiles {
 public:
  // `folder`: where to read the files from, anew each time; empty: the program's own. kInput where it has no
  // index.html.
  static Expected<WebFiles> Open(const std::filesystem::path& folder);
  // Empty: there is none of that name, or it can no longer be read.
  std::optional<WebFile> Find(const std::string& name) const;

 private:
  std::filesystem::path folder_;
  std::map<std::string, std::string_view> files_;  // the bytes of embedded ones
};

}  // namespace scumble
