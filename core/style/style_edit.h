// Changes keys in the text of a style.toml and leaves everything else of it, comments too, as it is.
#pragma once

#include <string>
#include <vector>

#include "core/image/status.h"
#include "core/style/style_keys.h"

namespace scumble {

// The value as TOML has it: numbers exact, texts with escapes.
std::string TomlText(const KeyValue& value);

// `settings` are "KEY=VALUE" with any of StyleKeys and values as TomlText writes them: "transfer.threshold=0.2". A key
// that is there gets the new value, key frames included. Others are added below the line of their table, or in a new
// one at the end; a key without a table below the last such key. `file` is for messages. kUsage for an unknown key or a
// value that is none. kInput where the text is no TOML, or has the table in a form to which nothing can be added.
Expected<std::string> WithSettings(std::string text, const std::vector<std::string>& settings, const std::string& file);

}  // namespace scumble
