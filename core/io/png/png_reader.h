// Reads plain PNG files by libpng, without the picture library, which takes a fifth of a second to load.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/channel_image.h"
#include "core/io/format_dispatch.h"
#include "core/io/picture_file.h"
#include "scumble/picture.h"

namespace scumble::internal {

// The picture in a complete PNG file (CheckPngIntegrity), as ReadPicture gives it. Empty if the file is damaged,
// exceeds the largest picture, or needs the picture library: for Exif, XMP, an offset, a linear gamma, or texts about
// colour spaces. That library then reads it, or reports the error. Thread-safe.
// `losses`, if given, gets what the profile changes.
std::optional<Picture> ReadPlainPng(std::span<const std::byte> bytes, Profiles profiles = Profiles::kApply,
                                    PictureLosses* losses = nullptr);

// Its channels, as ReadChannels gives them. `name` is the image's.
std::optional<ChannelImage> ReadPlainPngChannels(std::span<const std::byte> bytes, const std::string& name);

// That file's header, as `InspectStored` and as `InspectPicture` give it: for the same files, complete or not.
std::optional<StoredPicture> InspectPlainPng(std::span<const std::byte> bytes);
std::optional<PictureHeader> PlainPngHeader(std::span<const std::byte> bytes);

// The ICC profile of any PNG file, from what stands before its pixels; empty if there is none, or none that is whole.
std::vector<std::byte> PngProfile(std::span<const std::byte> bytes);

}  // namespace scumble::internal
