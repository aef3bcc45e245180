#include "apps/cli/verbs/compare_files.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/io/channel_file.h"
#include "core/io/guide_file.h"

namespace scumble {
namespace {

bool ShareAName(const ChannelImage& a, const ChannelImage& b) {
  return std::any_of(a.names.begin(), a.names.end(), [&](const std::string& name) { return b.Find(name); });
}

// A grey picture has the channel Y: beside a coloured one it stands for all three.
void SpreadGrey(const ChannelImage& other, ChannelImage& image) {
  const std::vector<float>* const grey = image.Find("Y");
  if (!grey || image.Find("R") || other.Find("Y") || !other.Find("R")) return;
  const auto at = std::size_t(std::find(image.names.begin(), image.names.end(), "Y") - image.names.begin());
  image.names[at] = "R";
  for (const char* const name : {"G", "B"}) {
    image.names.push_back(name);
    image.planes.push_back(image.planes[at]);
  }
}

struct GuideFile {
  std::string path, view_layer;
  LayerSet layers;
  bool from_blender = false;
};

// One of the two files as guides. `view_layer` is for a file that has view layers.
Expected<GuideFile> InspectToCompare(const std::string& path, const std::string& view_layer) {
  SCUMBLE_ASSIGN(const GuideFileInfo info, InspectGuides(path));
  GuideFile file{path, {}, {}, info.from_blender};
  const bool has_view_layers = std::any_of(info.layers.begin(), info.layers.end(), [](const auto& one) {
    return !one.first.empty() && one.second.Has(Layer::kNormal);
  });
  if (has_view_layers) file.view_layer = view_layer;
  if (!file.view_layer.empty() && !info.layers.contains(file.view_layer)) {
    std::string names;
    for (const auto& [name, layers] : info.layers) {
      if (!name.empty()) names += (names.empty() ? "'" : ", '") + name + "'";
    }
    return InputError(path + " has no view layer '" + file.view_layer + "'; there are " + names);
  }
  for (const auto& [name, layers] : info.layers) {
    if (file.view_layer.empty() || name.empty() || name == file.view_layer) file.layers.Add(layers);
  }
  return file;
}

Expected<ChannelImage> ReadLayers(const GuideFile& file, const LayerSet& layers, const std::string& camera) {
  GuideReadOptions read;
  read.required = layers;
  read.view_layer = file.view_layer;
  if (file.from_blender) read.blender_camera = camera;
  SCUMBLE_ASSIGN(const GuideSet guides, ReadGuides(file.path, read));
  return ChannelsOf(guides, file.path);
}

Expected<ComparedFiles> ReadAsGuides(const CompareVerb& verb, const Globals& globals) {
  SCUMBLE_ASSIGN(const GuideFile a, InspectToCompare(verb.a, verb.view_layer));
  SCUMBLE_ASSIGN(const GuideFile b, InspectToCompare(verb.b, verb.view_layer));
  if (!verb.view_layer.empty() && a.view_layer.empty() && b.view_layer.empty()) {
    return UsageError("--view-layer: neither " + verb.a + " nor " + verb.b + " has view layers; leave it out");
  }
  LayerSet both, only_a, only_b;
  for (const LayerInfo& info : AllLayers()) {
    const bool in_a = a.layers.Has(info.layer), in_b = b.layers.Has(info.layer);
    if (in_a && in_b) both.Add(info.layer);
    if (in_a && !in_b) only_a.Add(info.layer);
    if (in_b && !in_a) only_b.Add(info.layer);
  }
  if (both.empty()) {
    return InputError(verb.a + " and " + verb.b + " have neither a channel name nor a guide layer in common: " +
                      verb.a + " holds " + only_a.ToString() + ", " + verb.b + " holds " + only_b.ToString());
  }
  globals.Note("compared as guides: " + both.ToString());
  if (!only_a.empty()) globals.Note("only in " + verb.a + ", not compared: " + only_a.ToString());
  if (!only_b.empty()) globals.Note("only in " + verb.b + ", not compared: " + only_b.ToString());
  ComparedFiles files;
  SCUMBLE_ASSIGN(files.a, ReadLayers(a, both, verb.camera));
  SCUMBLE_ASSIGN(files.b, ReadLayers(b, both, verb.camera));
  return files;
}

}  // namespace

Expected<ComparedFiles> ReadToCompare(const CompareVerb& verb, const Globals& globals) {
  if (!verb.view_layer.empty()) return ReadAsGuides(verb, globals);
  ComparedFiles files;
  SCUMBLE_ASSIGN(files.a, ReadChannels(verb.a));
  SCUMBLE_ASSIGN(files.b, ReadChannels(verb.b));
  SpreadGrey(files.b, files.a);
  SpreadGrey(files.a, files.b);
  if (ShareAName(files.a, files.b)) return files;
  const Expected<GuideFileInfo> a = InspectGuides(verb.a), b = InspectGuides(verb.b);
  if (!a || !b) return files;  // pictures: Compare says that they have no name in common
  return ReadAsGuides(verb, globals);
}

}  // namespace scumble
