// Where OpenImageIO is: in a module that is loaded when a file first needs it. Loading that library with all that it
// brings along takes a fifth of a second of looking up names, and a picture in PNG of a scene without EXR or JPEG needs
// none of it; nor do Scumble's own guides and the writing of EXR pictures, for which core/io/exr/scanline_exr.h is
// enough. Everybody else calls the functions of picture_file.h, channel_file.h, guide_file.h and existing_output.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "core/image/channel_image.h"
#include "core/image/guides.h"
#include "core/image/status.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "scumble/picture.h"

namespace scumble {

// The attribute that says what a picture or guides were made with.
inline constexpr const char* kSettingsKey = "scumble:settings";

// A picture file as it is stored.
struct StoredPicture {
  int width = 0, height = 0;  // of the display window
  int channels = 0;
  int bits = 0;          // a channel
  std::string settings;  // of kSettingsKey
};

namespace formats {

// What the functions of these names outside of this namespace do, for files that need the library. It writes no file
// itself: that is WriteFileAtomically's, of which the module would have a copy that no handler of signals knows.
Expected<Picture> ReadPicture(const std::filesystem::path& path);
Expected<Picture> DecodePicture(std::span<const std::byte> bytes, const std::string& name);
Expected<PictureHeader> InspectPicture(const std::filesystem::path& path);
Expected<PictureHeader> InspectEncoded(std::span<const std::byte> bytes, const std::string& name);  // in memory
Expected<StoredPicture> InspectStored(const std::filesystem::path& path);
Expected<std::vector<std::byte>> EncodePicture(const std::filesystem::path& path, const Picture& picture,
                                               const PictureWriteOptions& options);
Expected<ChannelImage> ReadChannels(const std::filesystem::path& path);
Expected<GuideSet> ReadGuides(const std::filesystem::path& path, const GuideReadOptions& options);
Expected<GuideFileInfo> InspectGuides(const std::filesystem::path& path);
void SetThreads(int threads);

}  // namespace formats

// Sizes of what goes to and from the module, in one number: two builds of one version may still differ in them.
inline constexpr std::uint64_t kFormatsLayout = [] {
  constexpr std::uint64_t kOffset = 0xcbf29ce484222325u, kPrime = 0x100000001b3u;  // FNV-1a's
  std::uint64_t layout = kOffset;
  for (const std::size_t size :
       {sizeof(Expected<Picture>), sizeof(Picture), sizeof(PictureHeader), sizeof(StoredPicture),
        sizeof(PictureWriteOptions), sizeof(ChannelImage), sizeof(GuideSet), sizeof(GuideReadOptions),
        sizeof(GuideFileInfo), sizeof(Expected<std::vector<std::byte>>), sizeof(LayerSet), sizeof(Error),
        sizeof(std::string), sizeof(std::filesystem::path)}) {
    layout = (layout ^ size) * kPrime;
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
  decltype(&formats::EncodePicture) encode_picture;
  decltype(&formats::ReadChannels) read_channels;
  decltype(&formats::ReadGuides) read_guides;
  decltype(&formats::InspectGuides) inspect_guides;
  decltype(&formats::SetThreads) set_threads;
};

// Loads the module, once in the life of the process; it stays. kUnavailable where it is missing or of another version,
// kMemory where a limit leaves it too few addresses; the next call tries again then. `file`, for the message, is what
// it is needed for. Thread-safe.
Expected<const Formats*> LoadFormats(const std::string& file);
// The same to read a file, which is looked for first: what is wrong with it (kInput) is said whatever the module needs.
Expected<const Formats*> LoadFormatsToRead(const std::filesystem::path& path);

namespace internal {

// As SetIoThreads had it; 0: all.
int IoThreads();

}  // namespace internal
}  // namespace scumble
