// Integrity check of EXR files: whether a file can hold the size that its header declares. OpenEXR believes a header,
// and asks for the memory first.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "core/image/status.h"

namespace scumble::internal {

// Follows the attributes of all parts (OpenEXR's "File Layout"): none is larger than what is left of the file, and the
// pixels of no part are more than its compression can make of the whole file. No part is deep, of which no reader here
// makes anything and whose pixels nothing bounds. Nothing is wrong with what is no EXR file, or whose header ends too
// early: the library says what is. `name` is for the message. Thread-safe.
Status CheckExrIntegrity(const std::filesystem::path& path);
Status CheckExrIntegrity(std::span<const std::byte> bytes, const std::string& name);

}  // namespace scumble::internal
