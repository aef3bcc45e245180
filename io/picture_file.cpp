#include "io/picture_file.h"

#include <utility>

#include "io/atomic_file.h"
#include "io/formats.h"
#include "io/open_raster.h"
#include "io/picture_rules.h"
#include "io/png_reader.h"
#include "io/png_writer.h"
#include "io/whole_png.h"
#include "io/zip_archive.h"

namespace scumble {
namespace {

// A PNG that is whole and plain; nothing else.
std::optional<Picture> ReadIfPlainPng(std::span<const std::byte> bytes, const std::string& name) {
  if (!internal::IsPng(bytes) || !internal::CheckPngIsWhole(bytes, name)) return std::nullopt;
  return internal::ReadPlainPng(bytes);
}

std::vector<std::byte> Png(const Picture& picture, const PictureWriteOptions& options) {
  return internal::WritePng(picture, {options.bits, options.grey, options.png_level, options.dpi, options.settings,
                                      internal::IoThreads()});
}

}  // namespace

Expected<Picture> ReadPicture(const std::filesystem::path& path) {
  if (IsZip(path)) return ReadMergedLayers(path);
  if (internal::IsPngFile(path)) {
    SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path));
    if (auto picture = ReadIfPlainPng(bytes, path.string())) return *std::move(picture);
  }
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormats());
  return formats->read_picture(path);
}

Expected<PictureHeader> InspectPicture(const std::filesystem::path& path) {
  if (IsZip(path)) {
    SCUMBLE_ASSIGN(const MergedHeader merged, InspectMergedLayers(path));
    return PictureHeader{merged.width, merged.height, merged.bits, 0};
  }
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormats());
  return formats->inspect_picture(path);
}

Expected<Picture> DecodePicture(std::span<const std::byte> bytes, const std::string& name) {
  if (bytes.empty()) return InputError("cannot read " + name + ": it is empty");
  if (auto picture = ReadIfPlainPng(bytes, name)) return *std::move(picture);
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormats());
  return formats->decode_picture(bytes, name);
}

Status WritePicture(const std::filesystem::path& path, const Picture& picture, const PictureWriteOptions& options) {
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(path, options));
  // What the picture library says of an empty one serves for all.
  if (internal::Upper(path.extension().string()) == ".PNG" && !picture.empty()) {
    return WriteFileAtomically(path, Png(picture, options));
  }
  SCUMBLE_ASSIGN(const Formats* const formats, LoadFormats());
  SCUMBLE_ASSIGN(const std::vector<std::byte> encoded, formats->encode_picture(path, picture, options));
  return WriteFileAtomically(path, encoded);
}

Expected<std::vector<std::byte>> EncodePng(const Picture& picture, int dpi) {
  if (picture.empty()) return OutputError("cannot write picture.png: the picture is empty");
  PictureWriteOptions options;
  options.dpi = dpi;
  return Png(picture, options);
}

}  // namespace scumble
