// [[finish]] of TOML files.
#pragma once

#include <string>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/style/toml_values.h"

namespace scumble::internal {

// The tables of `node`, which is what the file calls finish. Every mistake is kInput and names file and line.
Expected<std::vector<FinishPass>> ReadFinishTables(const toml::node& node, const std::string& file);

}  // namespace scumble::internal
