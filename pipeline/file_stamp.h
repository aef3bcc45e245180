// Whether a file is still the one that was read.
#pragma once

#include <string>

namespace scumble {

// The path with the file's inode, size and time of its last change; "gone" where it is not there.
std::string StampOf(const std::string& path);

}  // namespace scumble
