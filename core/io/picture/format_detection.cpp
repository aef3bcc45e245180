#include "core/io/picture/format_detection.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <fstream>
#include <initializer_list>
#include <string_view>

#include "core/image/guides.h"

namespace scumble::internal {
namespace {

using namespace std::string_view_literals;

struct Mark {
  std::string_view bytes;
  const char* reader;
  std::size_t at = 0;  // bytes from the beginning
};

constexpr Mark kMarks[] = {
    {"\x76\x2f\x31\x01"sv, "openexr"},
    {"\x89PNG\r\n\x1a\n"sv, "png"},
    {"\xff\xd8\xff"sv, "jpeg"},
    {"II*\0"sv, "tiff"},
    {"MM\0*"sv, "tiff"},
    {"II+\0"sv, "tiff"},  // BigTIFF
    {"MM\0+"sv, "tiff"},
    {"8BPS"sv, "psd"},
    {"#?"sv, "hdr"},
    {"WEBP"sv, "webp", 8},
    {"BM"sv, "bmp"},
    {"P1"sv, "pnm"},
    {"P2"sv, "pnm"},
    {"P3"sv, "pnm"},
    {"P4"sv, "pnm"},
    {"P5"sv, "pnm"},
    {"P6"sv, "pnm"},
    {"PF"sv, "pnm"},
    {"Pf"sv, "pnm"},
    {"ftyphei"sv, "heif", 4},
    {"ftypmif1"sv, "heif", 4},
    {"ftypavif"sv, "heif", 4},
    {"\0\0\0\x0cjP  "sv, "jpeg2000"},
    {"\xff\x4f\xff\x51"sv, "jpeg2000"},
};

// Formats whose OpenImageIO readers are unsafe. They read beyond the file's end or loop for ever, allocate any declared
// size, or end the process at an unknown number.
constexpr Mark kNotRead[] = {
    {"GIF8"sv, "a GIF"}, {"DDS "sv, "a DDS"}, {"SDPX"sv, "a DPX"}, {"XPDS"sv, "a DPX"}, {"\x01\xda"sv, "an SGI"}};

bool EndsIn(const std::filesystem::path& name, std::initializer_list<std::string_view> endings) {
  std::string ending = name.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

// Most of these begin like TIFF files, whose reader would show the small preview in them.
bool IsRawPhotograph(const std::filesystem::path& name) {
  return EndsIn(
      name, {".3fr", ".arw", ".cr2", ".cr3", ".crw", ".dcr", ".dng", ".erf", ".fff", ".iiq", ".kdc", ".mef", ".mos",
             ".mrw", ".nef", ".nrw", ".orf", ".pef", ".raf", ".raw", ".rw2", ".rwl", ".sr2", ".srf", ".srw", ".x3f"});
}

struct Bound {
  const char* reader;
  std::uint64_t samples;
};

// The tightest packing of each format, after OpenImageIO has expanded palettes and bits into separate channels.
constexpr Bound kBounds[] = {
    {"pnm", 8},              // a bit a pixel
    {"bmp", 8 * 3},          // a bit a pixel, of a palette of three channels
    {"hdr", 64},             // 2 bytes a run of 127
    {"targa", 128 * 4 / 2},  // 2 bytes a run of 128 pixels, of a palette of 4 channels
    {"psd", 64 * 8 * 3},     // 2 bytes a run of 128, of a bit a pixel, shown as three channels
};

}  // namespace

std::uint64_t MostSamplesInAByte(std::string_view reader) {
  for (const Bound& bound : kBounds) {
    if (reader == bound.reader) return bound.samples;
  }
  return 0;
}

Expected<std::string> ReaderFor(std::span<const std::byte> start, const std::filesystem::path& name) {
  const std::string failure = "cannot read " + name.string() + ": ";
  if (IsRawPhotograph(name))
    return InputError(failure + "it is a camera's raw photograph; develop it into a TIFF of 16 bits first");
  const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
  for (const Mark& mark : kNotRead) {
    if (text.starts_with(mark.bytes)) {
      return InputError(failure + "it is " + mark.reader + ", which is not read; save it as a PNG");
    }
  }
  for (const Mark& mark : kMarks) {
    if (text.size() >= mark.at && text.substr(mark.at).starts_with(mark.bytes)) return std::string(mark.reader);
  }
  if (EndsIn(name, {".tga", ".tpic"})) return std::string("targa");
  return InputError(failure + (start.empty() ? "it is empty" : "it does not begin as a picture") +
                    "; EXR, PNG, TIFF, JPEG, WebP, HEIC, PSD, TGA, HDR, PNM, BMP and JPEG 2000 are read");
}

Status CheckStart(std::string_view reader, std::span<const std::byte> start, const std::string& name) {
  const std::string failure = "cannot read " + name + ": ";
  const auto byte = [&](std::size_t at) { return at < start.size() ? std::to_integer<std::uint64_t>(start[at]) : 0; };
  if (reader == "bmp" && byte(14) >= 40 && (byte(30) == 1 || byte(30) == 2)) {
    return InputError(failure + "it is a BMP packed by runs, which is not read; save it as a PNG");
  }
  // OpenImageIO reads colours beyond the end of a short palette, and before the beginning of one that starts late.
  const bool indexed = reader == "targa" && (byte(2) == 1 || byte(2) == 9);
  if (indexed && (byte(16) != 8 || byte(3) != 0 || byte(4) != 0 || (byte(6) << 8 | byte(5)) < 256)) {
    return InputError(failure + "it is a TGA whose palette is not of 256 colours, which is not read; save it as a PNG");
  }
  return Ok();
}

Error DeclaredSizeError(const std::string& name, std::uint64_t bytes) {
  return InputError("cannot read " + name + ": its header declares more than its " + std::to_string(bytes) +
                    " bytes hold; it may be cut short or damaged");
}

Expected<std::vector<std::byte>> ReadStart(const std::filesystem::path& path) {
  std::array<char, kStartBytes> start{};
  std::ifstream file(path, std::ios::binary);
  if (!file) return InputError("cannot read " + path.string() + ": it cannot be opened any more");
  file.read(start.data(), start.size());
  const auto bytes = std::as_bytes(std::span(start)).first(static_cast<std::size_t>(file.gcount()));
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

}  // namespace scumble::internal
