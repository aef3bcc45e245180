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

// Writes to a temporary name in the same folder, flushes it to disk, then renames. An interrupted run leaves the old
// file or none. Links are followed. A target that is no regular file (a device, a pipe) is written directly. A missing
// folder is an error: on a farm it is an unmounted share. So is a file that the user may not write, as for `cp`: it may
// be an approved one. A replaced file keeps its permissions. Every error gives the file's name and the system's reason.
Status WriteFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
Status WriteFileAtomically(const std::filesystem::path& path, std::string_view text);

// Bytes that this thread has written by WriteFileAtomically, in finished files.
std::uint64_t BytesWrittenByThisThread();

// Whether WriteFileAtomically can write there. Makes and removes its temporary file; call it before long work.
Status CheckWritable(const std::filesystem::path& path);

// Whether a file is there that this user may not write.
bool IsWriteProtected(const std::filesystem::path& path);
// Whether something is there that CheckWritable may refuse although its folder can be written: such a file, a folder or
// a link.
bool MayRefuseWriting(const std::filesystem::path& path);

// The whole file, `limit` bytes at most. If it is larger, that is an error, and `remedy` ends the message.
Expected<std::vector<std::byte>> ReadWholeFile(const std::filesystem::path& path,
                                               std::size_t limit = std::size_t(8) << 30, std::string_view remedy = {});

}  // namespace scumble
