// Lists of names, by which effects are limited to objects and materials.
#pragma once

#include <string>
#include <vector>

#include "core/style/toml/toml_values.h"

namespace scumble::internal {

inline constexpr const char* kNamesExpected = "expected names in quotes, as [\"Tree*\", \"House\"]";

// Replaces `names` by the one name that `node` is, or by those of a list. kUsage for anything else.
inline Status ReadNames(const toml::node& node, std::vector<std::string>& names) {
  if (const auto* one = node.as_string()) return names = {one->get()}, Ok();
  const auto* list = node.as_array();
  if (!list) return UsageError(kNamesExpected);
  std::vector<std::string> read;
  for (const auto& item : *list) {
    const auto* name = item.as_string();
    if (!name) return UsageError(kNamesExpected);
    read.push_back(name->get());
  }
  names = std::move(read);
  return Ok();
}

}  // namespace scumble::internal
