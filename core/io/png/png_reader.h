// Plain PNG files, by libpng: without the whole picture library, which takes a fifth of a second to load.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/io/format_dispatch.h"
#include "scumble/picture.h"

namespace scumble::internal {

// The picture in a PNG file that is whole (CheckPngIntegrity), as ReadPicture gives it. Nothing where the file is
// damaged, larger than a picture may be, or has what only the picture library knows how to take: Exif, XMP, an offset,
// a linear gamma, or words about colour spaces. That library then reads it, or says what is wrong. Thread-safe.
std::optional<Picture> ReadPlainPng(std::span<const std::byte> bytes);

// What that file's header says, as `InspectStored` gives it: of the same files, whole or not.
std::optional<StoredPicture> InspectPlainPng(std::span<const std::byte> bytes);

}  // namespace scumble::internal
