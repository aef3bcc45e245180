#include "core/io/oiio/guide_survey.h"

#include <algorithm>
#include <array>

#include "core/io/guides/guide_header.h"
#include "core/io/picture_rules.h"

namespace scumble::formats {
namespace {

// The manifests of a part's header, which stand under cryptomatte/KEY/manifest beside cryptomatte/KEY/name.
void FindManifests(const OIIO::ImageSpec& spec, FileContents& contents) {
  constexpr std::string_view kStart = "cryptomatte/", kEnd = "/name";
  for (const OIIO::ParamValue& value : spec.extra_attribs) {
    const std::string key(value.name());
    if (value.type() != OIIO::TypeString || !key.starts_with(kStart) || !key.ends_with(kEnd)) continue;
    const std::string manifest = key.substr(0, key.size() - kEnd.size()) + "/manifest";
    contents.manifests[std::string(value.get_string())] = std::string(spec.get_string_attribute(manifest));
  }
}

// The name that tells what a channel is: "N.X" for the X of a part that is called N, or the channel's own.
std::string FullName(const std::string& part, const std::string& channel) {
  if (part.empty() || channel.find('.') != std::string::npos) return channel;
  const std::string full = part + "." + channel;
  const auto of_full = ParseChannelName(full);
  const bool is_known = (of_full && of_full->prefix.empty()) || ParseMatteChannel(full);
  return is_known || (of_full && !ParseChannelName(channel)) ? full : channel;
}

// Whether a channel has a layer's name and no component.
bool IsBareId(const std::string& channel) {
  const std::string name = internal::Upper(channel.substr(channel.rfind('.') + 1));
  return name == "OBJECT" || name == "MATERIAL";
}

// Names that a colour may have as well.
bool IsAlsoColor(const std::string& channel, const ChannelMeaning& meaning) {
  const std::string name = internal::Upper(channel);
  const auto ends_in_one_of = [&](std::string_view letters) { return letters.find(name.back()) != letters.npos; };
  if (meaning.layer == Layer::kCoverage) {
    return name.ends_with("C.A") || name.ends_with("RGBA.A") || name.ends_with("BEAUTY.A");
  }
  if (meaning.layer == Layer::kDepth) return ends_in_one_of("RY");
  return meaning.layer == Layer::kNormal && ends_in_one_of("RGB");
}

}  // namespace

Expected<FileContents> Survey(OIIO::ImageInput& input, const std::string& name) {
  FileContents contents;
  contents.spec = input.spec(0);
  std::vector<FoundChannel> last;  // they count where no other of the file means the same
  for (int subimage = 0; input.seek_subimage(subimage, 0); ++subimage) {
    const OIIO::ImageSpec spec = input.spec(subimage);
    SCUMBLE_RETURN_IF_ERROR(internal::CheckSize(spec, name));
    if (spec.full_width != contents.spec.full_width || spec.full_height != contents.spec.full_height) {
      return InputError(name + ": its parts differ in size; write all guides at one size");
    }
    const std::string compression(spec.get_string_attribute("compression"));
    for (int c = 0; c < spec.nchannels; ++c) {
      const std::string part(spec.get_string_attribute("oiio:subimagename"));
      const std::string channel = FullName(part, spec.channelnames[c]);
      contents.names.push_back(channel);
      contents.has_half = contents.has_half || spec.channelformat(c) == OIIO::TypeDesc::HALF;
      if (channel.find("Combined.R") != std::string::npos) contents.from_blender = true;
      if (auto matte = ParseMatteChannel(channel)) {
        const bool is_float = spec.channelformat(c) == OIIO::TypeDesc::FLOAT;
        contents.mattes.push_back({subimage, c, is_float, compression, *matte});
      } else if (auto meaning = ParseChannelName(channel)) {
        const bool is_bare_id = IsBareId(channel);
        const bool is_last = is_bare_id || IsAlsoColor(channel, *meaning);
        (is_last ? last : contents.channels).push_back({subimage, c, *meaning, is_bare_id});
        const bool is_place = meaning->layer == Layer::kPosition || meaning->layer == Layer::kDepth;
        if (is_place && compression.starts_with("dwa")) contents.dwa = compression;
      } else if (auto light = ParseLightChannel(channel)) {
        contents.lights.push_back({subimage, c, *light});
      }
    }
    FindManifests(spec, contents);
  }
  contents.channels.insert(contents.channels.end(), last.begin(), last.end());
  if (contents.spec.get_string_attribute("Software").substr(0, 7) == "Blender") contents.from_blender = true;
  contents.is_ours = !contents.spec.get_string_attribute("scumble:generator").empty();
  if (contents.is_ours) contents.from_blender = false;
  OIIO::ImageSpec window = contents.spec;
  window.width = window.full_width, window.height = window.full_height;
  SCUMBLE_RETURN_IF_ERROR(internal::CheckSize(window, name));
  return contents;
}

std::set<std::string> ViewLayers(const FileContents& contents) {
  std::set<std::string> prefixes;
  const auto take = [&](Layer layer) {
    for (const FoundChannel& found : contents.channels) {
      if (found.meaning.layer == layer && found.meaning.component == 0) prefixes.insert(found.meaning.prefix);
    }
  };
  take(Layer::kNormal);
  if (prefixes.empty() && contents.from_blender) take(Layer::kCoverage);
  return prefixes;
}

Expected<std::string> ChoosePrefix(const FileContents& contents, const std::string& wanted, const std::string& name) {
  const std::set<std::string> prefixes = ViewLayers(contents);
  std::string list;
  for (const std::string& prefix : prefixes) {
    if (!prefix.empty()) list += (list.empty() ? "'" : ", '") + prefix + "'";
  }
  if (!wanted.empty()) {
    if (prefixes.count(wanted)) return wanted;
    return InputError(name + " has no view layer '" + wanted + "' with normals; " +
                      (list.empty() ? "it has no view layers, leave --view-layer out" : "there are " + list));
  }
  if (prefixes.size() > 1) {
    return InputError(name + " holds several view layers, " + list + ": choose with --view-layer");
  }
  return prefixes.empty() ? std::string() : *prefixes.begin();
}

namespace {

// Whether the file has R, G and B of this prefix.
bool HasColors(const FileContents& contents, const std::string& prefix) {
  const std::string start = prefix.empty() ? "" : internal::Upper(prefix) + ".";
  return std::ranges::all_of(std::array{"R", "G", "B"}, [&](const char* color) {
    return std::ranges::any_of(contents.names,
                               [&](const std::string& name) { return internal::Upper(name) == start + color; });
  });
}

// The prefix of the file's only alpha that is no view layer's: a renderer's picture may have any name. Empty where
// there are several, and where it is not the picture's: without colours beside it, or where R, G and B without a prefix
// are the picture.
std::string PrefixOfOnlyAlpha(const FileContents& contents) {
  const std::set<std::string> view_layers = ViewLayers(contents);
  std::set<std::string> prefixes;
  for (const FoundChannel& found : contents.channels) {
    const std::string& prefix = found.meaning.prefix;
    const bool is_matte = internal::Upper(prefix).find("CRYPTO") != std::string::npos;
    if (found.meaning.layer == Layer::kCoverage && !is_matte && !view_layers.count(prefix)) prefixes.insert(prefix);
  }
  const bool is_picture = prefixes.size() == 1 && HasColors(contents, *prefixes.begin()) && !HasColors(contents, "");
  return is_picture ? *prefixes.begin() : std::string();
}

}  // namespace

std::vector<FoundChannel> SelectChannels(const FileContents& contents, const std::string& prefix,
                                         const LayerSet& wanted, const LayerSet& required) {
  std::vector<FoundChannel> selected;
  LayerSet open = wanted;
  const auto take = [&](const std::string& from) {
    for (const FoundChannel& found : contents.channels) {
      if (!open.Has(found.meaning.layer) || found.meaning.prefix != from) continue;
      if (found.is_bare_id && !required.Has(found.meaning.layer)) continue;
      const bool taken = std::any_of(selected.begin(), selected.end(), [&](const FoundChannel& other) {
        return other.meaning.layer == found.meaning.layer && other.meaning.component == found.meaning.component;
      });
      if (!taken) selected.push_back(found);
    }
  };
  take(prefix);
  for (const FoundChannel& found : selected) open.Remove(found.meaning.layer);  // no layer is mixed from two
  if (!prefix.empty())
    take("");
  else if (open.Has(Layer::kCoverage) && !contents.from_blender)
    take(PrefixOfOnlyAlpha(contents));
  return selected;
}

}  // namespace scumble::formats
