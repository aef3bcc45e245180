// Whether a file is still the one that was read.
#pragma once

#include <chrono>
#include <string>

namespace scumble {

// The path with the file's inode, size and time of its last change; "gone" where it is not there.
std::string StampOf(const std::string& path);

// Whether the file was written, renamed or changed otherwise after that moment, or up to kFileTimeLagMs before it:
// times of files lag the clock. False where it is not there.
inline constexpr int kFileTimeLagMs = 20;
bool HasChangedSince(const std::string& path, std::chrono::system_clock::time_point moment);

}  // namespace scumble
