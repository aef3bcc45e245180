// Whether an output of an earlier run can be kept: it must be whole, not merely there. A job that was killed leaves
// empty files, and a disk that was full leaves truncated ones.
#pragma once

#include <filesystem>

#include "image/layers.h"
#include "image/status.h"

namespace scumble {

// What a picture must be; 0 stands for anything.
struct PictureShape {
  int width = 0;
  int height = 0;
  int channels = 0;
};

// Channels of a picture that WritePicture writes to a file of that name: 4, and 3 for JPEG, which has no alpha.
int PictureChannels(const std::filesystem::path& path);

// Decodes the whole picture: an error says what is wrong with it, a missing file included. What it shows is not looked
// at.
Status CheckWholePicture(const std::filesystem::path& path, const PictureShape& shape);

// The same for a guide file, which must hold just these layers.
Status CheckWholeGuides(const std::filesystem::path& path, int width, int height, const LayerSet& layers);

}  // namespace scumble
