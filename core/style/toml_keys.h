// How many parts the keys of a TOML text have, before a parser follows them.
#pragma once

#include <string>
#include <string_view>

#include "core/image/status.h"

namespace scumble::internal {

// A style's longest key, transfer.guide_weights.lpe.LDE, has four.
inline constexpr std::size_t kMostKeyParts = 16;

// Refuses (kInput) a key of more parts than kMostKeyParts, of a value or in a table's brackets, and names its line:
// toml++ makes a table in a table for every part and takes them down one in the other, so that a file of 61 KB can use
// up the stack. Its own limit, 256, is of values in values; with this one nothing is deeper than 4096. Any text may be
// given: what is no TOML is the parser's to refuse. `file` is for the message. O(bytes), thread-safe.
Status CheckKeyParts(std::string_view text, const std::string& file);

}  // namespace scumble::internal
