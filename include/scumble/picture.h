// A picture as people see it: exemplars, textures, paper, results. Reading and writing picture files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scumble/data_folder.h"
#include "scumble/status.h"

namespace scumble {

// Interleaved RGBA, 16-bit integers, sRGB-encoded, straight (unassociated) alpha. Row 0 is the top row.
// 16-bit integers keep every 8- and 16-bit file exactly, and sums of them do not depend on their order.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> rgba;  // 4 * width * height

  Picture() = default;
  Picture(int w, int h) : width(w), height(h), rgba(std::size_t(4) * w * h, 0) {}

  bool empty() const { return width == 0 || height == 0; }
  std::uint16_t* At(int x, int y) { return rgba.data() + 4 * (std::size_t(y) * width + x); }
  const std::uint16_t* At(int x, int y) const { return rgba.data() + 4 * (std::size_t(y) * width + x); }
};

// Reads a picture file: PNG, TIFF, EXR, JPEG, PSD, ORA and what else OpenImageIO reads. Floating-point files are linear
// and are encoded. A kInput error says what is wrong with the file.
Expected<Picture> LoadPicture(const std::string& file);

// Writes .png, .tif, .exr or .jpg; `bits` a channel: 8 or 16, of JPEG 8, of EXR 16 (as for 8) or 32. The file appears
// whole under its name, or not at all: a kOutput error leaves an older file as it was. kUsage if the ending or the bits
// are not known, or if width, height and rgba of the picture do not fit.
Status SavePicture(const std::string& file, const Picture& picture, int bits = 8);

}  // namespace scumble
