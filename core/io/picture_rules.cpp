#include "core/io/picture_rules.h"

#include <algorithm>
#include <cctype>
#include <iterator>

#include "core/io/picture_file.h"

namespace scumble {

namespace internal {
std::string Upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

double TrueDpi(double dpi) {
  constexpr double kLeast = 97, kMost = 20000;
  return dpi >= kLeast && dpi <= kMost ? dpi : 0.0;
}
}  // namespace internal

int PictureBits(const std::filesystem::path& path, const PictureWriteOptions& options) {
  const std::string ending = internal::Upper(path.extension().string());
  if (ending == ".EXR") return options.bits == 32 ? 32 : 16;
  return ending == ".JPG" || ending == ".JPEG" ? 8 : options.bits;
}

Status CheckPictureTarget(const std::filesystem::path& path, const PictureWriteOptions& options) {
  const std::string ending = internal::Upper(path.extension().string());
  constexpr const char* kEndings[] = {".EXR", ".JPG", ".JPEG", ".PNG", ".TIF", ".TIFF"};
  if (std::find(std::begin(kEndings), std::end(kEndings), ending) == std::end(kEndings)) {
    return UsageError("cannot write " + path.string() + ": the ending '" + path.extension().string() +
                      "' is not one of .png, .tif, .jpg, .exr");
  }
  if ((ending == ".JPG" || ending == ".JPEG") && options.bits != 8) {
    return UsageError(path.string() + ": " + std::to_string(options.bits) +
                      " bits asked for, and JPEG has 8: name it .png, .tif or .exr, or leave --bits out");
  }
  if (ending == ".EXR" && options.bits != 8 && options.bits != 16 && options.bits != 32) {
    return UsageError(path.string() + ": " + std::to_string(options.bits) +
                      " bits asked for; .exr takes 16, half floats, or 32, floats");
  }
  if (ending != ".EXR" && options.bits != 8 && options.bits != 16) {
    return UsageError(path.string() + ": " + std::to_string(options.bits) + " bits asked for; " +
                      path.extension().string() + " takes 8 or 16, and only .exr takes 32");
  }
  return Ok();
}

std::vector<std::uint8_t> In8Bits(const Picture& picture) {
  std::vector<std::uint8_t> bytes(picture.rgba.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>((picture.rgba[i] + 128u) / 257u);
  return bytes;
}

}  // namespace scumble
