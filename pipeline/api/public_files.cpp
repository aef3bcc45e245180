// The library's functions for picture files and for its data.
#include <fmt/format.h>

#include <filesystem>

#include "core/io/library.h"
#include "core/io/picture_file.h"
#include "scumble/data_folder.h"
#include "scumble/picture.h"

namespace scumble {
namespace {

// A picture's members are the caller's to fill.
Status CheckPicture(const std::string& file, const Picture& picture) {
  const bool has_size = picture.width > 0 && picture.height > 0;
  const std::size_t wanted = has_size ? std::size_t(4) * std::size_t(picture.width) * std::size_t(picture.height) : 0;
  if (has_size && picture.rgba.size() == wanted) return Ok();
  return UsageError(fmt::format("cannot write {}: the picture is {}×{} with {} values in rgba; expected {}", file,
                                picture.width, picture.height, picture.rgba.size(),
                                has_size ? fmt::format("{}, 4 · width · height", wanted) : "at least 1×1 pixels"));
}

}  // namespace

bool internal::UseDataFolder(const char* folder) {
  SetModuleFolder(std::filesystem::path(folder) / "../../lib/scumble");
  return true;
}

Expected<Picture> LoadPicture(const std::string& file) { return ReadPicture(file); }

Status SavePicture(const std::string& file, const Picture& picture, int bits) {
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(file, {bits}));
  SCUMBLE_RETURN_IF_ERROR(CheckPicture(file, picture));
  return WritePicture(file, picture, {bits});
}

}  // namespace scumble
