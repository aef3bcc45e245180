// Reads plain PNG files by libpng, without the picture library, which takes a fifth of a second to load.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/io/format_dispatch.h"
#include "scumble/picture.h"

namespace scumble::internal {

// The picture in a complete PNG file (CheckPngIntegrity), as ReadPicture gives it. Empty if the file is damaged,
// exceeds the largest picture, or needs the picture library: for Exif, XMP, an offset, a linear gamma, or texts about
// colour spaces. That library then reads it, or reports the error. Thread-safe.
std::optional<Picture> ReadPlainPng(std::span<const std::byte> bytes);

// That file's header, as `InspectStored` gives it: for the same files, complete or not.
std::optional<StoredPicture> InspectPlainPng(std::span<const std::byte> bytes);

}  // namespace scumble::internal
