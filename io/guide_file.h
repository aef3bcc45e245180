// Guides to and from EXR.
#pragma once

#include <filesystem>
#include <string>

#include "image/guides.h"
#include "image/status.h"

namespace scumble {

struct GuideWriteOptions {
  bool half = false;                // colour layers as 16-bit half floats; data layers stay 32-bit float
  std::string compression = "zip";  // none, rle, zips, zip or piz: lossless only
};

// Writes all layers of the set, object and material names, camera matrices (worldToCamera, worldToNDC) and attributes.
// Refuses a lossy compression. The file appears whole or not at all.
Status WriteGuides(const std::filesystem::path& path, const GuideSet& guides, const GuideWriteOptions& options = {});

struct GuideReadOptions {
  LayerSet required = AlwaysWritten();  // an error names those that are missing, and what is there
  LayerSet optional;                    // read where present
  std::string view_layer;               // which one of several in a multilayer file
};

// Reads only the channels that are asked for; matches them by name (ParseChannelName). The result is validated:
// normals whose length is off by more than a half float's rounding are normalised, and what GuideSet::Validate
// refuses is an error. A file that Blender wrote has world-space normals and no camera: it is refused with what to do.
Expected<GuideSet> ReadGuides(const std::filesystem::path& path, const GuideReadOptions& options = {});

// What a guide file holds, without reading its pixels: size, recognised layers, names, camera and attributes of the
// set (its planes stay empty), and all channel names as they stand in the file.
struct GuideFileInfo {
  int width = 0;
  int height = 0;
  LayerSet layers;
  std::string channels;
  GuideSet header;  // 0 × 0 pixels
};
Expected<GuideFileInfo> InspectGuides(const std::filesystem::path& path, const std::string& view_layer = "");

// Rounds the colour layers to half floats, as `half` does on disk: keeps the path in memory equal to the one by file.
// Values beyond ±65504 become that.
void RoundColorLayersToHalf(GuideSet& guides);

}  // namespace scumble
