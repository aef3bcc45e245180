// The target of a request, "/api/pick?x=3&y=4": its path and query, decoded.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/image/status.h"

namespace scumble {

struct RequestTarget {
  std::string path;  // begins with "/"
  std::map<std::string, std::string> query;
};

// kUsage for what no page of ours sends: another form than a path, a percent sign without two digits, control
// characters, text that is no UTF-8, "..", "//", and a name that stands in the query twice.
Expected<RequestTarget> ParseTarget(std::string_view text);

}  // namespace scumble
