// Integrity check of EXR files: whether a file can hold the size that its header declares. OpenEXR believes a header,
// and asks for the memory first.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "core/image/status.h"

namespace scumble::internal {

// Follows the attributes of all parts (OpenEXR's "File Layout"). No attribute may exceed the rest of the file, and no
// part may declare more pixels than its compression can make of the whole file. Deep parts are refused: no reader here
// uses them, and nothing bounds their pixels. A file that is no EXR, or whose header ends too early, passes: the
// library reports it. `name` is for the message. Thread-safe.
Status CheckExrIntegrity(const std::filesystem::path& path);
Status CheckExrIntegrity(std::span<const std::byte> bytes, const std::string& name);

}  // namespace scumble::internal
