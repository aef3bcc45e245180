// The functions of the module of formats (core/io/format_dispatch.h).
#pragma once

#include <cstddef>
#include <filesystem>
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

// A picture file as it is stored.
struct StoredPicture {
  int width = 0, height = 0;  // of the display window
  int channels = 0;
  int bits = 0;          // a channel
  std::string settings;  // of kSettingsKey
};

namespace formats {

// The library's versions of the functions of these names outside of this namespace. The module writes no file itself:
// it would have its own copy of WriteFileAtomically, whose temporary files no signal handler removes.
Expected<Picture> ReadPicture(const std::filesystem::path& path, const std::string& view_layer, Profiles profiles,
                              PictureLosses* losses);
Expected<Picture> DecodePicture(std::span<const std::byte> bytes, const std::string& name, Profiles profiles);
Expected<PictureHeader> InspectPicture(const std::filesystem::path& path);
Expected<PictureHeader> InspectEncoded(std::span<const std::byte> bytes, const std::string& name);  // in memory
Expected<StoredPicture> InspectStored(const std::filesystem::path& path);
Expected<std::vector<std::byte>> EncodeJpeg(const std::filesystem::path& path, const Picture& picture,
                                            const PictureWriteOptions& options);
Expected<ChannelImage> ReadChannels(const std::filesystem::path& path);
Expected<GuideSet> ReadGuides(const std::filesystem::path& path, const GuideReadOptions& options);
Expected<GuideFileInfo> InspectGuides(const std::filesystem::path& path);
void SetThreads(int threads);

}  // namespace formats

}  // namespace scumble
