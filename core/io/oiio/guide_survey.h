// What a file of any program holds of guides, by the names of its channels.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/io/blender/blender_passes.h"
#include "core/io/blender/render_light.h"
#include "core/io/oiio/oiio.h"

namespace scumble::formats {

// A file's channel with a known meaning.
struct FoundChannel {
  int subimage;
  int channel;
  ChannelMeaning meaning;
  bool is_bare_id;  // "object" or "material" alone, which may be a renderer's numbers of any kind
};

// A channel of a Cryptomatte.
struct FoundMatte {
  int subimage;
  int channel;
  bool is_float;
  std::string compression;
  MatteChannel meaning;
};

// A channel of a pass of light.
struct FoundLight {
  int subimage;
  int channel;
  LightChannel meaning;
};

struct FileContents {
  OIIO::ImageSpec spec;  // of the first part
  std::vector<FoundChannel> channels;
  std::vector<FoundMatte> mattes;
  std::vector<FoundLight> lights;
  std::map<std::string, std::string> manifests;  // by the matte's name: "ViewLayer.CryptoObject"
  std::vector<std::string> names;                // of all channels
  std::string dwa;  // dwaa or dwab, where a part with depth or position has that compression
  bool has_half = false;
  bool from_blender = false;
  bool is_ours = false;  // Scumble wrote it
};

// Looks at all parts of an open file; `name` is for errors.
Expected<FileContents> Survey(OIIO::ImageInput& input, const std::string& name);

// The view layers of a file: the prefixes of its normals. A Blender render without normals has those of Combined.
std::set<std::string> ViewLayers(const FileContents& contents);

// The view layer to read: the requested one, or the only one that has normals.
Expected<std::string> ChoosePrefix(const FileContents& contents, const std::string& wanted, const std::string& name);

// The channels that fill the wanted layers: those of the chosen view layer, else those without one. Coverage may be the
// alpha of the file's only picture. Ids of a bare name count for layers of `required` alone.
std::vector<FoundChannel> SelectChannels(const FileContents& contents, const std::string& prefix,
                                         const LayerSet& wanted, const LayerSet& required);

}  // namespace scumble::formats
