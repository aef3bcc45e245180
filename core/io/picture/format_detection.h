// Which of OpenImageIO's readers a picture is for.
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

// OpenImageIO's name of the one reader that may open a file: by how it begins, and of TGA, which has no such mark, by
// its name's ending. Else an error that says which formats are read. Left to itself OpenImageIO hands what one reader
// turns down to all the others, video and raw photographs among them, and one of those ends the process at some bytes.
// Raw photographs are refused: most begin as TIFF, whose reader shows the small preview in them. So are GIFs, which
// OpenImageIO 2.4 draws as it opens them: on a canvas whose bytes it counts in 32 bits, which makes none of 32768²
// pixels, and in colours from behind a palette's end, which nothing short of unpacking the pixels could rule out.
// `start` is the beginning of the file, kStartBytes if it has them. Thread-safe.
inline constexpr std::size_t kStartBytes = 64;
Expected<std::string> ReaderFor(std::span<const std::byte> start, const std::filesystem::path& name);

// Whether that reader may open a file that starts so: BMPs that are packed by runs OpenImageIO unpacks without looking
// where it writes, and a TGA's colours it takes without looking how many there are. Of PSDs core/io/oiio/flat_psd.h
// takes care.
Status CheckStart(std::string_view reader, std::span<const std::byte> start, const std::string& name);

// That a file of so many bytes is too short for the size that its header declares.
Error DeclaredSizeError(const std::string& name, std::uint64_t bytes);

// The first kStartBytes of a file, or all there are.
Expected<std::vector<std::byte>> ReadStart(const std::filesystem::path& path);

// Most samples, one a channel and pixel, that a byte of such a file stands for; 0: no bound is known, as a few bytes
// hold a plain picture of any size. EXR and PNG have bounds of their own, which look at what is packed.
std::uint64_t MostSamplesInAByte(std::string_view reader);

}  // namespace scumble::internal
