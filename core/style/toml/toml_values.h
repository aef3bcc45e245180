// Values and places of TOML, for the readers of this folder.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/status.h"
#include "core/image/style.h"
#include "core/style/style_keys.h"

namespace scumble::internal {

// A kInput error names file and line. `text` may be anything.
Expected<toml::table> ParseToml(std::string_view text, const std::string& file);

// The value of --set KEY=VALUE, under the key "value". It may leave off the zero of .5 or 5., which TOML asks for.
Expected<toml::table> ParseSetValue(std::string_view text);

// A plain value; none of tables, arrays and dates.
std::optional<KeyValue> ValueOf(const toml::node& node);

// [[frame, value], …]; none of any other list.
std::optional<std::vector<StyleTrack::Key>> FramesOf(const toml::array& pairs);

// "style.toml:12", or the file alone where the node has no line.
std::string Where(const std::string& file, const toml::node& node);

}  // namespace scumble::internal
