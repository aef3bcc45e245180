#include "core/io/picture_file.h"

#include <array>
#include <fstream>
#include <string_view>
#include <utility>
#include <vector>

#include "core/image/color.h"
#include "core/io/atomic_file.h"
#include "core/io/color_profile.h"
#include "core/io/exr/scanline_exr.h"
#include "core/io/file/zip_archive.h"
#include "core/io/format_dispatch.h"
#include "core/io/guide_file.h"
#include "core/io/open_raster.h"
#include "core/io/picture/tiff_writer.h"
#include "core/io/picture_rules.h"
#include "core/io/png/png_integrity.h"
#include "core/io/png/png_reader.h"
#include "core/io/png_writer.h"

namespace scumble {
namespace {

// Reads a complete plain PNG only.
std::optional<Picture> ReadIfPlainPng(std::span<const std::byte> bytes, const std::string& name, Profiles profiles,
                                      PictureLosses* losses) {
  if (!internal::IsPng(bytes) || !internal::CheckPngIntegrity(bytes, name)) return std::nullopt;
  return internal::ReadPlainPng(bytes, profiles, losses);
}

std::optional<PictureHeader> HeaderIfPlainPng(const std::filesystem::path& path) {
  constexpr std::size_t kMostBeforePixels = 1 << 18;  // bytes; where more comes before them, the library reads it
  std::vector<std::byte> start(kMostBeforePixels);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(start.data()), std::streamsize(start.size()));
  return internal::PlainPngHeader(std::span<const std::byte>(start).first(static_cast<std::size_t>(file.gcount())));
}

Expected<std::uint64_t> PixelsOf(std::int64_t width, std::int64_t height, const std::string& name) {
  if (width >= 1 && height >= 1 && width <= kMaxImageSide && height <= kMaxImageSide &&
      width * height <= kMaxPicturePixels) {
    return static_cast<std::uint64_t>(width * height);
  }
  return InputError("cannot read " + name + ": no picture of " + std::to_string(width) + "×" + std::to_string(height) +
                    " is read, at most " + std::to_string(kMaxPicturePixels) + " pixels are");
}

// The pixels of a PNG of that many bytes.
Expected<std::uint64_t> PixelsOf(const internal::PngHeader& header, std::uint64_t bytes, const std::string& name) {
  if (!internal::CanHold(bytes, header))
    return InputError("cannot read " + name + ": it promises more than it can hold");
  return PixelsOf(header.width, header.height, name);
}

std::vector<std::byte> Png(const Picture& picture, const PictureWriteOptions& options) {
  return internal::WritePng(
      picture, {options.bits, options.grey, options.png_level, options.dpi, options.settings, internal::IoThreads()});
}

// Linear, with associated alpha.
Expected<std::vector<std::byte>> Exr(const std::string& name, const Picture& picture,
                                     const PictureWriteOptions& options) {
  internal::ExrImage image{picture.width, picture.height, {}, options.fast ? kFastCompression : "zip", {}, {}, {}};
  if (!options.settings.empty()) image.texts[kSettingsKey] = options.settings;
  const std::size_t size = picture.rgba.size() / 4;
  std::array<std::vector<float>, 4> planes;
  for (std::size_t c = 0; c < planes.size(); ++c) {
    planes[c].resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      const float alpha = static_cast<float>(picture.rgba[4 * i + 3]) / 65535.0f;
      planes[c][i] = c == 3 ? alpha : Srgb16ToLinear(picture.rgba[4 * i + c]) * alpha;
    }
    image.channels.push_back({std::string(1, "RGBA"[c]), options.bits != 32, planes[c]});
  }
  return internal::EncodeExr(name, image);
}

}  // namespace

Expected<Picture> ReadPicture(const std::filesystem::path& path, const std::string& view_layer, Profiles profiles,
                              PictureLosses* losses) {
  if (losses) *losses = {};
  if (IsZip(path)) return ReadMergedLayers(path);
  if (internal::IsPngFile(path)) {
    SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path));
    if (auto picture = ReadIfPlainPng(bytes, path.string(), profiles, losses)) return *std::move(picture);
  }
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormatsToRead(path));
  return formats->read_picture(path, view_layer, profiles, losses);
}

Expected<PictureHeader> InspectPicture(const std::filesystem::path& path) {
  if (IsZip(path)) {
    SCUMBLE_ASSIGN(const MergedHeader merged, InspectMergedLayers(path));
    return PictureHeader{merged.width, merged.height, merged.bits, 0};
  }
  if (internal::IsPngFile(path)) {
    if (const auto header = HeaderIfPlainPng(path)) return *header;
  }
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormatsToRead(path));
  return formats->inspect_picture(path);
}

Expected<bool> HasOtherColors(const std::filesystem::path& png) {
  constexpr int kCode = 257;  // of 8 bits
  SCUMBLE_ASSIGN(const std::vector<std::byte> bytes, ReadWholeFile(png));
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.substr(0, text.find("IDAT")).find("iCCP") == std::string_view::npos) return false;
  const std::vector<std::byte> profile = internal::PngProfile(bytes);
  if (!profile.empty() && internal::IsAlwaysIgnored(profile)) return false;
  PictureLosses losses;
  SCUMBLE_RETURN_IF_ERROR(ReadPicture(png, {}, Profiles::kApply, &losses));
  return losses.profile_change >= kCode;
}

bool NeedsOpenImageIo(const std::filesystem::path& path) {
  std::error_code failed;
  if (!std::filesystem::exists(path, failed)) return internal::Upper(path.extension().string()) != ".PNG";
  return !IsZip(path) && !(internal::IsPngFile(path) && HeaderIfPlainPng(path));
}

Expected<Picture> DecodePicture(std::span<const std::byte> bytes, const std::string& name, Profiles profiles) {
  if (bytes.empty()) return InputError("cannot read " + name + ": it is empty");
  if (auto picture = ReadIfPlainPng(bytes, name, profiles, nullptr)) return *std::move(picture);
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormats(name));
  return formats->decode_picture(bytes, name, profiles);
}

Expected<std::uint64_t> CountPixels(const std::filesystem::path& path) {
  if (internal::IsPngFile(path)) {
    std::array<std::byte, internal::kPngHeaderBytes> start;
    std::ifstream file(path, std::ios::binary);
    std::error_code failed;
    const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
    if (!failed && file.read(reinterpret_cast<char*>(start.data()), start.size())) {
      if (const auto header = internal::ReadPngHeader(start)) return PixelsOf(*header, bytes, path.string());
    }
  }
  if (IsZip(path)) {
    SCUMBLE_ASSIGN(const MergedHeader merged, InspectMergedLayers(path));
    return PixelsOf(merged.width, merged.height, path.string());
  }
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormatsToRead(path));
  SCUMBLE_ASSIGN(const StoredPicture stored, formats->inspect_stored(path));
  return PixelsOf(stored.width, stored.height, path.string());
}

Expected<std::uint64_t> CountPixels(std::span<const std::byte> bytes, const std::string& name) {
  if (const auto header = internal::ReadPngHeader(bytes)) return PixelsOf(*header, bytes.size(), name);
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormats(name));
  SCUMBLE_ASSIGN(const PictureHeader header, formats->inspect_encoded(bytes, name));
  return PixelsOf(header.width, header.height, name);
}

Status WritePicture(const std::filesystem::path& path, const Picture& picture, const PictureWriteOptions& options) {
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(path, options));
  if (picture.empty()) return OutputError("cannot write " + path.string() + ": the picture is empty");
  const std::string ending = internal::Upper(path.extension().string());
  if (ending == ".PNG") return WriteFileAtomically(path, Png(picture, options));
  if (ending == ".EXR") {
    SCUMBLE_ASSIGN(const auto encoded, Exr(path.string(), picture, options));
    return WriteFileAtomically(path, encoded);
  }
  if (ending == ".TIF" || ending == ".TIFF") {
    SCUMBLE_ASSIGN(
        const auto encoded,
        internal::EncodeTiff(path.string(), picture, {options.bits, options.grey, options.dpi, internal::IoThreads()}));
    return WriteFileAtomically(path, encoded);
  }
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormats(path.string()));
  SCUMBLE_ASSIGN(const std::vector<std::byte> encoded, formats->encode_jpeg(path, picture, options));
  return WriteFileAtomically(path, encoded);
}

Expected<std::vector<std::byte>> EncodePng(const Picture& picture, int dpi) {
  if (picture.empty()) return OutputError("cannot write picture.png: the picture is empty");
  PictureWriteOptions options;
  options.dpi = dpi;
  return Png(picture, options);
}

}  // namespace scumble
