#include "core/image/layers.h"

#include <array>
#include <cctype>
#include <cstddef>

namespace scumble {
namespace {

constexpr const char* kCoverageChannels[] = {"A"};
constexpr const char* kNormalChannels[] = {"normal.X", "normal.Y", "normal.Z"};
constexpr const char* kDepthChannels[] = {"depth.Z"};
constexpr const char* kObjectChannels[] = {"object.ID"};
constexpr const char* kMaterialChannels[] = {"material.ID"};
constexpr const char* kPositionChannels[] = {"position.X", "position.Y", "position.Z"};
constexpr const char* kPrefChannels[] = {"pref.X", "pref.Y", "pref.Z"};
constexpr const char* kMotionChannels[] = {"motion.X", "motion.Y"};
constexpr const char* kAlbedoChannels[] = {"albedo.R", "albedo.G", "albedo.B"};
constexpr const char* kLuminanceChannels[] = {"luminance.Y"};
constexpr const char* kShadowChannels[] = {"shadow.Y"};
constexpr const char* kLpeFullChannels[] = {"lpe.full.R", "lpe.full.G", "lpe.full.B"};
constexpr const char* kLpeLdeChannels[] = {"lpe.LDE.R", "lpe.LDE.G", "lpe.LDE.B"};
constexpr const char* kLpeLseChannels[] = {"lpe.LSE.R", "lpe.LSE.G", "lpe.LSE.B"};
constexpr const char* kLpeLddeChannels[] = {"lpe.LDDE.R", "lpe.LDDE.G", "lpe.LDDE.B"};
constexpr const char* kLpeLd12eChannels[] = {"lpe.LD12E.R", "lpe.LD12E.G", "lpe.LD12E.B"};
constexpr const char* kCosineChannels[] = {"cosine.Y"};
constexpr const char* kUvChannels[] = {"uv.U", "uv.V"};
constexpr const char* kOutlineChannels[] = {"outline.D"};

constexpr LayerInfo kLayers[kLayerCount] = {
    {Layer::kCoverage, "A", kCoverageChannels, false, "coverage, 0 to 1"},
    {Layer::kNormal, "normal", kNormalChannels, false, "unit shading normal in view space"},
    {Layer::kDepth, "depth", kDepthChannels, false, "planar view depth, m"},
    {Layer::kObject, "object", kObjectChannels, false, "object id"},
    {Layer::kMaterial, "material", kMaterialChannels, false, "material id"},
    {Layer::kPosition, "position", kPositionChannels, false, "world position, m"},
    {Layer::kPref, "pref", kPrefChannels, false, "object-space rest position"},
    {Layer::kMotion, "motion", kMotionChannels, false, "pixels to the next frame"},
    {Layer::kAlbedo, "albedo", kAlbedoChannels, true, "base colour, textured, linear"},
    {Layer::kLuminance, "luminance", kLuminanceChannels, true, "direct light on white Lambert, shadowed, and emission"},
    {Layer::kShadow, "shadow", kShadowChannels, true, "share of direct light that is blocked"},
    {Layer::kLpeFull, "lpe.full", kLpeFullChannels, true, "full global illumination"},
    {Layer::kLpeLDE, "lpe.LDE", kLpeLdeChannels, true, "direct diffuse"},
    {Layer::kLpeLSE, "lpe.LSE", kLpeLseChannels, true, "direct specular"},
    {Layer::kLpeLDDE, "lpe.LDDE", kLpeLddeChannels, true, "diffuse interreflection"},
    {Layer::kLpeLD12E, "lpe.LD12E", kLpeLd12eChannels, true, "first two diffuse bounces"},
    {Layer::kCosine, "cosine", kCosineChannels, false, "signed cosine of the normal to the key light, -1 to 1"},
    {Layer::kUv, "uv", kUvChannels, false, "texture coordinates, (0, 0) lower left"},
    {Layer::kOutline, "outline", kOutlineChannels, false, "pixels to the object's nearest outline, up to 256"},
};

// Names that other programs use for these channels: Blender's passes and the names that compositors agree on.
struct Alias {
  const char* suffix;
  Layer layer;
  int component;
};
constexpr Alias kAliases[] = {
    {"alpha", Layer::kCoverage, 0},
    {"Combined.A", Layer::kCoverage, 0},
    {"C.A", Layer::kCoverage, 0},
    {"RGBA.A", Layer::kCoverage, 0},
    {"beauty.A", Layer::kCoverage, 0},
    {"N.X", Layer::kNormal, 0},
    {"N.Y", Layer::kNormal, 1},
    {"N.Z", Layer::kNormal, 2},
    {"normals.X", Layer::kNormal, 0},
    {"normals.Y", Layer::kNormal, 1},
    {"normals.Z", Layer::kNormal, 2},
    {"N.R", Layer::kNormal, 0},
    {"N.G", Layer::kNormal, 1},
    {"N.B", Layer::kNormal, 2},
    {"normal.R", Layer::kNormal, 0},
    {"normal.G", Layer::kNormal, 1},
    {"normal.B", Layer::kNormal, 2},
    {"normals.R", Layer::kNormal, 0},
    {"normals.G", Layer::kNormal, 1},
    {"normals.B", Layer::kNormal, 2},
    {"Z", Layer::kDepth, 0},
    {"depth", Layer::kDepth, 0},
    {"depth.V", Layer::kDepth, 0},
    {"depth.R", Layer::kDepth, 0},
    {"depth.Y", Layer::kDepth, 0},
    {"Z.Z", Layer::kDepth, 0},
    {"Z.R", Layer::kDepth, 0},
    {"zDepth", Layer::kDepth, 0},
    {"zDepth.Z", Layer::kDepth, 0},
    {"zDepth.R", Layer::kDepth, 0},
    {"object", Layer::kObject, 0},
    {"object_id.X", Layer::kObject, 0},
    {"IndexOB.X", Layer::kObject, 0},
    {"material", Layer::kMaterial, 0},
    {"material_id.X", Layer::kMaterial, 0},
    {"IndexMA.X", Layer::kMaterial, 0},
    {"P.X", Layer::kPosition, 0},
    {"P.Y", Layer::kPosition, 1},
    {"P.Z", Layer::kPosition, 2},
    {"DiffCol.R", Layer::kAlbedo, 0},
    {"DiffCol.G", Layer::kAlbedo, 1},
    {"DiffCol.B", Layer::kAlbedo, 2},
};

bool EqualIgnoringCase(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::tolower(static_cast<unsigned char>(a[i])) != std::tolower(static_cast<unsigned char>(b[i]))) return false;
  }
  return true;
}

// Whether `name` is `suffix`, or ends in "." + `suffix`.
bool EndsIn(std::string_view name, std::string_view suffix) {
  if (name.size() < suffix.size()) return false;
  const std::size_t start = name.size() - suffix.size();
  if (start > 0 && name[start - 1] != '.') return false;
  return EqualIgnoringCase(name.substr(start), suffix);
}

}  // namespace

const LayerInfo& Info(Layer layer) { return kLayers[static_cast<int>(layer)]; }
std::span<const LayerInfo> AllLayers() { return kLayers; }
int ChannelCount(Layer layer) { return static_cast<int>(Info(layer).channels.size()); }

std::string LayerSet::ToString() const {
  std::string text;
  for (const LayerInfo& info : AllLayers()) {
    if (!Has(info.layer)) continue;
    if (!text.empty()) text += ", ";
    text += info.name;
  }
  return text.empty() ? "none" : text;
}

LayerSet AlwaysWritten() { return {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject, Layer::kMaterial}; }

Expected<LayerSet> ParseLayers(std::string_view comma_separated) {
  LayerSet set;
  while (!comma_separated.empty()) {
    const std::size_t comma = comma_separated.find(',');
    std::string_view word = comma_separated.substr(0, comma);
    while (!word.empty() && word.front() == ' ') word.remove_prefix(1);
    while (!word.empty() && word.back() == ' ') word.remove_suffix(1);
    comma_separated = comma == std::string_view::npos ? std::string_view{} : comma_separated.substr(comma + 1);
    if (word.empty()) continue;
    bool known = false;
    std::string names;
    for (const LayerInfo& info : AllLayers()) {
      if (EqualIgnoringCase(info.name, word)) set.Add(info.layer), known = true;
      names += names.empty() ? info.name : std::string(", ") + info.name;
    }
    if (!known) return UsageError("unknown layer '" + std::string(word) + "'; there are " + names);
  }
  return set;
}

std::vector<std::string> ChannelNames(Layer layer, int component) {
  std::vector<std::string> names = {Info(layer).channels[static_cast<std::size_t>(component)]};
  for (const Alias& alias : kAliases) {
    if (alias.layer == layer && alias.component == component) names.push_back(alias.suffix);
  }
  return names;
}

std::optional<ChannelMeaning> ParseChannelName(std::string_view name) {
  if (EndsIn(name, "UV.A")) return std::nullopt;  // the third channel of Blender's UV pass, no coverage
  std::optional<ChannelMeaning> best;
  std::size_t best_length = 0;
  auto consider = [&](std::string_view suffix, Layer layer, int component) {
    if (suffix.size() <= best_length || !EndsIn(name, suffix)) return;
    best_length = suffix.size();
    std::string prefix(name.substr(0, name.size() - suffix.size()));
    if (!prefix.empty()) prefix.pop_back();  // the dot
    best = ChannelMeaning{layer, component, std::move(prefix)};
  };
  for (const LayerInfo& info : AllLayers()) {
    for (std::size_t c = 0; c < info.channels.size(); ++c) consider(info.channels[c], info.layer, static_cast<int>(c));
  }
  for (const Alias& alias : kAliases) consider(alias.suffix, alias.layer, alias.component);
  return best;
}

}  // namespace scumble
