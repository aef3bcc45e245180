// Temporary files of runs that were killed: how they are known, and who takes them away.
//
// A file that is being written is called ".NAME.MARK-XXXXXX.scumble-tmp": NAME is the output's own, MARK stands for the
// system that runs since it was started, X are random. It is locked (flock) until it has its final name, and the system
// drops the lock of a process that is killed. So it is a leftover when nobody has its lock, and the lock can be seen
// from here: the mark is this system's. Others, of another machine that shares the folder or from before a power
// failure, are leftovers when besides nothing was written to them for a day.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace scumble::internal {

inline constexpr std::string_view kLeftoverSuffix = ".scumble-tmp";

// Eight characters; the same for every process and container on this machine until it is started again. "00000000"
// where the system does not tell, and then every mark is taken for another machine's.
const std::string& KernelMark();

// Removes the leftovers in the folder ("" is the one the process runs in). What cannot be looked at or removed stays,
// and is no failure.
void RemoveLeftovers(const std::filesystem::path& folder);

// The same, the first time that this process asks for this folder. Thread-safe.
void RemoveLeftoversOnce(const std::filesystem::path& folder);

}  // namespace scumble::internal
