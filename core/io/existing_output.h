// Whether an output of an earlier run can be kept: it must be complete, not merely there. A killed job leaves empty
// files, and a full disk leaves truncated ones.
#pragma once

#include <filesystem>
#include <string>

#include "core/image/layers.h"
#include "core/image/status.h"

namespace scumble {

// A setting whose value is unknown, on either side: it agrees with any value.
inline constexpr const char* kAnySetting = "?";

// The required shape of a picture; 0 stands for any.
struct PictureShape {
  int width = 0;
  int height = 0;
  int channels = 0;
  int bits = 0;          // a channel, as PictureBits has them
  std::string settings;  // as WritePicture keeps them: "scumble 0.1; seed 0; exposure 0.52". All that either side says
                         // must agree, except for settings that older versions did not record (upsample, fps, measured,
                         // samples); a file without settings, and "" here, are not compared
};

// Whether two texts of settings agree, as PictureShape::settings says; the error names the first that differs. Any
// setting that one side lacks counts as a difference: another version may use another value for it.
Status CheckSameSettings(const std::filesystem::path& path, const std::string& found, const std::string& wanted);

// Channels of a picture that WritePicture writes to a file of that name: 4, and 3 for JPEG, which has no alpha.
int PictureChannels(const std::filesystem::path& path);

// Decodes the whole picture. The error names the defect; a missing file is one. The picture's content is not checked.
Status CheckWholePicture(const std::filesystem::path& path, const PictureShape& shape);

// The shape of a guide file, which must hold exactly these layers, colours as half floats if `half`, and a Cryptomatte
// or none. The settings are those of the guides' attribute scumble:settings.
struct GuideShape {
  int width = 0;
  int height = 0;
  LayerSet layers;
  bool half = false;
  std::string settings;
  bool cryptomatte = false;
};
Status CheckWholeGuides(const std::filesystem::path& path, const GuideShape& shape);

}  // namespace scumble
