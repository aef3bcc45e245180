// Reads guides by OpenImageIO, from files of any program. Part of the module of formats.
#include <algorithm>
#include <array>
#include <set>

#include "core/io/blender/blender_passes.h"
#include "core/io/blender/render_light.h"
#include "core/io/blender_camera.h"
#include "core/io/format_dispatch.h"
#include "core/io/guide_file.h"
#include "core/io/guides/guide_header.h"
#include "core/io/guides/guide_storage.h"
#include "core/io/oiio/guide_survey.h"
#include "core/io/oiio/oiio.h"
#include "core/io/picture_rules.h"

namespace scumble::formats {
namespace {

LayerSet CompleteLayers(const std::vector<FoundChannel>& channels) {
  std::array<int, kLayerCount> counts{};
  for (const FoundChannel& found : channels) ++counts[static_cast<int>(found.meaning.layer)];
  LayerSet complete;
  for (const LayerInfo& info : AllLayers()) {
    if (counts[static_cast<int>(info.layer)] == ChannelCount(info.layer)) complete.Add(info.layer);
  }
  return complete;
}

// "; of normal it holds normal.X, normal.Y only" for layers of which some channels are there.
std::string PartsOf(const LayerSet& missing, const std::vector<FoundChannel>& channels) {
  std::string parts;
  for (const LayerInfo& info : AllLayers()) {
    std::string names;
    for (const FoundChannel& found : channels) {
      if (found.meaning.layer != info.layer || !missing.Has(info.layer)) continue;
      names += (names.empty() ? "" : ", ") + std::string(info.channels[std::size_t(found.meaning.component)]);
    }
    if (!names.empty()) parts += "; of " + std::string(info.name) + " it holds " + names + " only";
  }
  return parts;
}

// ". Known names are depth.Z, Z, … for depth; it also holds Pz" for a file of an unknown program.
std::string KnownNames(const LayerSet& missing, const FileContents& contents) {
  std::string known;
  for (const LayerInfo& info : AllLayers()) {
    if (!missing.Has(info.layer)) continue;
    std::vector<std::string> names = ChannelNames(info.layer, 0);
    if (info.layer == Layer::kObject) names.push_back("Cryptomatte crypto_object");
    if (info.layer == Layer::kMaterial) names.push_back("Cryptomatte crypto_material");
    known += (known.empty() ? ". Known names are " : "; ") + internal::ListOfChannels(names) + " for " + info.name;
  }
  std::vector<std::string> others;  // but R, G and B: of no meaning, or of layers of which no prefix is the one to read
  for (const std::string& name : contents.names) {
    const auto meaning = ParseChannelName(name);
    if (name.size() > 1 && !ParseMatteChannel(name) && (!meaning || missing.Has(meaning->layer)))
      others.push_back(name);
  }
  return known + (others.empty() ? "" : "; it also holds " + internal::ListOfChannels(others));
}

// A channel and the plane of the picture's size that it fills.
struct PlaneRead {
  int subimage;
  int channel;
  std::span<float> plane;
};

// A run of channels that one call reads.
struct ChannelRun {
  int first;
  int end;
};

// The selected channels of one part, in runs. Each call unpacks the whole part anew, so reading a few unneeded channels
// along is cheaper than leaving them out.
std::vector<ChannelRun> RunsOf(const std::vector<PlaneRead>& reads, int subimage) {
  constexpr int kCheapGap = 16;
  std::set<int> indices;
  for (const PlaneRead& read : reads) {
    if (read.subimage == subimage) indices.insert(read.channel);
  }
  std::vector<ChannelRun> runs;
  for (const int index : indices) {
    if (!runs.empty() && index <= runs.back().end + kCheapGap)
      runs.back().end = index + 1;
    else
      runs.push_back({index, index + 1});
  }
  return runs;
}

// Copies one channel out of interleaved rows into its plane. Pixels outside the data window stay background.
void Deinterleave(const OIIO::ImageSpec& spec, const std::vector<float>& pixels, const ChannelRun& run,
                  const PlaneRead& read) {
  const std::size_t stride = static_cast<std::size_t>(run.end - run.first);
  const int offset_x = spec.x - spec.full_x, offset_y = spec.y - spec.full_y;
  const int begin_x = std::max(0, -offset_x), end_x = std::min(spec.width, spec.full_width - offset_x);
  for (int y = 0; y < spec.height; ++y) {
    if (y + offset_y < 0 || y + offset_y >= spec.full_height) continue;
    const float* row = pixels.data() + std::size_t(y) * spec.width * stride + (read.channel - run.first);
    float* out = read.plane.data() + std::size_t(y + offset_y) * spec.full_width;
    for (int x = begin_x; x < end_x; ++x) out[x + offset_x] = row[x * stride];
  }
}

// Fills the planes from all parts of the file.
Status ReadPlanes(OIIO::ImageInput& input, const std::vector<PlaneRead>& reads, const std::string& name) {
  std::set<int> parts;
  for (const PlaneRead& read : reads) parts.insert(read.subimage);
  for (const int part : parts) {
    const OIIO::ImageSpec spec = input.spec(part);
    for (const ChannelRun& run : RunsOf(reads, part)) {
      std::vector<float> pixels(std::size_t(run.end - run.first) * spec.width * spec.height);
      if (!input.read_image(part, 0, run.first, run.end, OIIO::TypeDesc::FLOAT, pixels.data()) || input.has_error()) {
        Error failure = internal::ReadFailure(input, name);
        failure.message += "; render it again, or make its frame again with scumble guidegen --resume";
        return failure;
      }
      for (const PlaneRead& read : reads) {
        const bool in_run = read.subimage == part && read.channel >= run.first && read.channel < run.end;
        if (in_run) Deinterleave(spec, pixels, run, read);
      }
    }
  }
  return Ok();
}

void ReadHeader(const OIIO::ImageSpec& spec, GuideSet& guides) {
  std::map<std::string, std::string> texts;
  for (const OIIO::ParamValue& value : spec.extra_attribs) {
    if (value.type() == OIIO::TypeString) texts[std::string(value.name())] = std::string(value.get_string());
  }
  internal::TakeHeader(texts, guides);
}

// The prefix of the Cryptomattes that belong to a view layer. Those of Blender always have the view layer's.
std::string MattePrefix(const FileContents& contents, const std::string& prefix) {
  const bool has_its_own = std::any_of(contents.mattes.begin(), contents.mattes.end(),
                                       [&](const FoundMatte& found) { return found.meaning.prefix == prefix; });
  return has_its_own || contents.from_blender ? prefix : "";
}

Error LossyCompression(const std::string& name, const std::string& compression) {
  return InputError(name + ": its compression " + compression +
                    " is lossy, which Position and Cryptomatte do not survive; render it again with the codec ZIP");
}

// The Cryptomatte of a prefix that stands for a layer, its planes not yet read; without ranks where there is none.
// Coverage comes from all ranks of Blender's; of others the first two are enough.
Expected<Matte> MatteOf(const FileContents& contents, const std::string& prefix, Layer layer, const std::string& name) {
  Matte matte;
  for (const FoundMatte& found : contents.mattes) {
    if (found.meaning.prefix != prefix || found.meaning.layer != layer) continue;
    if (!contents.from_blender && found.meaning.index >= 4) continue;
    if (!found.is_float) {
      return InputError(name + ": its Cryptomatte " + found.meaning.matte +
                        " is stored in half floats, which no id survives; write it in 32-bit float");
    }
    if (found.compression.starts_with("dwa")) return LossyCompression(name, found.compression);
    if (matte.ranks.empty()) {
      const auto manifest = contents.manifests.find(found.meaning.matte);
      if (manifest != contents.manifests.end()) {
        SCUMBLE_ASSIGN(matte.manifest, ReadManifest(manifest->second, name));
        if (found.compression == "pxr24") {
          SCUMBLE_ASSIGN(matte.manifest, RoundedAsPxr24(matte.manifest, name));
        }
      }
    }
    const std::size_t index = static_cast<std::size_t>(found.meaning.index);
    if (matte.ranks.size() <= index) matte.ranks.resize((index / 4 + 1) * 4);
    matte.ranks[index].resize(std::size_t(contents.spec.full_width) * contents.spec.full_height);
  }
  return matte;
}

// The Cryptomattes of a prefix that stand for these layers. One that cannot be used is an error for a layer that is
// needed; others do without.
Expected<BlenderMattes> MattesOf(const FileContents& contents, const std::string& prefix, const LayerSet& layers,
                                 const LayerSet& needed, const std::string& name) {
  BlenderMattes mattes;
  for (const Layer layer : {Layer::kObject, Layer::kMaterial}) {
    if (!layers.Has(layer)) continue;
    Expected<Matte> matte = MatteOf(contents, prefix, layer, name);
    if (!matte && needed.Has(layer)) return matte.error();
    if (matte && !matte->ranks.empty()) mattes[layer] = std::move(*matte);
  }
  return mattes;
}

void ReadMattesToo(const FileContents& contents, const std::string& prefix, BlenderMattes& mattes,
                   std::vector<PlaneRead>& reads) {
  for (const FoundMatte& found : contents.mattes) {
    const auto matte = mattes.find(found.meaning.layer);
    const auto index = static_cast<std::size_t>(found.meaning.index);
    if (found.meaning.prefix != prefix || matte == mattes.end() || index >= matte->second.ranks.size()) continue;
    auto& plane = matte->second.ranks[index];
    reads.push_back({found.subimage, found.channel, plane});
  }
}

// Whether a view layer has all three channels of a pass.
bool HasPass(const FileContents& contents, const std::string& prefix, LightPass pass) {
  std::set<int> components;
  for (const FoundLight& found : contents.lights) {
    if (found.meaning.prefix == prefix && found.meaning.pass == pass) components.insert(found.meaning.component);
  }
  return components.size() == 3;
}

// The passes of a Blender render that make a layer.
std::vector<LightPass> LightFor(const FileContents& contents, const std::string& prefix, Layer layer) {
  std::vector<LightPass> passes;
  for (const LightPass pass : LightPassesFor(layer)) {
    if (contents.from_blender && HasPass(contents, prefix, pass)) passes.push_back(pass);
  }
  return passes;
}

// The view layer that the light is read from: the one that is named, or that of all else.
Expected<std::string> ChooseLightLayer(const FileContents& contents, const GuideReadOptions& options,
                                       const std::string& prefix, const std::string& name) {
  if (options.light_layer.empty()) return prefix;
  if (!contents.from_blender) {
    return InputError(name +
                      " is no Blender render: its light is in the layers luminance and shadow, and it needs no "
                      "--light-layer");
  }
  std::set<std::string> prefixes;
  for (const FoundLight& found : contents.lights) prefixes.insert(found.meaning.prefix);
  if (prefixes.count(options.light_layer)) return options.light_layer;
  std::string list;
  for (const std::string& one : prefixes) list += (list.empty() ? "'" : ", '") + one + "'";
  return InputError(
      name + " has no view layer '" + options.light_layer + "' with passes of light; " +
      (list.empty() ? "none has: switch on View Layer > Passes > Diffuse Direct, Shadow" : "there are " + list));
}

// The passes of the wanted layers that the file does not hold as such; their planes are to be read.
BlenderLight LightOf(const FileContents& contents, const std::string& prefix, const LayerSet& wanted,
                     const LayerSet& complete, std::vector<PlaneRead>& reads) {
  BlenderLight light;
  for (const Layer layer : {Layer::kLuminance, Layer::kShadow}) {
    if (!wanted.Has(layer) || complete.Has(layer)) continue;
    for (const LightPass pass : LightFor(contents, prefix, layer)) {
      for (const FoundLight& found : contents.lights) {
        if (found.meaning.prefix != prefix || found.meaning.pass != pass) continue;
        auto& plane = light[pass][std::size_t(found.meaning.component)];
        plane.resize(std::size_t(contents.spec.full_width) * contents.spec.full_height);
        reads.push_back({found.subimage, found.channel, plane});
      }
    }
  }
  return light;
}

// Layers that guidegen always writes need no option.
std::string RemedyFor(const LayerSet& missing, GuideUser user) {
  std::string asked;
  for (const LayerInfo& info : AllLayers()) {
    if (missing.Has(info.layer) && !AlwaysWritten().Has(info.layer))
      asked += (asked.empty() ? "" : ",") + std::string(info.name);
  }
  if (asked.empty()) return ". Make guides with `scumble guidegen`, or render that pass too";
  const std::string by_style =
      user == GuideUser::kFinish ? "" : ", or with the same --style, --assign, --set and --finish as here";
  return ". Make the guides again with --layers " + asked + by_style +
         "; where a renderer made them, render that pass too";
}

LayerSet EveryLayer() {
  LayerSet all;
  for (const LayerInfo& info : AllLayers()) all.Add(info.layer);
  return all;
}

// The error of a file that lacks layers; `there` is what it has.
Error LacksLayers(const FileContents& contents, const LayerSet& missing, const std::string& remedy,
                  const LayerSet& there, const std::vector<FoundChannel>& channels, const std::string& name) {
  return InputError(name + " has no layer " + missing.ToString() + remedy + ". It has " +
                    (there.empty() ? "none" : there.ToString()) + PartsOf(missing, channels) +
                    (contents.from_blender || contents.is_ours ? "" : KnownNames(missing, contents)));
}

// Fills the layers of ids from their Cryptomattes. A layer that is not required goes where its Cryptomatte is of no
// use.
Status TakeIdsOf(const BlenderMattes& mattes, const LayerSet& required, const std::string& name, GuideSet& guides) {
  for (const auto& [layer, matte] : mattes) {
    auto& names = layer == Layer::kObject ? guides.object_names : guides.material_names;
    const Status named = NameMattes(matte.ranks, matte.manifest, name, guides.Plane(layer), names);
    if (named) continue;
    if (required.Has(layer)) return named.error();
    guides.Remove(layer);
  }
  return Ok();
}

}  // namespace

Expected<GuideSet> ReadGuides(const std::filesystem::path& path, const GuideReadOptions& options) {
  const std::string name = path.string();
  SCUMBLE_ASSIGN(auto input, internal::OpenInput(path));
  SCUMBLE_ASSIGN(const FileContents contents, Survey(*input, name));
  if (!contents.from_blender && !options.blender_camera.empty()) {
    return InputError(name + " is no Blender render: its normals are taken to be in view space, and it needs no " +
                      options.blender_camera.string());
  }
  SCUMBLE_ASSIGN(const std::string prefix, ChoosePrefix(contents, options.view_layer, name));
  SCUMBLE_ASSIGN(const std::string light_layer, ChooseLightLayer(contents, options, prefix, name));
  LayerSet wanted = options.required;
  wanted.Add(options.optional);
  std::optional<GuideCamera> camera;
  BlenderMattes mattes;
  LayerSet read_along = wanted;
  if (contents.from_blender) {
    if (!options.blender_camera.empty()) {
      SCUMBLE_ASSIGN(camera, ReadBlenderCamera(options.blender_camera));
    }
    const LayerSet ids = {Layer::kObject, Layer::kMaterial};
    SCUMBLE_ASSIGN(mattes, MattesOf(contents, prefix, ids, ids, name));
    // One Cryptomatte is always read: it has the coverage that an opaque film's alpha lacks.
    if (!wanted.Has(Layer::kMaterial) && mattes.count(Layer::kObject)) mattes.erase(Layer::kMaterial);
    read_along.Add({Layer::kDepth, Layer::kPosition});
  }
  const std::vector<FoundChannel> channels = SelectChannels(contents, prefix, read_along, options.required);
  LayerSet complete = CompleteLayers(channels);
  const std::string matte_prefix = MattePrefix(contents, prefix);
  if (!contents.from_blender) {
    LayerSet without_ids;
    for (const Layer layer : {Layer::kObject, Layer::kMaterial}) {
      if (wanted.Has(layer) && !complete.Has(layer)) without_ids.Add(layer);
    }
    SCUMBLE_ASSIGN(mattes, MattesOf(contents, matte_prefix, without_ids, options.required, name));
  }
  LayerSet missing = options.required;
  for (const LayerInfo& info : AllLayers()) {
    const bool lit = !LightFor(contents, light_layer, info.layer).empty();
    if (complete.Has(info.layer) || mattes.count(info.layer) || lit) missing.Remove(info.layer);
  }
  const bool solves_camera = contents.from_blender && !camera;
  if (!contents.dwa.empty() && solves_camera) return LossyCompression(name, contents.dwa);
  if (solves_camera && !missing.empty()) {  // name at once the layers that the next run would lack
    for (const Layer layer : {Layer::kDepth, Layer::kPosition}) {
      if (!complete.Has(layer)) missing.Add(layer);
    }
  }
  if (!missing.empty()) {
    std::string remedy = contents.from_blender ? BlenderPassesFor(missing) : RemedyFor(missing, options.user);
    if (solves_camera && missing.Has(Layer::kPosition)) {
      remedy += ", or give the camera with --camera FILE, which does without Position";
    }
    const bool is_for_camera = solves_camera && (missing.Has(Layer::kDepth) || missing.Has(Layer::kPosition));
    if (options.remedy && !is_for_camera) remedy += options.remedy(missing);
    LayerSet there = CompleteLayers(SelectChannels(contents, prefix, EveryLayer(), EveryLayer()));
    for (const auto& [layer, matte] : mattes) there.Add(layer);
    return LacksLayers(contents, missing, remedy, there, channels, name);
  }
  GuideSet guides(contents.spec.full_width, contents.spec.full_height);
  for (const LayerInfo& info : AllLayers()) {
    const bool made = mattes.count(info.layer) || !LightFor(contents, light_layer, info.layer).empty();
    if (complete.Has(info.layer) || (made && wanted.Has(info.layer))) guides.Add(info.layer);
  }
  std::vector<PlaneRead> reads;
  for (const FoundChannel& found : channels) {
    if (!complete.Has(found.meaning.layer) || mattes.count(found.meaning.layer)) continue;
    reads.push_back({found.subimage, found.channel, guides.Plane(found.meaning.layer, found.meaning.component)});
  }
  ReadMattesToo(contents, matte_prefix, mattes, reads);
  const BlenderLight light = LightOf(contents, light_layer, wanted, complete, reads);
  SCUMBLE_RETURN_IF_ERROR(ReadPlanes(*input, reads, name));
  ReadHeader(contents.spec, guides);
  if (contents.from_blender) {
    SCUMBLE_RETURN_IF_ERROR(ConvertBlenderPasses(camera, mattes, light, name, guides));
    for (const Layer layer : {Layer::kDepth, Layer::kPosition}) {
      if (!wanted.Has(layer)) guides.Remove(layer);
    }
  } else {
    SCUMBLE_RETURN_IF_ERROR(TakeIdsOf(mattes, options.required, name, guides));
  }
  SCUMBLE_RETURN_IF_ERROR(internal::MakeValid(name, guides));
  return guides;
}

Expected<GuideFileInfo> InspectGuides(const std::filesystem::path& path) {
  const std::string name = path.string();
  SCUMBLE_ASSIGN(auto input, internal::OpenInput(path));
  SCUMBLE_ASSIGN(const FileContents contents, Survey(*input, name));
  const LayerSet all = EveryLayer();
  GuideFileInfo info{contents.spec.full_width,
                     contents.spec.full_height,
                     contents.has_half,
                     contents.from_blender,
                     !contents.mattes.empty(),
                     0,
                     {},
                     internal::ListOfChannels(contents.names),
                     {}};
  std::set<std::string> prefixes = ViewLayers(contents);
  if (prefixes.empty()) prefixes.insert("");
  for (const std::string& prefix : prefixes) {
    info.layers[prefix] = CompleteLayers(SelectChannels(contents, prefix, all, all));
    for (const FoundMatte& found : contents.mattes) {
      if (!contents.is_ours && found.meaning.prefix == MattePrefix(contents, prefix))
        info.layers[prefix].Add(found.meaning.layer);
    }
    for (const Layer layer : {Layer::kLuminance, Layer::kShadow}) {
      if (!LightFor(contents, prefix, layer).empty()) info.layers[prefix].Add(layer);
    }
  }
  ReadHeader(contents.spec, info.header);
  return info;
}

}  // namespace scumble::formats
