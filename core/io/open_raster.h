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
  bool locked = false;    // locked against painting, in programs that support it
  bool selected = false;  // the one to paint on, at most one
  bool atop = false;      // Porter and Duff's "atop" instead of "over": it leaves the alpha of what is below
};

// The bytes of a file with these layers, the topmost first. `merged` is their composite: painting programs read the
// layers, file managers and Scumble read the composite. `dpi` is stored for printing; 0: none. 8 bits a channel, sRGB.
// The same layers make the same bytes. `name` is for messages. `settings`: a text of Scumble's own in the file, which
// other programs pass over; empty: none. Thread-safe.
Expected<std::vector<std::byte>> EncodeOpenRaster(std::span<const RasterLayer> layers, const Picture& merged, int dpi,
                                                  const std::string& name, const std::string& settings = {});

// Those settings; empty where the file has none. Thread-safe.
Expected<std::string> ReadLayerSettings(const std::filesystem::path& path);

// The merged picture that a program stored beside the layers: in an .ora, or a .kra of Krita. Reads up to 1 GiB of PNG,
// and never more than a picture of its size can take. Thread-safe.
Expected<Picture> ReadMergedLayers(const std::filesystem::path& path);

// The size and bits a channel of that merged picture, without its pixels. Thread-safe.
struct MergedHeader {
  int width = 0, height = 0, bits = 8;
};
Expected<MergedHeader> InspectMergedLayers(const std::filesystem::path& path);

// Puts strokes over a picture of the same size: Porter and Duff's "over" (1984) of straight alpha, rounded to the
// nearest.
void PutOver(Picture& below, const Picture& above);

// The bytes of the file with strokes, of the merged picture's size, on a layer of this name on top; onto the layer of
// that name that an earlier call made, if it is there. Everything else of the file is kept. Thread-safe.
Expected<std::vector<std::byte>> WithStrokes(const std::filesystem::path& path, const std::string& layer,
                                             const Picture& strokes);

// Whether a file holds the same pictures, layer by layer, under the same names and settings, as EncodeOpenRaster makes
// of these, at any dpi. False for a file that cannot be read. Thread-safe.
bool SameLayers(const std::filesystem::path& path, std::span<const RasterLayer> layers, const Picture& merged);

}  // namespace scumble
