#include "io/picture_reader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <fstream>
#include <string_view>

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
    {"GIF8"sv, "gif"},
    {"SDPX"sv, "dpx"},
    {"XPDS"sv, "dpx"},
};

bool IsTga(const std::filesystem::path& name) {
  std::string ending = name.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".tga";
}

}  // namespace

Expected<std::string> ReaderFor(std::span<const std::byte> start, const std::filesystem::path& name) {
  const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
  for (const Mark& mark : kMarks) {
    if (text.size() >= mark.at && text.substr(mark.at).starts_with(mark.bytes)) return std::string(mark.reader);
  }
  if (IsTga(name)) return std::string("targa");
  return InputError("cannot read " + name.string() + ": " +
                    (start.empty() ? "it is empty" : "it does not begin as a picture") +
                    "; EXR, PNG, TIFF, JPEG, WebP, PSD, TGA, HDR, BMP, GIF and DPX are read");
}

Expected<std::string> ReaderFor(const std::filesystem::path& path) {
  std::array<char, 16> start{};
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), start.size());
  return ReaderFor(std::as_bytes(std::span(start)).first(static_cast<std::size_t>(file.gcount())), path);
}

}  // namespace scumble::internal
