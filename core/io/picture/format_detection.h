// The OpenImageIO reader for a picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/status.h"

namespace scumble::internal {

// OpenImageIO's name of the one reader that may open a file. It is known by the file's first bytes, and for TGA, which
// has no such mark, by the name's ending. Otherwise an error that lists the formats. By itself OpenImageIO passes a
// file that one reader refuses to all the others, video and raw photographs included, and one of those ends the process
// at some bytes. Raw photographs are refused: most begin as TIFF, whose reader shows the small preview in them. GIFs
// are refused too, because OpenImageIO 2.4 draws them on opening. It counts the canvas's bytes in 32 bits, which makes
// 0 for 32768² pixels, and reads colours beyond a palette's end. Only unpacking the pixels could rule that out. `start`
// is the beginning of the file, kStartBytes if it has them. Thread-safe.
inline constexpr std::size_t kStartBytes = 64;
Expected<std::string> ReaderFor(std::span<const std::byte> start, const std::filesystem::path& name);

// Whether that reader may open a file with this start. OpenImageIO unpacks run-length BMPs without checking where it
// writes, and reads a TGA's colours without checking how many there are. For PSDs core/io/oiio/flat_psd.h checks.
Status CheckStart(std::string_view reader, std::span<const std::byte> start, const std::string& name);

// The error that a file of that many bytes is too short for its declared size.
Error DeclaredSizeError(const std::string& name, std::uint64_t bytes);

// The first kStartBytes of a file, or all there are.
Expected<std::vector<std::byte>> ReadStart(const std::filesystem::path& path);

// The largest number of samples, one a channel and pixel, that a byte of such a file stands for. 0: no bound is known,
// as a few bytes hold a plain picture of any size. EXR and PNG have their own bounds, which inspect the packed data.
std::uint64_t MostSamplesInAByte(std::string_view reader);

}  // namespace scumble::internal
