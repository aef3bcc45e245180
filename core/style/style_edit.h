// Changes keys in the text of a style.toml and leaves everything else of it, comments too, as it is.
#pragma once

#include <string>
#include <vector>

#include "core/image/status.h"
#include "core/style/style_override.h"

namespace scumble {

// The value as TOML has it: numbers exact, texts with escapes.
std::string TomlText(const KeyValue& value);

// `settings` are values of any of StyleKeys. A key that is there gets the new value, key frames included. Others are
// added below the line of their table, or in a new one at the end; a key without a table below the last such key.
// `file` is for messages. kUsage for an unknown key, and for key frames. kInput where the text is no TOML, or has the
// table in a form to which nothing can be added.
Expected<std::string> WithSettings(std::string text, const std::vector<StyleOverride>& settings,
                                   const std::string& file);

}  // namespace scumble
