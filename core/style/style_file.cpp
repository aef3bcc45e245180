#include "core/style/style_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/io/atomic_file.h"
#include "core/io/channel_file.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "core/io/readable_file.h"
#include "core/style/finish/finish_tables.h"
#include "core/style/finish_chain.h"
#include "core/style/finish_keys.h"
#include "core/style/nearest_name.h"
#include "core/style/place_sphere.h"
#include "core/style/rectify.h"
#include "core/style/sphere_template.h"
#include "core/style/style_edit.h"
#include "core/style/style_keyframes.h"
#include "core/style/style_keys.h"
#include "core/style/toml_values.h"

namespace scumble {
namespace {

namespace fs = std::filesystem;

using internal::Exists, internal::ParseToml, internal::ValueOf, internal::Where;

// The name of a style without one: its folder's, or its file's without the ending.
std::string NameFor(const fs::path& path, bool is_folder) {
  if (!is_folder && path.filename() != "style.toml") return path.stem().string();
  std::error_code failed;
  const fs::path whole = fs::absolute(path, failed).lexically_normal();
  const fs::path folder = is_folder && whole.has_filename() ? whole : whole.parent_path();
  return folder.filename().string();
}

Error Explain(Error error, const std::string& where, const std::string& key, const KeyValue& value) {
  // To the last digit, or a number just out of range would look as if it were in it.
  const std::string text = std::holds_alternative<double>(value) ? TomlText(value) : ToText(value);
  error.message = where + ": " + key + " = " + text + ": " + error.message;
  return error;
}

std::string KnownKeys(const std::string& section) {
  std::string names;
  for (const StyleKey& key : StyleKeys()) {
    if (section.empty() ? key.name.find('.') != std::string::npos : key.name.rfind(section, 0) != 0) continue;
    names += (names.empty() ? "" : ", ") + key.name.substr(section.size());
  }
  return names;
}

// `where` is the file and line, or the option, that holds the value. A wrong key or value is kUsage.
Expected<const StyleKey*> KnownKey(const std::string& name, const std::string& where) {
  const StyleKey* key = FindStyleKey(name);
  if (!key && FindStyleKey("transfer." + name)) {
    return UsageError(where + ": unknown key " + name + "; it belongs to [transfer]: transfer." + name);
  }
  if (!key) {
    const std::string section = name.rfind(kGuideWeights, 0) == 0 ? kGuideWeights
                                : name.rfind("transfer.", 0) == 0 ? "transfer."
                                                                  : "";
    std::vector<std::string> names;
    for (const StyleKey& known : StyleKeys()) names.push_back(known.name);
    const std::string nearest = NearestName(name, names);
    return UsageError(where + ": unknown key " + name + (nearest.empty() ? "" : "; did you mean " + nearest + "?") +
                      "; there are " + KnownKeys(section) +
                      (section.empty() ? ", [transfer], [[exemplar]] and [[finish]]" : ""));
  }
  return key;
}

// `frames`: none where a list is no list of frames with their values.
Status SetTrack(Style& style, const StyleKey& key, std::optional<std::vector<StyleTrack::Key>> frames,
                const std::string& where, const fs::path& folder) {
  if (!frames) {
    return UsageError(where + ": " + key.name + ": expected a plain value, or frames with their values as " +
                      "[[1, 0.1], [24, 0.3]]");
  }
  StyleTrack track;
  track.keys = *std::move(frames), track.folder = folder;
  if (auto done = AddTrack(style, key, std::move(track)); !done) {
    return Error{done.error().kind, where + ": " + done.error().message};
  }
  return Ok();
}

Status SetKey(Style& style, const StyleKey& key, const KeyValue& value, const std::string& where,
              const fs::path& folder) {
  RemoveTrack(style, key.name);
  if (auto done = key.set(style, value, folder); !done) return Explain(done.error(), where, key.name, value);
  return Ok();
}

Status SetKeyByNode(Style& style, const std::string& name, const toml::node& node, const fs::path& file) {
  const std::string where = Where(file.string(), node);
  SCUMBLE_ASSIGN(const StyleKey* const key, KnownKey(name, where));
  if (const auto* pairs = node.as_array()) {
    return SetTrack(style, *key, internal::FramesOf(*pairs), where, file.parent_path());
  }
  const auto value = ValueOf(node);
  if (!value) return UsageError(where + ": " + name + " must be a plain value");
  return SetKey(style, *key, *value, where, file.parent_path());
}

// In a file a mistake is the file's and not the caller's.
Status SetKeyInFile(Style& style, const std::string& name, const toml::node& node, const fs::path& file) {
  auto done = SetKeyByNode(style, name, node, file);
  if (done || done.error().kind != ErrorKind::kUsage) return done;
  return InputError(done.error().message);
}

// A table's keys, those of tables inside it included: [transfer.guide_weights] "lpe.LDE" = 1 or lpe.LDE = 1.
Status SetKeysInFile(Style& style, const std::string& section, const toml::table& table, const fs::path& file) {
  for (const auto& [inner, node] : table) {
    const std::string name = section + "." + std::string(inner.str());
    const bool holds_keys = std::any_of(StyleKeys().begin(), StyleKeys().end(),
                                        [&](const StyleKey& key) { return key.name.rfind(name + ".", 0) == 0; });
    if (const auto* deeper = node.as_table(); deeper && holds_keys) {
      SCUMBLE_RETURN_IF_ERROR(SetKeysInFile(style, name, *deeper, file));
    } else {
      SCUMBLE_RETURN_IF_ERROR(SetKeyInFile(style, name, node, file));
    }
  }
  return Ok();
}

std::string SizeText(int width, int height) { return std::to_string(width) + "×" + std::to_string(height); }

// A sphere of `scumble sphere`, by its size and margin: cuts the template's margin off a picture painted over it.
Status FitToSphere(int size, int margin, const fs::path& guides, Exemplar& exemplar) {
  Picture& picture = exemplar.picture;
  const int with_margin = size + 2 * margin;
  if (picture.width == size && picture.height == size) return Ok();
  if (picture.width != with_margin || picture.height != with_margin) {
    const bool is_scan = FindTemplate(picture).has_value();
    return InputError(exemplar.name + " is " + SizeText(picture.width, picture.height) + ", its guides " +
                      guides.string() + " are " + SizeText(size, size) + ": paint at " +
                      SizeText(with_margin, with_margin) + " (the whole template) or " + SizeText(size, size) +
                      " (the sphere alone)" +
                      (is_scan ? "; a scan gets its size and place from `scumble sphere --rectify`" : ""));
  }
  Picture cut(size, size);
  for (int y = 0; y < size; ++y) std::copy_n(picture.At(margin, y + margin), 4 * size, cut.At(0, y));
  picture = std::move(cut);
  exemplar.margin = margin;
  return Ok();
}

// A picture that cannot be counted cannot be read either; reading it gives the reason.
Expected<Picture> ReadWithin(const StyleReading& reading, const fs::path& path) {
  constexpr std::uint64_t kPixelBytes = 4 * sizeof(std::uint16_t);
  if (reading.room) {
    if (const auto pixels = CountPixels(path)) SCUMBLE_RETURN_IF_ERROR(reading.room(kPixelBytes * *pixels));
  }
  return reading.read_picture ? reading.read_picture(path) : ReadPicture(path);
}

// `info` is the file's own.
Expected<GuideSet> ReadWithin(const StyleRoom& room, const fs::path& path, const GuideFileInfo& info,
                              const GuideReadOptions& options) {
  std::uint64_t channels = 0;
  for (const LayerInfo& layer : AllLayers()) {
    const bool read = options.required.Has(layer.layer) || options.optional.Has(layer.layer);
    if (read) channels += static_cast<std::uint64_t>(ChannelCount(layer.layer));
  }
  const auto pixels = static_cast<std::uint64_t>(info.width) * static_cast<std::uint64_t>(info.height);
  if (room) SCUMBLE_RETURN_IF_ERROR(room(sizeof(float) * channels * pixels));
  return ReadGuides(path, options);
}

// Gives the exemplar its guides. `measure`: its luminance is wanted and not known.
Status ReadExemplarGuides(const fs::path& path, bool measure, const StyleRoom& room, Exemplar& exemplar) {
  exemplar.guides_file = path;
  SCUMBLE_ASSIGN(const GuideFileInfo info, InspectGuides(path));
  GuideReadOptions options;
  if (const auto margin = info.width == info.height ? SphereMargin(info.header) : std::nullopt) {
    // The sphere's normals have a formula: the file is read only for its light.
    SCUMBLE_RETURN_IF_ERROR(FitToSphere(info.width, *margin, path, exemplar));
    const auto layers = info.layers.find("");
    if (!measure || layers == info.layers.end() || !layers->second.Has(Layer::kLuminance)) return Ok();
    options.required.Remove(Layer::kDepth).Remove(Layer::kObject).Remove(Layer::kMaterial).Add(Layer::kLuminance);
    SCUMBLE_ASSIGN(exemplar.guides, ReadWithin(room, path, info, options));
    return Ok();
  }
  const Picture& picture = exemplar.picture;
  if (picture.width != info.width || picture.height != info.height) {
    return InputError(exemplar.name + " is " + SizeText(picture.width, picture.height) + ", its guides " +
                      path.string() + " are " + SizeText(info.width, info.height) +
                      ": paint over a picture of the scene that has the guides' size");
  }
  options.required.Remove(Layer::kDepth).Remove(Layer::kObject).Remove(Layer::kMaterial);
  if (measure) options.optional.Add(Layer::kLuminance);
  SCUMBLE_ASSIGN(exemplar.guides, ReadWithin(room, path, info, options));
  exemplar.is_sphere = false;
  return Ok();
}

// The template that `scumble sphere` wrote with these guides.
fs::path TemplateBeside(const fs::path& folder, const std::string& guides) {
  const std::string kGuides = "guides";
  std::string stem = fs::path(guides).stem().string();
  if (const std::size_t at = stem.rfind(kGuides); at != std::string::npos) stem.replace(at, kGuides.size(), "template");
  for (const char* ending : {".png", ".ora"}) {
    if (Exists(folder / (stem + ending))) return folder / (stem + ending);
  }
  return folder / "template.png";
}

// Looks for the files that a painter may have saved instead of the picture that style.toml names.
Status CheckPaintingIsThere(const fs::path& image, const fs::path& drawn, bool several, const std::string& file) {
  if (Exists(image)) return Ok();
  const fs::path layered = fs::path(image).replace_extension(".ora");
  if (Exists(layered)) {
    return InputError(image.string() + " is not there, and " + layered.string() + " is: write image = \"" +
                      layered.filename().string() + "\" into " + file + ", or export it as " +
                      image.filename().string());
  }
  if (!Exists(drawn)) return Ok();
  return InputError(image.string() + " is not there yet: paint over " + drawn.string() +
                    " and save it under that name" + (several ? ", or take its [[exemplar]] out of " + file : ""));
}

// The style.toml that is read, and how its pictures are.
struct StyleSource {
  fs::path path;
  const StyleReading& reading;
};

std::optional<double> LuminanceOf(const std::optional<KeyValue>& value) {
  const auto luminance = value ? AsNumber(*value) : std::nullopt;
  return luminance && *luminance >= 0.0 && std::isfinite(*luminance) ? luminance : std::nullopt;
}

// `several`: the style has more than one exemplar, so that their luminances matter.
Expected<Exemplar> ReadExemplar(const toml::table& table, const StyleSource& source, bool several) {
  const std::string file = source.path.string();
  const fs::path folder = source.path.parent_path();
  std::string image, guides;
  Exemplar exemplar;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const std::string where = Where(file, node);
    if (name == "luminance") {
      exemplar.luminance = LuminanceOf(ValueOf(node));
      if (!exemplar.luminance) return InputError(where + ": exemplar.luminance: expected a number, 0 or more");
      continue;
    }
    if (name == "fills") {
      const auto* flag = node.as_boolean();
      if (!flag) return InputError(where + ": exemplar.fills: expected true or false");
      exemplar.fills = flag->get();
      continue;
    }
    if (name != "image" && name != "guides") {
      return InputError(where + ": unknown key exemplar." + name + "; there are image, guides, luminance, fills");
    }
    const auto* text = node.as_string();
    if (!text) return InputError(where + ": exemplar." + name + " must be a file's name in quotes");
    (name == "image" ? image : guides) = text->get();
  }
  if (image.empty()) return InputError(Where(file, table) + ": [[exemplar]] has no image; add image = \"lit.png\"");
  const fs::path image_path = folder / image;
  SCUMBLE_RETURN_IF_ERROR(CheckPaintingIsThere(image_path, TemplateBeside(folder, guides), several, file));
  exemplar.name = image_path.string();
  SCUMBLE_ASSIGN(exemplar.picture, ReadWithin(source.reading, image_path));
  if (!guides.empty()) {
    SCUMBLE_RETURN_IF_ERROR(
        ReadExemplarGuides(folder / guides, several && !exemplar.luminance, source.reading.room, exemplar));
  }
  return exemplar;
}

// The layers that the style's weights name, for exemplars that do not hold them yet.
Status ReadWeighedGuides(Style& style, const StyleRoom& room) {
  const LayerSet wanted = style.transfer.guide_weights.Layers().Remove(Layer::kNormal);
  if (wanted.empty()) return Ok();
  for (Exemplar& exemplar : style.exemplars) {
    if (exemplar.guides_file.empty()) {
      return InputError(
          exemplar.name + " has no guides, and transfer.guide_weights asks for " + wanted.ToString() +
          ": give [[exemplar]] guides that hold them, as `scumble sphere --layers` and `scumble guidegen` "
          "write them");
    }
    if (exemplar.guides && exemplar.guides->layers().Contains(wanted)) continue;
    SCUMBLE_ASSIGN(const GuideFileInfo info, InspectGuides(exemplar.guides_file));
    LayerSet held;
    for (const auto& [view_layer, layers] : info.layers) held.Add(layers);
    if (!held.Contains(wanted)) {
      return InputError(exemplar.guides_file.string() + " holds " + held.ToString() +
                        ", and transfer.guide_weights asks for " + wanted.ToString() +
                        ": write them with --layers, or leave their weights at 0");
    }
    GuideReadOptions options;
    options.required = LayerSet{Layer::kCoverage, Layer::kNormal}.Add(wanted);
    if (exemplar.guides) options.required.Add(exemplar.guides->layers());
    SCUMBLE_ASSIGN(exemplar.guides, ReadWithin(room, exemplar.guides_file, info, options));
  }
  return Ok();
}

Status ReadExemplars(const toml::node& node, const StyleSource& source, Style& style) {
  const std::string file = source.path.string();
  const auto* array = node.as_array();
  if (!array) return InputError(Where(file, node) + ": write [[exemplar]] with two brackets");
  if (array->size() > std::size_t(kMaxExemplars)) {
    return InputError(Where(file, node) + ": " + std::to_string(array->size()) + " exemplars: a style has up to " +
                      std::to_string(kMaxExemplars) + ", for different light");
  }
  for (const auto& item : *array) {
    const auto* table = item.as_table();
    if (!table) return InputError(Where(file, item) + ": write [[exemplar]] with two brackets");
    SCUMBLE_ASSIGN(Exemplar exemplar, ReadExemplar(*table, source, array->size() > 1));
    style.exemplars.push_back(std::move(exemplar));
  }
  return Ok();
}

Status ReadFinish(const toml::node& node, const fs::path& path, Style& style) {
  std::vector<internal::FinishFrames> frames;
  SCUMBLE_ASSIGN(style.finish, internal::ReadFinishTables(node, path.string(), frames));
  for (const internal::FinishFrames& one : frames) {
    const std::string where = Where(path.string(), *one.pairs);
    const auto done =
        SetTrack(style, *KeyOfTrack(style, one.key), internal::FramesOf(*one.pairs), where, path.parent_path());
    if (!done) return InputError(done.error().message);
  }
  return Ok();
}

Expected<Style> ReadStyleFile(const fs::path& path, const StyleReading& reading) {
  SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(path, kMaxStyleBytes));
  const std::string file = path.string();
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  SCUMBLE_ASSIGN(const toml::table root, ParseToml(text, file));
  Style style;
  style.read_picture = reading.read_picture;
  for (const auto& [key, node] : root) {
    const std::string name(key.str());
    if (name == "exemplar") {
      SCUMBLE_RETURN_IF_ERROR(ReadExemplars(node, {path, reading}, style));
    } else if (name == "finish") {
      SCUMBLE_RETURN_IF_ERROR(ReadFinish(node, path, style));
    } else if (const auto* table = node.as_table(); table && name == "transfer") {
      SCUMBLE_RETURN_IF_ERROR(SetKeysInFile(style, name, *table, path));
    } else {
      SCUMBLE_RETURN_IF_ERROR(SetKeyInFile(style, name, node, path));
    }
  }
  if (style.transfer.guide_weights.Layers().empty()) {
    return InputError(Where(file, *root["transfer"]["guide_weights"].node()) +
                      ": transfer.guide_weights are all 0: nothing is left to match by; give a layer a weight above 0");
  }
  if (style.exemplars.empty() && style.unpainted.empty()) {
    const bool has_guides = Exists(path.parent_path() / "guides.exr");
    return InputError(file + " has no [[exemplar]]; add [[exemplar]]" + (has_guides ? ", " : " and ") +
                      "image = \"lit.png\"" + (has_guides ? " and guides = \"guides.exr\"" : "") + " under it");
  }
  return style;
}

// "exemplar.2.luminance" or "exemplar.2.fills", the keys of an exemplar that can change after its files are read.
Status SetExemplarKey(Style& style, const std::string& name, const std::optional<KeyValue>& value) {
  const std::string where = "--set " + name + ": ";
  const std::string last = std::to_string(style.exemplars.size());
  const std::size_t begin = std::string_view("exemplar.").size(), dot = name.find('.', begin);
  if (dot == std::string::npos) {
    return UsageError(where + (name == "exemplar.luminance"
                                   ? "say whose, exemplar.1.luminance to exemplar." + last + ".luminance"
                                   : "expected exemplar.1.luminance or exemplar.1.fills; other keys of [[exemplar]] "
                                     "are set in style.toml"));
  }
  const std::string key = name.substr(dot + 1);
  if (key != "luminance" && key != "fills") {
    return UsageError(where + "only luminance and fills can be set here; image and guides are set in style.toml");
  }
  const std::string number = name.substr(begin, dot - begin);
  const bool is_number =
      !number.empty() && number.size() < 4 && number.find_first_not_of("0123456789") == std::string::npos;
  const std::size_t index = is_number ? std::stoul(number) : 0;
  if (index < 1 || index > style.exemplars.size()) {
    return UsageError(where + "style " + style.name + " has the exemplars 1 to " + last);
  }
  Exemplar& exemplar = style.exemplars[index - 1];
  if (key == "fills") {
    const auto* flag = value ? std::get_if<bool>(&*value) : nullptr;
    if (!flag) return UsageError(where + "expected true or false");
    exemplar.fills = *flag;
    return Ok();
  }
  exemplar.luminance = LuminanceOf(value);
  if (!exemplar.luminance) return UsageError(where + "expected a number, 0 or more");
  return Ok();
}

Status ApplyOverride(Style& style, const StyleOverride& set) {
  if (IsOfFinish(set.key)) {
    SCUMBLE_ASSIGN(const std::size_t count, OverrideFinish(style, set));
    return count > 0 ? Ok() : Status(NoSuchFinish(set, style.finish, style.name));
  }
  const auto* value = std::get_if<KeyValue>(&set.value);
  if (set.key.rfind("exemplar.", 0) == 0) {
    return SetExemplarKey(style, set.key, value ? std::optional(*value) : std::nullopt);
  }
  SCUMBLE_ASSIGN(const StyleKey* const key, KnownKey(set.key, "--set"));
  if (value) return SetKey(style, *key, *value, "--set", fs::path());
  const auto& frames = std::get<StyleOverride::Frames>(set.value);
  return SetTrack(style, *key, frames.empty() ? std::nullopt : std::optional(frames), "--set", fs::path());
}

// Of a method without a painting: the effect that makes the picture, over plain paint that asks for nothing.
Status MakeUnpainted(Style& style) {
  if (style.unpainted.empty()) return Ok();
  const auto is_it = [&](const FinishPass& pass) { return EffectOf(pass).name == style.unpainted; };
  if (std::none_of(style.finish.begin(), style.finish.end(), is_it)) {
    SCUMBLE_ASSIGN(FinishPass pass, MakeFinishPass(style.unpainted));
    style.finish.insert(style.finish.begin(), std::move(pass));
  }
  const int reference_height = style.transfer.reference_height;
  const ShadowMode shadow = style.transfer.shadow;
  style.transfer = TransferSettings();
  style.transfer.method = Method::kLitSphere, style.transfer.reference_height = reference_height;
  style.transfer.edge_aware = false, style.transfer.blend_radius = 0, style.transfer.shadow = shadow;
  Exemplar grey;
  grey.name = style.unpainted, grey.fills = true;
  grey.picture = Picture(16, 16);
  for (std::size_t i = 0; i < grey.picture.rgba.size(); ++i) grey.picture.rgba[i] = i % 4 == 3 ? 65535 : 32896;
  style.exemplars.assign(1, std::move(grey));
  std::erase_if(style.tracks, [](const StyleTrack& track) {
    return track.name != "transfer.paper" && track.name.rfind(kFinishKeys, 0) != 0;
  });
  return Ok();
}

// Keys of finishing effects last: the method brings one.
Status ApplyOverrides(Style& style, const std::vector<StyleOverride>& overrides) {
  for (const StyleOverride& set : overrides) {
    if (!IsOfFinish(set.key)) SCUMBLE_RETURN_IF_ERROR(ApplyOverride(style, set));
  }
  if (style.exemplars.empty() && style.unpainted.empty()) {
    return UsageError("style " + style.name + " has no painting: transfer.method must be toon or render");
  }
  SCUMBLE_RETURN_IF_ERROR(MakeUnpainted(style));
  for (const StyleOverride& set : overrides) {
    if (IsOfFinish(set.key)) SCUMBLE_RETURN_IF_ERROR(ApplyOverride(style, set));
  }
  return Ok();
}

// A picture named as a style. If the picture belongs to a style, that style is used: a painted template by itself would
// show its margin.
Expected<Style> ReadPictureStyle(const fs::path& path, const StyleReading& reading) {
  const fs::path beside = path.parent_path() / "style.toml";
  if (Exists(beside)) {
    auto style = ReadStyleFile(beside, reading);
    const bool has_picture = style && !style->exemplars.empty();
    if (has_picture && fs::path(style->exemplars.front().name).filename() == path.filename()) return style;
    if (!style && style.error().kind != ErrorKind::kInput)
      return style.error();  // too large, whichever style it belongs to
  }
  SCUMBLE_ASSIGN(Picture picture, ReadWithin(reading, path));
  if (LooksLikeTemplate(picture)) {
    return InputError(path.string() +
                      " is a whole template, margin and marks included: name the folder that "
                      "`scumble sphere` wrote as the style, or crop the picture to the sphere");
  }
  Style style;
  style.read_picture = reading.read_picture;
  Exemplar exemplar;
  exemplar.name = path.string(), exemplar.picture = std::move(picture);
  style.exemplars.push_back(std::move(exemplar));
  return style;
}

Status CheckIsPainted(const Exemplar& exemplar) {
  const std::vector<std::uint16_t>& rgba = exemplar.picture.rgba;
  for (std::size_t i = 3; i < rgba.size(); i += 4) {
    if (rgba[i] > 0) return Ok();
  }
  const auto channels = ReadChannels(exemplar.name);
  const auto* const alpha = channels ? channels->Find("A") : nullptr;
  const bool has_nan = alpha && std::any_of(alpha->begin(), alpha->end(), [](float a) { return std::isnan(a); });
  return InputError(exemplar.name + " shows no paint: " +
                    (has_nan ? "its alpha is NaN, which counts as transparent, where it is not 0; write the picture "
                               "with an alpha of 0 to 1"
                             : "all of its pixels are transparent; paint on it, or show its layers and save it again"));
}

// Of a value, or of key frames at frame 0.
std::optional<KeyValue> ValueAtStart(const StyleKey& key, const toml::node& node) {
  const auto* pairs = node.as_array();
  if (!pairs) return ValueOf(node);
  StyleTrack track;
  track.keys = internal::FramesOf(*pairs).value_or(track.keys);
  if (track.keys.empty()) return std::nullopt;
  if (key.kind == KeyKind::kFile) return ValueAt(track, 0);  // AddTrack would read the files
  Style scratch;
  if (!AddTrack(scratch, key, std::move(track))) return std::nullopt;
  return ValueAt(scratch.tracks.front(), 0);
}

void CollectValues(const toml::table& table, const std::string& section, std::map<std::string, KeyValue>& values) {
  for (const auto& [key, node] : table) {
    const std::string name = section + std::string(key.str());
    if (const auto* inner = node.as_table()) CollectValues(*inner, name + ".", values);
    const auto known = values.find(name);
    if (known == values.end()) continue;
    auto value = ValueAtStart(*FindStyleKey(name), node);
    if (value && std::holds_alternative<double>(known->second)) {
      if (const auto number = AsNumber(*value)) value = *number;
    }
    if (value) known->second = *value;
  }
}

}  // namespace

Expected<std::map<std::string, KeyValue>> StyleValues(const fs::path& path) {
  std::map<std::string, KeyValue> values;
  for (const StyleKey& key : StyleKeys()) values[key.name] = key.Default();
  std::error_code failed;
  const fs::file_status kind = fs::status(path, failed);
  if (!fs::exists(kind) && IsUnpainted(path.string())) return values["transfer.method"] = path.string(), values;
  if (!fs::exists(kind)) return InputError("cannot read style " + path.string() + ": there is no such file or folder");
  const bool is_picture = !fs::is_directory(kind) && path.extension() != ".toml";
  const fs::path file = fs::is_directory(kind) ? path / "style.toml"
                        : is_picture           ? path.parent_path() / "style.toml"
                                               : path;
  if (is_picture && !Exists(file)) return values;
  SCUMBLE_ASSIGN(const auto bytes, ReadWholeFile(file, kMaxStyleBytes));
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  Expected<toml::table> root = ParseToml(text, file.string());
  if (!root && !is_picture) return std::move(root).error();
  // A picture beside a style.toml that does not name it first has no file.
  const auto image = root ? (*root)["exemplar"][0]["image"].value<std::string>() : std::nullopt;
  if (!is_picture || (image && fs::path(*image).filename() == path.filename())) CollectValues(*root, "", values);
  return values;
}

Expected<Style> LoadStyle(const fs::path& path, const std::vector<StyleOverride>& overrides,
                          const StyleReading& reading) {
  std::error_code failed;
  const fs::file_status kind = fs::status(path, failed);
  Style style;
  if (!fs::exists(kind)) {
    if (!IsUnpainted(path.string()))
      return InputError("cannot read style " + path.string() + ": there is no such file or folder");
    style.name = style.unpainted = path.string();
  } else if (fs::is_directory(kind)) {
    if (!Exists(path / "style.toml")) return InputError("style folder " + path.string() + " holds no style.toml");
    SCUMBLE_ASSIGN(style, ReadStyleFile(path / "style.toml", reading));
  } else if (path.extension() == ".toml") {
    SCUMBLE_ASSIGN(style, ReadStyleFile(path, reading));
  } else {
    SCUMBLE_ASSIGN(style, ReadPictureStyle(path, reading));
  }
  if (style.name.empty()) style.name = NameFor(path, fs::is_directory(kind));
  SCUMBLE_RETURN_IF_ERROR(ApplyOverrides(style, overrides));
  SCUMBLE_RETURN_IF_ERROR(ReadWeighedGuides(style, reading.room));
  for (Exemplar& exemplar : style.exemplars) {
    SCUMBLE_RETURN_IF_ERROR(CheckIsPainted(exemplar));
    SCUMBLE_RETURN_IF_ERROR(PlaceSphere(exemplar));
    const Picture& picture = exemplar.picture;
    if (!exemplar.is_sphere || picture.width == picture.height) continue;
    return InputError(exemplar.name + " is " + SizeText(picture.width, picture.height) +
                      ": an exemplar is a square that its sphere fills; crop it to the sphere, or give the guides of "
                      "the scene that it shows");
  }
  return style;
}

std::vector<fs::path> FindStyles(const fs::path& root) {
  std::vector<fs::path> styles;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(root, failed)) {
    if (Exists(entry.path() / "style.toml")) styles.push_back(entry.path());
  }
  std::sort(styles.begin(), styles.end());
  return styles;
}

}  // namespace scumble
