// Painting over an exemplar on the page: the strokes come as a picture with alpha, and go into the exemplar's file.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"

namespace scumble {

struct PaintTarget {
  std::filesystem::path file;
  std::string stamp;  // of the file and the bytes that were read: "the file as I know it"
  int width = 0, height = 0;
  bool layer = false;  // strokes become a layer of an OpenRaster file, instead of part of the only one
};

// Whether strokes can be put into this exemplar's file, which must be a PNG or an OpenRaster file that can be written.
// kUsage says why not, kInput that it cannot be read.
Expected<PaintTarget> FindPaintTarget(const std::filesystem::path& file);

// Puts the strokes, a PNG of the file's size, into the file: an OpenRaster file gets them as its topmost layer
// "Scumble", over one of that name that is there, and its merged picture is made anew; into a PNG they are composited,
// at its own bits. The file changes whole or not at all. kCancelled where it is no longer the one of the stamp.
Status PutStrokes(const std::filesystem::path& file, const std::string& stamp, std::span<const std::byte> strokes);

}  // namespace scumble
