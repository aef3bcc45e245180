// The keys of style.toml as JSON: for the page's controls, for `scumble styles --keys --json` and for other programs.
#pragma once

#include <nlohmann/json.hpp>

#include "core/style/style_keys.h"

namespace scumble {

// An array of objects: name, default (a value; infinities, which JSON lacks, are null), help, kind, least, most, step,
// choices, group, needs_preparing. least, most and step are null where the kind is no number, choices where it is no
// choice. `unlimited` is true where values beyond most are taken, too: most is then what a slider ends at.
nlohmann::ordered_json StyleKeysJson();

}  // namespace scumble
