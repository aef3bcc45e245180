// Changes keys in the text of a style.toml and leaves everything else of it, comments too, as it is.
#pragma once

#include <string>
#include <vector>

#include "core/image/status.h"

namespace scumble {

// `settings` are "KEY=VALUE" with keys of [transfer] and numbers: "transfer.threshold=0.2". A key that is there gets
// the new value, others are added below the line [transfer], or in a new one at the end. `file` is for messages. kInput
// where the text is no TOML, or has [transfer] in a form to which nothing can be added.
Expected<std::string> WithSettings(std::string text, const std::vector<std::string>& settings, const std::string& file);

}  // namespace scumble
