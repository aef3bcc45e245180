// Loads OpenImageIO, in a module, when a file first needs it. Loading that library with its dependencies takes a fifth
// of a second of symbol lookup. A PNG picture of a scene without EXR or JPEG needs none of it. Scumble's own guides and
// written EXR and TIFF pictures do not either: core/io/exr/scanline_exr.h and core/io/picture/tiff_writer.h serve them.
// All other code calls the functions of picture_file.h, channel_file.h, guide_file.h and existing_output.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "core/image/channel_image.h"
#include "core/image/guides.h"
#include "core/image/hash.h"
#include "core/image/status.h"
#include "core/io/guide_file.h"
#include "core/io/oiio/formats.h"
#include "core/io/picture_file.h"
#include "scumble/picture.h"

namespace scumble {

// The attribute that holds the settings of a picture or guides.
inline constexpr const char* kSettingsKey = "scumble:settings";

// The sizes of the types that cross the module's boundary, hashed to one number: two builds of one version may still
// differ in them.
inline constexpr std::uint64_t kFormatsLayout = [] {
  std::uint64_t layout = 0;
  for (const std::size_t size :
       {sizeof(Expected<Picture>), sizeof(Picture), sizeof(PictureHeader), sizeof(StoredPicture),
        sizeof(PictureWriteOptions), sizeof(PictureLosses), sizeof(ChannelImage), sizeof(GuideSet),
        sizeof(GuideReadOptions), sizeof(GuideFileInfo), sizeof(Expected<std::vector<std::byte>>), sizeof(LayerSet),
        sizeof(Error), sizeof(std::string), sizeof(std::filesystem::path)}) {
    layout = HashOn(layout, size);
  }
  return layout;
}();

// The module's only export, `scumble_formats_` and the version, as in scumble_formats_0_1_0, is one of these.
struct Formats {
  std::uint64_t layout = 0;  // the module's own kFormatsLayout
  decltype(&formats::ReadPicture) read_picture;
  decltype(&formats::DecodePicture) decode_picture;
  decltype(&formats::InspectPicture) inspect_picture;
  decltype(&formats::InspectEncoded) inspect_encoded;
  decltype(&formats::InspectStored) inspect_stored;
  decltype(&formats::EncodeJpeg) encode_jpeg;
  decltype(&formats::ReadChannels) read_channels;
  decltype(&formats::ReadGuides) read_guides;
  decltype(&formats::InspectGuides) inspect_guides;
  decltype(&formats::SetThreads) set_threads;
};

// Loads the module, once in the life of the process; it stays loaded. kUnavailable if the module is missing or of
// another version. kMemory if a limit leaves too little address space. After an error the next call tries again. `file`
// names, for the message, the file that needs the module. Thread-safe.
Expected<const Formats*> LoadFormats(const std::string& file);
// LoadFormats for reading a file. The file is checked first, so that its own error (kInput) comes before the module's.
Expected<const Formats*> LoadFormatsToRead(const std::filesystem::path& path);

namespace internal {

// The number that SetIoThreads set; 0: all.
int IoThreads();

}  // namespace internal
}  // namespace scumble
