// Stale temporary files and folders: those of killed runs. How they are recognised, and when they are removed.
//
// A file that is being written is called ".NAME.MARK-XXXXXX.scumble-tmp": NAME is the output's own name, MARK stands
// for this system since its last start, X are random. The file is locked (flock) until it has its final name, and the
// system drops the lock of a killed process. A file with this system's mark is stale if no process holds its lock. A
// file with another mark comes from another machine that shares the folder, or from before a power failure; its lock
// cannot be seen from here. Such a file is stale if, besides, nothing was written to it for a day.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace scumble::internal {

inline constexpr std::string_view kTemporarySuffix = ".scumble-tmp";

// Eight characters, the same for every process and container on this machine until its next start. "00000000" where the
// system gives none; then every mark counts as another machine's.
const std::string& KernelMark();

// Removes the stale temporaries in the folder ("" is the working folder). A file that cannot be opened or removed
// stays, and is no failure.
void RemoveStaleTemporaries(const std::filesystem::path& folder);

// RemoveStaleTemporaries, on the first call of this process for this folder. Thread-safe.
void RemoveStaleTemporariesOnce(const std::filesystem::path& folder);

// A new folder "scumble-MARK-XXXXXX" in `parent`, locked and stale by the same rules as a file. Removes those there
// that are stale and the user's. The caller closes `lock` after it has removed the folder. Where none can be made, the
// path is empty, and `failure` is the system's reason (errno).
struct LockedFolder {
  std::filesystem::path path;
  int lock = -1;
  int failure = 0;
};
LockedFolder MakeLockedFolder(const std::filesystem::path& parent);

}  // namespace scumble::internal
