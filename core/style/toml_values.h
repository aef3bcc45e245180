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

// A style's longest key, transfer.guide_weights.lpe.LDE, has four.
inline constexpr std::size_t kMostKeyParts = 16;

// Refuses (kInput) a string that is not closed, and names the line where it begins; and a key of more than
// kMostKeyParts parts, of a value or in a table's brackets, and names its line.
// toml++ makes a nested table for every part and destroys them recursively, so that a file of 61 KB can use up the
// stack. Its own limit, 256, is for nested values; with this one the depth stays below 4096. Any text may be given:
// other invalid TOML is left to the parser. `file` is for the message. O(bytes), thread-safe.
Status CheckTomlText(std::string_view text, const std::string& file);

// A kInput error names file and line. `text` may be anything.
Expected<toml::table> ParseToml(std::string_view text, const std::string& file);

// A plain value; none of tables, arrays and dates.
std::optional<KeyValue> ValueOf(const toml::node& node);

// The texts of a list of texts, or the one text; none of anything else.
std::optional<std::vector<std::string>> NamesOf(const toml::node& node);

// [[frame, value], …]; none of any other list.
std::optional<std::vector<StyleTrack::Key>> FramesOf(const toml::array& pairs);

// "style.toml:12", or the file alone where the node has no line.
std::string Where(const std::string& file, const toml::node& node);

}  // namespace scumble::internal
