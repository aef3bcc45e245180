// Whether a PNG file is complete. libpng would report that on standard error only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/image/status.h"

namespace scumble::internal {

// What every PNG file begins with.
inline constexpr std::array<unsigned char, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

// Whether the bytes begin as every PNG file does.
bool IsPng(std::span<const std::byte> bytes);
// Whether a regular file begins so. A pipe is not opened, because reading it would wait.
bool IsPngFile(const std::filesystem::path& path);

// The picture's properties in a PNG file's first bytes: kPngHeaderBytes of them are enough.
inline constexpr std::size_t kPngHeaderBytes = 33;
struct PngHeader {
  std::uint32_t width = 0, height = 0;
  int bits = 0;  // per channel
  int channels = 0;
};
// Empty if the bytes are no PNG's. Thread-safe.
std::optional<PngHeader> ReadPngHeader(std::span<const std::byte> bytes);

// Whether that many bytes of Deflate can unpack to the picture's pixels. A reader allocates the pixels first.
bool CanHold(std::uint64_t packed, const PngHeader& header);

// Follows the chunks (PNG specification, third edition, section 5) up to the end chunk. Checks the sums of those that a
// reader needs, and that the packed bytes can hold the pixels. `name` is for the message. Thread-safe.
Status CheckPngIntegrity(std::span<const std::byte> bytes, const std::string& name);

}  // namespace scumble::internal
