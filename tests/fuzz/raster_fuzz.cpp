// Zip archives: pictures in layers (.ora, .kra), and every entry under any name.
#include "core/io/file/zip_archive.h"
#include "core/io/open_raster.h"
#include "core/io/picture_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {
namespace {

void FuzzRaster(Bytes input) {
  const auto path = InFile("layers.ora", input);
  const auto zip = ZipReader::Open(path);
  CheckRefusal(zip);
  if (!zip) return;
  constexpr std::size_t kLimit = 1 << 16;
  for (const std::string& name : zip->names()) {
    const auto bytes = zip->Read(name, kLimit);
    SCUMBLE_CHECK(!bytes || bytes->size() <= kLimit);
  }
  const auto header = InspectMergedLayers(path);
  if (!header || std::int64_t(header->width) * header->height > kMostPixels) return;
  const auto picture = ReadMergedLayers(path);
  if (picture) SCUMBLE_CHECK_EQ(picture->width * picture->height, header->width * header->height);
}

}  // namespace
SCUMBLE_FUZZ_TARGET(raster, FuzzRaster)
}  // namespace scumble::fuzz
