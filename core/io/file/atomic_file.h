// Files that appear whole under their name or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "core/image/status.h"

namespace scumble {

// Writes to a temporary name in the same folder, flushes it to disk, then renames: an interrupted run leaves the old
// file or none. Links are followed, and a target that is no regular file (a device, a pipe) is written to directly.
// A missing folder is an error: on a farm it is a share that is not mounted. A replaced file keeps its permissions.
// Every failure is an error with the file's name and the system's reason.
Status WriteFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
Status WriteFileAtomically(const std::filesystem::path& path, std::string_view text);

// Bytes that this thread has brought to the system by WriteFileAtomically, in files that were finished.
std::uint64_t BytesWrittenByThisThread();

// Whether WriteFileAtomically could write there, found out by making its temporary file and taking it away: to be asked
// before long work.
Status CheckWritable(const std::filesystem::path& path);

// The whole file, `limit` bytes at most. If it is larger, that is an error, and `remedy` ends the message.
Expected<std::vector<std::byte>> ReadWholeFile(const std::filesystem::path& path,
                                               std::size_t limit = std::size_t(8) << 30, std::string_view remedy = {});

}  // namespace scumble
