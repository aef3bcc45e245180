#include "core/io/png/png_integrity.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "core/io/file/compression_bounds.h"

namespace scumble::internal {
namespace {

std::uint32_t Sum(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::uint32_t Number(std::span<const std::byte> bytes) {
  std::uint32_t number = 0;
  for (int i = 0; i < 4; ++i) number = number << 8 | std::to_integer<std::uint32_t>(bytes[i]);
  return number;
}

}  // namespace

bool CanHold(std::uint64_t packed, const PngHeader& header) {
  // Divided first, because the product may not fit: the sides are below 2³².
  const std::uint64_t pixels = std::uint64_t(header.width) * header.height;
  return pixels / 8 / kMostDeflated * static_cast<std::uint64_t>(header.bits * header.channels) <= packed;
}

std::optional<PngHeader> ReadPngHeader(std::span<const std::byte> bytes) {
  // Length, type, width, height, bits; the reader checks the other fields.
  constexpr std::size_t kType = 12, kWidth = 16, kHeight = 20, kBits = 24, kColors = 25;
  constexpr std::array<unsigned char, 4> kFirst = {'I', 'H', 'D', 'R'};
  if (!IsPng(bytes) || bytes.size() < kPngHeaderBytes ||
      !std::equal(kFirst.begin(), kFirst.end(), bytes.begin() + kType,
                  [](unsigned char a, std::byte b) { return a == std::to_integer<unsigned char>(b); })) {
    return std::nullopt;
  }
  const int colors = std::to_integer<int>(bytes[kColors]);  // 0, 2, 3, 4 or 6: grey, RGB, palette, with alpha
  const int channels = (colors == 2 || colors == 6 ? 3 : 1) + (colors >= 4 ? 1 : 0);
  return PngHeader{Number(bytes.subspan(kWidth)), Number(bytes.subspan(kHeight)), std::to_integer<int>(bytes[kBits]),
                   channels};
}

bool IsPng(std::span<const std::byte> bytes) {
  return bytes.size() >= kPngSignature.size() &&
         std::equal(kPngSignature.begin(), kPngSignature.end(), bytes.begin(),
                    [](unsigned char a, std::byte b) { return a == std::to_integer<unsigned char>(b); });
}

bool IsPngFile(const std::filesystem::path& path) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) return false;
  char start[kPngSignature.size()] = {};
  std::ifstream(path, std::ios::binary).read(start, sizeof start);
  return IsPng(std::as_bytes(std::span(start)));
}

Status CheckPngIntegrity(std::span<const std::byte> bytes, const std::string& name) {
  constexpr std::size_t kAround = 12;  // length, type and sum
  const std::optional<PngHeader> header = ReadPngHeader(bytes);
  std::uint64_t packed = 0;
  bytes = bytes.subspan(kPngSignature.size());
  while (bytes.size() >= kAround) {
    const std::size_t length = Number(bytes);
    if (length > bytes.size() - kAround) break;
    const auto type_and_data = bytes.subspan(4, 4 + length);
    const char kind = static_cast<char>(type_and_data[0]);
    const bool is_critical = kind >= 'A' && kind <= 'Z';  // the others may be left out, and are then
    if (is_critical && Sum(type_and_data) != Number(bytes.subspan(8 + length))) {
      return InputError("cannot read " + name + ": the PNG file is damaged; copy or save it again");
    }
    constexpr std::uint32_t kData = 0x49444154u, kEnd = 0x49454e44u;  // IDAT, IEND
    if (Number(type_and_data) == kData) packed += length;
    if (Number(type_and_data) == kEnd && (!header || CanHold(packed, *header))) return Ok();
    if (Number(type_and_data) == kEnd) break;
    bytes = bytes.subspan(kAround + length);
  }
  return InputError("cannot read " + name + ": the PNG file ends before its picture does; copy or save it again");
}

}  // namespace scumble::internal
