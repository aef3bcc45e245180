// PNG files as they are, and again with the sums of their chunks corrected, so that the code after those checks is
// tested.
#include <array>

#include "core/io/picture_file.h"
#include "core/io/png/png_integrity.h"
#include "core/io/png/png_reader.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {
namespace {

std::uint32_t Crc(Bytes bytes) {  // PNG specification, third edition, annex D, bit by bit
  std::uint32_t sum = 0xffffffffu;
  for (const std::uint8_t byte : bytes) {
    sum ^= byte;
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (sum & 1 ? 0xedb88320u : 0);
  }
  return ~sum;
}

std::vector<std::uint8_t> WithRightSums(Bytes input) {
  std::vector<std::uint8_t> bytes(input.begin(), input.end());
  for (std::size_t at = 8; bytes.size() >= 12 && at <= bytes.size() - 12;) {
    const std::size_t length = std::size_t(bytes[at]) << 24 | std::size_t(bytes[at + 1]) << 16 |
                               std::size_t(bytes[at + 2]) << 8 | bytes[at + 3];
    if (length > bytes.size() - at - 12) break;
    const std::uint32_t sum = Crc(Bytes(bytes).subspan(at + 4, length + 4));
    for (std::size_t i = 0; i < 4; ++i) bytes[at + 8 + length + i] = static_cast<std::uint8_t>(sum >> (24 - 8 * i));
    at += 12 + length;
  }
  return bytes;
}

void Read(Bytes input) {
  const auto bytes = std::as_bytes(input);
  const auto header = internal::ReadPngHeader(bytes);
  if (!header || std::uint64_t(header->width) * header->height > std::uint64_t(kMostPixels)) return;
  const auto stored = internal::InspectPlainPng(bytes);
  const auto picture = DecodePicture(bytes, "any.png");
  CheckRefusal(picture);
  if (!picture || !stored) return;
  SCUMBLE_CHECK_EQ(picture->width, stored->width);
  SCUMBLE_CHECK_EQ(picture->rgba.size(), std::size_t(4) * std::size_t(stored->width) * std::size_t(stored->height));
}

void FuzzPng(Bytes input) {
  if (!internal::IsPng(std::as_bytes(input))) return;
  Read(input);
  Read(WithRightSums(input));
}

}  // namespace
SCUMBLE_FUZZ_TARGET(png, FuzzPng)
}  // namespace scumble::fuzz
