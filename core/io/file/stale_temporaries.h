// Stale temporary files: those of runs that were killed. How they are known, and when they are removed.
//
// A file that is being written is called ".NAME.MARK-XXXXXX.scumble-tmp": NAME is the output's own, MARK stands for the
// system that runs since it was started, X are random. It is locked (flock) until it has its final name, and the system
// drops the lock of a process that is killed. A file with this system's mark is stale if no process holds its lock. A
// file with another mark comes from another machine that shares the folder, or from before a power failure; its lock
// cannot be seen from here. It is stale if, besides, nothing was written to it for a day.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace scumble::internal {

inline constexpr std::string_view kTemporarySuffix = ".scumble-tmp";

// Eight characters; the same for every process and container on this machine until it is started again. "00000000"
// where the system does not tell, and then every mark is taken for another machine's.
const std::string& KernelMark();

// Removes the stale temporaries in the folder ("" is the one the process runs in). A file that cannot be looked at or
// removed stays, and is no failure.
void RemoveStaleTemporaries(const std::filesystem::path& folder);

// The same, the first time that this process asks for this folder. Thread-safe.
void RemoveStaleTemporariesOnce(const std::filesystem::path& folder);

}  // namespace scumble::internal
