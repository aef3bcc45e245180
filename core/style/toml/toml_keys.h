// What is refused in a TOML text before a parser reads it.
#pragma once

#include <string>
#include <string_view>

#include "core/image/status.h"

namespace scumble::internal {

// A style's longest key, transfer.guide_weights.lpe.LDE, has four.
inline constexpr std::size_t kMostKeyParts = 16;

// Refuses (kInput) a string that is not closed, and names the line where it begins. Refuses a key of more than
// kMostKeyParts parts, of a value or in a table's brackets, and names its line. toml++ makes a nested table for every
// part and destroys them recursively, so a file of 61 KB can use up the stack. Its own limit, 256, is for nested
// values; with this one the depth stays below 4096. Any text may be given: other invalid TOML is left to the parser.
// `file` is for the message. O(bytes), thread-safe.
Status CheckTomlText(std::string_view text, const std::string& file);

}  // namespace scumble::internal
