// Whether a file can be read at all, checked before a library opens it.
#pragma once

#include <filesystem>

#include "core/image/status.h"

namespace scumble::internal {

// std::filesystem::exists, but a link to itself or a locked folder is no exception.
bool Exists(const std::filesystem::path& path);

// Ok, or why not (kInput): it is missing, a folder, no regular file, empty, or not for this user. Thread-safe.
Status CheckReadable(const std::filesystem::path& path);

}  // namespace scumble::internal
