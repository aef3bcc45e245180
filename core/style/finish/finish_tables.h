// [[finish]] of TOML files.
#pragma once

#include <string>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/style/toml_values.h"

namespace scumble::internal {

// Of lists of names, by which effects are limited to objects and materials.
inline constexpr const char* kNamesExpected = "expected names in quotes, as [\"Tree*\", \"House\"]";

// A key whose value is a list: of frames with their values.
struct FinishFrames {
  std::string key;  // "finish.ink.width"
  const toml::array* pairs = nullptr;
};

// The tables of `node`, which is what the file calls finish. Every mistake is kInput and names file and line. Keys with
// lists are left at their defaults and told in `frames`, in which each pass has a name of its own.
Expected<std::vector<FinishPass>> ReadFinishTables(const toml::node& node, const std::string& file,
                                                   std::vector<FinishFrames>& frames);

}  // namespace scumble::internal
