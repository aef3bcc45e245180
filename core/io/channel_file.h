// Every channel of a picture file, as stored: for comparing files, whatever they mean.
#pragma once

#include <filesystem>

#include "core/image/channel_image.h"
#include "core/image/status.h"

namespace scumble {

// Reads all channels of any picture that OpenImageIO reads, as float. No colour conversion, alpha as it is stored;
// integers are scaled to [0, 1]. All parts of a multi-part EXR are read. A channel name that occurs in several parts is
// prefixed by its part's name: "left.R", or "part1.R" if the part has none, counting from 0. Only the full resolution
// is read. An error where parts differ in size or position, for deep files and for impossible sizes. Thread-safe.
Expected<ChannelImage> ReadChannels(const std::filesystem::path& path);

}  // namespace scumble
