// Pictures of every format but EXR, PNG and layers, which have targets of their own: from memory, as in a .glb, and
// from a file. The pixel count from the header must agree with the picture that is read.
#include "core/io/file/zip_archive.h"
#include "core/io/picture/format_detection.h"
#include "core/io/picture_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {
namespace {

void CheckPicture(const Expected<Picture>& picture, std::uint64_t counted) {
  CheckRefusal(picture);
  if (!picture) return;
  SCUMBLE_CHECK_EQ(picture->rgba.size(), std::size_t(4) * std::size_t(picture->width) * std::size_t(picture->height));
  SCUMBLE_CHECK_EQ(std::uint64_t(picture->width) * std::uint64_t(picture->height), counted);
}

void FuzzPicture(Bytes input) {
  const auto bytes = std::as_bytes(input);
  const std::string name = "any.tga";  // the one format that is known by its name
  const auto reader = internal::ReaderFor(bytes.first(std::min(bytes.size(), internal::kStartBytes)), name);
  CheckRefusal(reader);
  if (!reader || *reader == "openexr" || *reader == "png") return;
  const auto in_memory = CountPixels(bytes, name);
  CheckRefusal(in_memory);
  if (in_memory && *in_memory <= std::uint64_t(kMostPixels)) CheckPicture(DecodePicture(bytes, name), *in_memory);
  const auto path = InFile(name, input);
  if (IsZip(path)) return;
  const auto in_file = CountPixels(path);
  CheckRefusal(in_file);
  if (in_file && *in_file <= std::uint64_t(kMostPixels)) CheckPicture(ReadPicture(path), *in_file);
}

}  // namespace
SCUMBLE_FUZZ_TARGET(picture, FuzzPicture)
}  // namespace scumble::fuzz
