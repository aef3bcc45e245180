// Whether an output of an earlier run can be kept: it must be whole, not merely there. A job that was killed leaves
// empty files, and a disk that was full leaves truncated ones.
#pragma once

#include <filesystem>
#include <string>

#include "core/image/layers.h"
#include "core/image/status.h"

namespace scumble {

// As the value of a setting on either side: it is not known, and agrees with all.
inline constexpr const char* kAnySetting = "?";

// What a picture must be; 0 stands for anything.
struct PictureShape {
  int width = 0;
  int height = 0;
  int channels = 0;
  int bits = 0;          // a channel, as PictureBits has them
  std::string settings;  // as WritePicture keeps them: "scumble 0.1; seed 0; exposure 0.52". All that either side says
                         // must agree, but for what older versions never told (upsample, fps, measured, samples); a
                         // file that says nothing, and "" here, are not compared
};

// Channels of a picture that WritePicture writes to a file of that name: 4, and 3 for JPEG, which has no alpha.
int PictureChannels(const std::filesystem::path& path);

// Decodes the whole picture: an error says what is wrong with it, a missing file included. What it shows is not looked
// at.
Status CheckWholePicture(const std::filesystem::path& path, const PictureShape& shape);

// The same for a guide file, which must hold just these layers, colours as half floats if `half`. The settings are
// those of the guides' attribute scumble:settings.
struct GuideShape {
  int width = 0;
  int height = 0;
  LayerSet layers;
  bool half = false;
  std::string settings;
};
Status CheckWholeGuides(const std::filesystem::path& path, const GuideShape& shape);

}  // namespace scumble
