// Which of OpenImageIO's readers a picture is for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "image/status.h"

namespace scumble::internal {

// OpenImageIO's name of the one reader that may open a file: by how it begins, and of TGA, which has no such mark, by
// its name's ending. Else an error that says which formats are read. Left to itself OpenImageIO hands what one reader
// turns down to all the others, video and raw photographs among them, and one of those ends the process at some bytes.
// Raw photographs are refused: most begin as TIFF, whose reader shows the small preview in them.
// `start` is the beginning of the file, 16 bytes if it has them. Thread-safe.
Expected<std::string> ReaderFor(std::span<const std::byte> start, const std::filesystem::path& name);

// The same of a file.
Expected<std::string> ReaderFor(const std::filesystem::path& path);

// Most samples, one a channel and pixel, that a byte of such a file stands for; 0: no bound is known, as a few bytes
// hold a plain picture of any size. EXR and PNG have bounds of their own, which look at what is packed.
std::uint64_t MostSamplesInAByte(std::string_view reader);

}  // namespace scumble::internal
