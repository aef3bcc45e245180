// OpenRaster files (.ora), pictures in layers that Krita, GIMP and MyPaint open: https://www.openraster.org, baseline
// 0.0.5.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

// A layer that covers the whole picture.
struct RasterLayer {
  std::string name;            // for the artist, UTF-8
  std::vector<std::byte> png;  // as EncodePng makes it, of the picture's size
  double opacity = 1.0;        // 0 … 1
  bool visible = true;
  bool locked = false;    // against painting, where the program knows that
  bool selected = false;  // the one to paint on, at most one
};

// The bytes of a file with these layers, the topmost first. `merged` is what they show together: painting programs look
// at the layers, file managers and Scumble at this. `dpi` is noted for printing; 0: none. 8 bits a channel, sRGB. The
// same layers make the same bytes. `name` is for messages. Thread-safe.
Expected<std::vector<std::byte>> EncodeOpenRaster(std::span<const RasterLayer> layers, const Picture& merged, int dpi,
                                                  const std::string& name);

// What a file of layers shows, by the merged picture that its program put beside them: an .ora, or a .kra of Krita.
// Reads up to 1 GiB of PNG, and no more of it than a picture of its size can take. Thread-safe.
Expected<Picture> ReadMergedLayers(const std::filesystem::path& path);

// The size of that picture and its bits a channel, without its pixels. Thread-safe.
struct MergedHeader {
  int width = 0, height = 0, bits = 8;
};
Expected<MergedHeader> InspectMergedLayers(const std::filesystem::path& path);

// Whether a file shows the same pictures, layer by layer, under the same names and settings, as one that
// EncodeOpenRaster makes of these, at whatever dpi. A file that cannot be read does not. Thread-safe.
bool SameLayers(const std::filesystem::path& path, std::span<const RasterLayer> layers, const Picture& merged);

}  // namespace scumble
