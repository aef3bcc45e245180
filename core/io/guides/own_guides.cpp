#include "core/io/guides/own_guides.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "core/io/exr/scanline_exr.h"
#include "core/io/guides/cryptomatte.h"
#include "core/io/guides/fragment_storage.h"
#include "core/io/guides/guide_header.h"
#include "core/io/guides/guide_storage.h"

namespace scumble::internal {
namespace {

using Meanings = std::map<std::string, ChannelMeaning>;  // by the channel's name

// What stands beside our own ids for compositors, and says nothing new.
bool IsForCompositors(const std::string& name) {
  return ParseMatteChannel(name) || name == kShownObjectIds || name == kShownMaterialIds;
}

// Empty if a channel belongs to a view layer, has no meaning here, or has another channel's meaning.
std::optional<Meanings> MeaningsOf(const ExrHeader& header) {
  const auto software = header.texts.find("Software");
  if (software != header.texts.end() && software->second.starts_with("Blender")) return std::nullopt;
  const bool is_ours = header.texts.count("scumble:generator") > 0;
  Meanings meanings;
  for (const auto& [name, half] : header.channels) {
    if (is_ours && IsForCompositors(name)) continue;
    const std::optional<ChannelMeaning> meaning = ParseChannelName(name);
    if (!meaning || !meaning->prefix.empty() || ParseMatteChannel(name)) return std::nullopt;
    const bool is_taken = std::any_of(meanings.begin(), meanings.end(), [&](const auto& other) {
      return other.second.layer == meaning->layer && other.second.component == meaning->component;
    });
    if (is_taken) return std::nullopt;
    meanings.emplace(name, *meaning);
  }
  return meanings;
}

LayerSet CompleteLayers(const Meanings& meanings) {
  std::array<int, kLayerCount> counts{};
  for (const auto& [name, meaning] : meanings) ++counts[static_cast<std::size_t>(meaning.layer)];
  LayerSet complete;
  for (const LayerInfo& info : AllLayers()) {
    if (counts[static_cast<std::size_t>(info.layer)] == ChannelCount(info.layer)) complete.Add(info.layer);
  }
  return complete;
}

// In OpenImageIO's order: colours as R, G, B, where the file has them alphabetically.
std::string NamesOf(const ExrHeader& header) {
  std::vector<std::string> names;
  for (const auto& [name, half] : header.channels) names.push_back(name);
  const auto key = [](const std::string& name) {
    const std::size_t dot = name.rfind('.') + 1;  // 0 where there is none
    const std::size_t color = std::string("RGBA").find(name.substr(dot));
    return std::pair(name.substr(0, dot), color == std::string::npos ? name.substr(dot) : std::to_string(color));
  };
  std::stable_sort(names.begin(), names.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  return ListOfChannels(names);
}

}  // namespace

std::optional<Expected<GuideSet>> ReadPlainGuides(const std::filesystem::path& path, const GuideReadOptions& options) {
  if (!options.view_layer.empty() || !options.light_layer.empty() || !options.blender_camera.empty())
    return std::nullopt;
  GuideSet guides;
  Meanings meanings;
  const auto header = ReadPlainExr(path, [&](const ExrHeader& found) -> std::optional<PlaneFor> {
    std::optional<Meanings> all = MeaningsOf(found);
    if (!all) return std::nullopt;
    meanings = std::move(*all);
    const LayerSet complete = CompleteLayers(meanings);
    guides = GuideSet(found.width, found.height);
    LayerSet optional = options.optional;
    if (found.blobs.count(kFragmentAttribute)) optional.Add({Layer::kObject, Layer::kMaterial});
    for (const LayerInfo& info : AllLayers()) {
      const bool is_required = options.required.Has(info.layer);
      if (is_required && !complete.Has(info.layer)) return std::nullopt;
      if (complete.Has(info.layer) && (is_required || optional.Has(info.layer))) guides.Add(info.layer);
    }
    return PlaneFor([&](const std::string& name) {
      const auto meant = meanings.find(name);
      if (meant == meanings.end()) return std::span<float>();
      const ChannelMeaning& meaning = meant->second;
      return guides.Has(meaning.layer) ? guides.Plane(meaning.layer, meaning.component) : std::span<float>();
    });
  });
  if (!header) return std::nullopt;
  TakeHeader(header->texts, guides);
  if (!MakeValid(path.string(), guides)) return std::nullopt;
  const auto fragments = header->blobs.find(kFragmentAttribute);
  if (fragments != header->blobs.end() && guides.Has(Layer::kCoverage)) {
    SCUMBLE_ASSIGN(guides.fragments, DecodeFragments(fragments->second.bytes, guides, path.string()));
  }
  return guides;
}

std::optional<Expected<GuideFileInfo>> InspectPlainGuides(const std::filesystem::path& path) {
  std::optional<Meanings> meanings;
  const auto header = ReadPlainExr(path, [&](const ExrHeader& found) -> std::optional<PlaneFor> {
    meanings = MeaningsOf(found);
    if (!meanings) return std::nullopt;
    return PlaneFor([](const std::string&) { return std::span<float>(); });
  });
  if (!header) return std::nullopt;
  GuideFileInfo info;
  info.width = header->width, info.height = header->height, info.channels = NamesOf(*header);
  for (const auto& [name, half] : header->channels) {
    info.has_half = info.has_half || half;
    info.has_cryptomatte = info.has_cryptomatte || ParseMatteChannel(name);
  }
  info.layers[""] = CompleteLayers(*meanings);
  TakeHeader(header->texts, info.header);
  const auto fragments = header->blobs.find(kFragmentAttribute);
  if (fragments != header->blobs.end()) {
    SCUMBLE_ASSIGN(info.fragments, CountFragments(fragments->second.bytes, info.width, info.height, path.string()));
  }
  return info;
}

}  // namespace scumble::internal
