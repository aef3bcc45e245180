// Guides to and from EXR.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "core/image/guides.h"
#include "core/image/status.h"

namespace scumble {

struct GuideWriteOptions {
  bool half = false;                // colour layers as 16-bit half floats; data layers stay 32-bit float
  std::string compression = "zip";  // none, rle, zips, zip or piz: lossless only
  bool cryptomatte = false;  // for compositors: objects and materials as Cryptomatte too, and their ids as passes that
                             // Blender 3 shows (core/io/guides/cryptomatte.h)
};

// Lossless, and the fastest to write and read: background is packed, surfaces hardly.
inline constexpr const char* kFastCompression = "rle";

// Writes all layers of the set, its fragments, object and material names and their styles, camera matrices
// (worldToCamera and worldToNDC in OpenEXR's own conventions) and attributes. Refuses a lossy compression. The file
// appears whole or not at all.
Status WriteGuides(const std::filesystem::path& path, const GuideSet& guides, const GuideWriteOptions& options = {});

// Whether WriteGuides supports the ending and the compression. Call it before the work.
Status CheckGuideTarget(const std::filesystem::path& path, const GuideWriteOptions& options = {});

// Whose options an error about missing layers names.
enum class GuideUser { kTransfer, kFinish };

struct GuideReadOptions {
  LayerSet required = AlwaysWritten();  // an error names those that are missing, and what is there
  LayerSet optional;                    // read where present
  std::string view_layer;               // which one of several in a multilayer file
  std::string light_layer;  // of a Blender render: the view layer with the passes of light; empty: that one too
  // The caller's remedy without the layers that are missing, for the end of a message's sentence; may be empty.
  std::function<std::string(const LayerSet& missing)> remedy;
  std::filesystem::path blender_camera;  // the .camera file of a Blender render; empty: the camera is solved
  GuideUser user = GuideUser::kTransfer;
};

// Reads only the channels that are asked for; matches them by name (ParseChannelName). Ids in channels that are called
// "object" or "material" alone, which may be of any kind, are read where their layer is required. Fragments are read
// from files that WriteGuides made, and with them always the ids by which their surfaces are told apart. Fragments that
// are damaged or do not fit their file are an error. Of guides that WriteGuides made, ids are always those of the
// layers object and material; a Cryptomatte beside them is passed over. Where another program wrote no ids, object,
// material and their names come from Cryptomatte, if they are wanted. A Cryptomatte that cannot be used is an error if
// its layer is required; else the layer is left out. The result is validated. Coverage outside 0 to 1 by an eighth or
// less is clamped. Normals whose length is off by more than a half float's rounding are normalised. What
// GuideSet::Validate refuses is an error. What Blender wrote is converted as core/io/blender/blender_passes.h says: its
// camera comes from `blender_camera`, or from its Position and Depth passes; names from Cryptomatte; luminance and
// shadow from its passes of light (core/io/blender/render_light.h).
Expected<GuideSet> ReadGuides(const std::filesystem::path& path, const GuideReadOptions& options = {});

// The content of a guide file, without its pixels.
struct GuideFileInfo {
  int width = 0;
  int height = 0;
  bool has_half = false;      // some channel is stored in half floats
  bool from_blender = false;  // rendered by Blender itself: its passes are to be converted
  bool has_cryptomatte = false;
  std::size_t fragments = 0;               // core/image/fragments.h
  std::map<std::string, LayerSet> layers;  // complete layers by view layer; "" where names have nothing before them;
                                           // Cryptomatte and passes of light count
  std::string channels;                    // all names as they stand in the file
  GuideSet header;                         // names, camera and attributes; 0 × 0 pixels
};
Expected<GuideFileInfo> InspectGuides(const std::filesystem::path& path);

// Rounds the colour layers to half floats, as `half` does on disk, so that guides in memory equal those by file. Values
// beyond ±65504 become ±65504.
void RoundColorLayersToHalf(GuideSet& guides);

}  // namespace scumble
