#include "apps/studio/session/exemplar_paint.h"

#include <fmt/format.h>
#include <unistd.h>

#include "core/image/hash.h"
#include "core/io/atomic_file.h"
#include "core/io/open_raster.h"
#include "core/io/picture_file.h"
#include "pipeline/requests.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

// Of the file's name, too: copies have the same bytes.
Expected<std::string> StampOf(const fs::path& file) {
  SCUMBLE_ASSIGN(const std::vector<std::byte> bytes, ReadWholeFile(file));
  return fmt::format("{:016x}", Hash(HashText(file.string()), HashBytes(std::span(bytes))));
}

}  // namespace

Expected<PaintTarget> FindPaintTarget(const fs::path& file) {
  PaintTarget target;
  target.file = file;
  target.layer = HasEnding(file.string(), {".ora"});
  if (!target.layer && !HasEnding(file.string(), {".png"})) {
    return UsageError("strokes can be put into .png and .ora files, not into " + file.filename().string() +
                      ": export it as one of these in your painting program");
  }
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (::access(file.c_str(), W_OK) != 0 || ::access(folder.c_str(), W_OK) != 0) {
    return UsageError(file.string() + " cannot be written: save the style as a new one");
  }
  if (!target.layer) {
    SCUMBLE_ASSIGN(const bool has_other_colors, HasOtherColors(file));
    if (has_other_colors) {
      return UsageError("strokes are put into PNGs in sRGB, and the profile of " + file.filename().string() +
                        " has other colours, which would be lost: convert it to sRGB, or export it as .ora");
    }
  }
  SCUMBLE_ASSIGN(target.stamp, StampOf(file));
  SCUMBLE_ASSIGN(const PictureHeader header, InspectPicture(file));
  target.width = header.width, target.height = header.height;
  return target;
}

Status PutStrokes(const fs::path& file, const std::string& stamp, std::span<const std::byte> strokes) {
  SCUMBLE_ASSIGN(const PaintTarget target, FindPaintTarget(file));
  const Error changed{ErrorKind::kCancelled, file.string() +
                                                 " was changed by another program meanwhile: your strokes "
                                                 "are kept on the page; load the file and save them again"};
  if (target.stamp != stamp) return changed;
  SCUMBLE_ASSIGN(const std::uint64_t pixels, CountPixels(strokes, "the strokes"));
  if (pixels != std::uint64_t(target.width) * target.height) {
    return UsageError(
        fmt::format("expected strokes of {}×{} pixels, the size of {}", target.width, target.height, file.string()));
  }
  SCUMBLE_ASSIGN(const Picture layer, DecodePicture(strokes, "the strokes"));
  if (layer.width != target.width) {
    return UsageError(fmt::format("the strokes are {}×{} pixels, {} is {}×{}", layer.width, layer.height, file.string(),
                                  target.width, target.height));
  }
  if (target.layer) {
    SCUMBLE_ASSIGN(const std::vector<std::byte> bytes, WithStrokes(file, "Scumble", layer));
    SCUMBLE_ASSIGN(const std::string now, StampOf(file));
    if (now != stamp) return changed;
    return WriteFileAtomically(file, bytes);
  }
  SCUMBLE_ASSIGN(const PictureHeader header, InspectPicture(file));
  SCUMBLE_ASSIGN(Picture picture, ReadPicture(file));
  PutOver(picture, layer);
  PictureWriteOptions options;
  options.bits = header.bits > 8 ? 16 : 8;
  options.dpi = int(header.dpi + 0.5);
  SCUMBLE_ASSIGN(const std::string now, StampOf(file));
  if (now != stamp) return changed;
  return WritePicture(file, picture, options);
}

}  // namespace scumble
