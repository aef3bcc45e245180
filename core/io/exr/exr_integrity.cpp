#include "core/io/exr/exr_integrity.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <istream>
#include <map>
#include <optional>
#include <streambuf>
#include <string_view>

#include "core/io/file/compression_bounds.h"

namespace scumble::internal {
namespace {

constexpr std::array<char, 4> kMagic = {0x76, 0x2f, 0x31, 0x01};
constexpr std::uint32_t kNotOnlyImages = 0x800, kManyParts = 0x1000;
constexpr std::size_t kLongestName = 255;

// The largest packing ratio, by the number in the header: none; rle, 64 to 1; zips, zip; piz, whose Huffman code of 510
// bytes in 9 bits is below Deflate's bound; pxr24, which leaves 3 bytes of 4 to Deflate; b44 and b44a, 32 bytes in 3;
// dwaa and dwab, which leave at least 4 bytes of a block of 8 × 8 floats to it.
constexpr std::uint64_t kMostPacked[] = {
    1,  64, kMostDeflated,      kMostDeflated,     kMostDeflated, kMostDeflated * 4 / 3,
    11, 11, 64 * kMostDeflated, 64 * kMostDeflated};

// A seekable stream over bytes in memory; nothing is copied.
class SpanBuffer : public std::streambuf {
 public:
  explicit SpanBuffer(std::span<const std::byte> bytes) {
    char* const begin = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));  // is only read
    setg(begin, begin, begin + bytes.size());
  }

 protected:
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    return offset == 0 && from == std::ios_base::cur ? pos_type(gptr() - eback()) : pos_type(off_type(-1));
  }
};

struct Part {
  std::uint64_t width = 0, height = 0, tile_pixels = 0;
  std::uint64_t pixel_bytes = 0;
  std::size_t compression = 0;
  bool is_deep = false;
};

std::uint32_t Number(const char* bytes) {  // the lowest byte first
  std::uint32_t number = 0;
  for (int i = 3; i >= 0; --i) number = number << 8 | static_cast<unsigned char>(bytes[i]);
  return number;
}

std::optional<std::uint32_t> ReadNumber(std::istream& file) {
  char bytes[4];
  if (!file.read(bytes, sizeof bytes)) return std::nullopt;
  return Number(bytes);
}

// Reads up to a NUL. Empty if the name is longer than any name may be.
std::optional<std::string> ReadName(std::istream& file) {
  std::string name;
  for (char c; file.get(c);) {
    if (c == '\0') return name;
    if (name.size() == kLongestName) break;
    name += c;
  }
  return std::nullopt;
}

// Bytes of one pixel, from a list of channels: name, NUL, type, 4 bytes, sampling in x and y; an empty name ends the
// list. Subsampled channels, which no guides have, count as 0: the bound stays valid. Empty if the list and its
// attribute end at different places, or a type is unknown: OpenImageIO would end the whole process.
std::optional<std::uint64_t> PixelBytes(const std::string& list) {
  constexpr std::size_t kBehindName = 16;
  constexpr std::uint32_t kHalf = 1, kFloat = 2;  // 0: whole numbers of 32 bits
  std::uint64_t bytes = 0;
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t end = list.find('\0', at);
    if (end == at) return at + 1 == list.size() ? std::optional(bytes) : std::nullopt;
    if (end == std::string::npos || list.size() - end - 1 < kBehindName) break;
    const char* const behind = list.data() + end + 1;
    if (Number(behind) > kFloat) return std::nullopt;
    const bool is_whole = Number(behind + 8) == 1 && Number(behind + 12) == 1;
    if (is_whole) bytes += Number(behind) == kHalf ? 2 : 4;
    at = end + 1 + kBehindName;
  }
  return std::nullopt;
}

// Whether an attribute is as long as its type requires. The library reads as many bytes as the type requires, and takes
// whatever follows for the next attribute. Texts and unknown types have the length that they state.
bool IsOfType(const std::string& type, const std::string& value) {
  static const std::map<std::string_view, std::size_t> kLengths = {{"box2f", 16},
                                                                   {"box2i", 16},
                                                                   {"chromaticities", 32},
                                                                   {"compression", 1},
                                                                   {"deepImageState", 1},
                                                                   {"double", 8},
                                                                   {"envmap", 1},
                                                                   {"float", 4},
                                                                   {"int", 4},
                                                                   {"keycode", 28},
                                                                   {"lineOrder", 1},
                                                                   {"m33d", 72},
                                                                   {"m33f", 36},
                                                                   {"m44d", 128},
                                                                   {"m44f", 64},
                                                                   {"rational", 8},
                                                                   {"tiledesc", 9},
                                                                   {"timecode", 8},
                                                                   {"v2d", 16},
                                                                   {"v2f", 8},
                                                                   {"v2i", 8},
                                                                   {"v3d", 24},
                                                                   {"v3f", 12},
                                                                   {"v3i", 12}};
  if (const auto known = kLengths.find(type); known != kLengths.end()) return value.size() == known->second;
  if (type == "floatvector") return value.size() % 4 == 0;
  if (type == "chlist") return PixelBytes(value).has_value();
  if (type != "preview") return true;
  const std::uint64_t pixels = value.size() < 8 ? 0 : std::uint64_t(Number(value.data())) * Number(value.data() + 4);
  return value.size() >= 8 && pixels == (value.size() - 8) / 4 && value.size() % 4 == 0;
}

// In 64 bits, because a damaged header may hold any numbers.
std::uint64_t Side(const char* least, const char* most) {
  const std::int64_t side = std::int64_t(std::int32_t(Number(most))) - std::int32_t(Number(least)) + 1;
  return static_cast<std::uint64_t>(std::max<std::int64_t>(side, 0));
}

void Take(const std::string& name, const std::string& type, const std::string& value, Part& part) {
  if (name == "dataWindow" && type == "box2i") {
    part.width = Side(value.data(), value.data() + 8), part.height = Side(value.data() + 4, value.data() + 12);
  } else if (name == "tiles" && type == "tiledesc") {
    part.tile_pixels = std::uint64_t(Number(value.data())) * Number(value.data() + 4);
  } else if (name == "channels" && type == "chlist") {
    part.pixel_bytes = PixelBytes(value).value_or(0);
  } else if (name == "compression" && type == "compression") {
    part.compression = static_cast<unsigned char>(value[0]);
  } else if (name == "type") {
    part.is_deep = value.starts_with("deep");
  }
}

Status CheckPart(const Part& part, std::uint64_t file_bytes, const std::string& name) {
  if (part.is_deep) {
    return InputError("cannot read " + name +
                      ": it holds deep pixels, and flat ones are expected; flatten it, or save " +
                      "its flat parts as a file of their own");
  }
  const std::string size = std::to_string(part.width) + "×" + std::to_string(part.height) + " pixels";
  constexpr std::uint64_t kAnyTile = 1 << 20;  // may be larger than the picture
  if (part.tile_pixels > std::max(kAnyTile, part.width * part.height)) {
    return InputError("cannot read " + name + ": its tiles of " + std::to_string(part.tile_pixels) +
                      " pixels are larger than its picture of " + size + "; it is damaged, copy or save it again");
  }
  if (part.compression >= std::size(kMostPacked)) return Ok();  // unknown here; reported later
  const std::uint64_t pixel_bytes = std::max<std::uint64_t>(part.pixel_bytes, 1);
  // Divided, because the product may not fit: the sides are below 2³².
  if (part.width * part.height / kMostPacked[part.compression] <= file_bytes / pixel_bytes) return Ok();
  return InputError("cannot read " + name + ": it declares " + size + " of " + std::to_string(pixel_bytes) +
                    " bytes, more than its " + std::to_string(file_bytes) +
                    " bytes can hold; it is damaged, copy or save it again");
}

Status Check(std::istream& file, std::uint64_t file_bytes, const std::string& name) {
  std::array<char, 4> magic{};
  if (!file.read(magic.data(), magic.size()) || magic != kMagic) return Ok();
  const auto version = ReadNumber(file);
  if (!version) return Ok();
  // If neither flag is set, the library takes a part for an image, whatever an attribute calls it.
  const bool may_be_deep = *version & (kNotOnlyImages | kManyParts);
  bool is_first = true;
  for (Part part;;) {
    const auto attribute = ReadName(file);
    if (!attribute) return Ok();
    if (attribute->empty()) {  // the header's end; of several, the last one is empty
      if (is_first && (*version & kManyParts)) return Ok();
      part.is_deep = part.is_deep && may_be_deep;
      SCUMBLE_RETURN_IF_ERROR(CheckPart(part, file_bytes, name));
      if (!(*version & kManyParts)) return Ok();
      part = Part(), is_first = true;
      continue;
    }
    is_first = false;
    const auto type = ReadName(file);
    const auto bytes = type ? ReadNumber(file) : std::nullopt;
    if (!bytes) return Ok();
    const std::uint64_t left = file_bytes - static_cast<std::uint64_t>(file.tellg());
    if (*bytes > left) {
      return InputError("cannot read " + name + ": " + std::to_string(*bytes) +
                        " bytes of its header stand beyond its end; " + "it is damaged, copy or save it again");
    }
    std::string value(*bytes, '\0');
    if (!file.read(value.data(), static_cast<std::streamsize>(value.size()))) return Ok();
    if (!IsOfType(*type, value)) {
      return InputError("cannot read " + name + ": an attribute of its header is no " + *type +
                        ", as which it is marked; it is damaged, copy or save it again");
    }
    Take(*attribute, *type, value, part);
  }
}

}  // namespace

Status CheckExrIntegrity(const std::filesystem::path& path) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) return Ok();
  const auto bytes = std::filesystem::file_size(path, failed);
  if (failed) return Ok();
  std::ifstream file(path, std::ios::binary);
  return Check(file, bytes, path.string());
}

Status CheckExrIntegrity(std::span<const std::byte> bytes, const std::string& name) {
  const char* const begin = reinterpret_cast<const char*>(bytes.data());
  if (bytes.size() < kMagic.size() || !std::equal(kMagic.begin(), kMagic.end(), begin)) return Ok();
  SpanBuffer buffer(bytes);
  std::istream file(&buffer);
  return Check(file, bytes.size(), name);
}

}  // namespace scumble::internal
