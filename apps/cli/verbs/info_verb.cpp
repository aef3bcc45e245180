// scumble info: the contents of a guide file, a scene or a style.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "apps/cli/app/command.h"
#include "apps/cli/app/json_text.h"
#include "apps/cli/app/options.h"
#include "core/io/guide_file.h"
#include "core/style/finish_keys.h"
#include "core/style/style_file.h"
#include "guidegen/load_scene.h"
#include "guidegen/scene_textures.h"
#include "pipeline/prepare_frame.h"
#include "pipeline/scene_guides.h"
#include "pipeline/style_locations.h"
#include "pipeline/style_set.h"

namespace scumble {
namespace {

using Json = nlohmann::ordered_json;

// Whether transfer can read a Blender render directly.
std::string BlenderNote(const GuideFileInfo& info) {
  std::string missing;
  for (const auto& [layer, pass] : {std::pair{Layer::kPosition, "Position"}, {Layer::kDepth, "Z"}}) {
    const bool everywhere = std::all_of(info.layers.begin(), info.layers.end(),
                                        [layer = layer](const auto& entry) { return entry.second.Has(layer); });
    if (!everywhere) missing += (missing.empty() ? "" : " and ") + std::string(pass);
  }
  return missing.empty() ? "rendered by Blender: transfer finds its camera from Position and Z, or takes --camera FILE"
                         : "rendered by Blender, without " + missing + ": transfer needs --camera FILE";
}

Expected<Json> DescribeGuides(const std::string& path) {
  SCUMBLE_ASSIGN(const GuideFileInfo info, InspectGuides(path));
  Json json{{"kind", "guides"}, {"width", info.width}, {"height", info.height}, {"channels", info.channels}};
  for (const auto& [view_layer, layers] : info.layers) {
    json[view_layer.empty() ? "layers" : "layers of " + view_layer] = layers.ToString();
  }
  if (info.fragments > 0) json["fragments"] = info.fragments;
  if (info.from_blender) json["note"] = BlenderNote(info);
  for (const auto& [id, name] : info.header.object_names) json["objects"].push_back(name);
  for (const auto& [id, name] : info.header.material_names) json["materials"].push_back(name);
  for (const auto& [name, style] : SceneStyleRequestsOf(info.header).objects) json["styles"][name] = style;
  for (const auto& [name, style] : SceneStyleRequestsOf(info.header).materials) json["material styles"][name] = style;
  if (info.header.camera) json["camera"] = info.header.camera->name;
  for (const auto& [name, value] : info.header.attributes) json[name] = value;
  return json;
}

Json DescribeScene(const Scene& scene) {
  std::size_t triangles = 0, segments = 0;
  for (const Instance& instance : scene.instances) {
    triangles += scene.meshes[instance.mesh].triangles.size();
    segments += scene.meshes[instance.mesh].curves.segments.size();
  }
  const auto textures = std::count_if(scene.textures.begin(), scene.textures.end(),
                                      [](const Picture& picture) { return !picture.empty(); });
  Json json{{"kind", "scene"}, {"triangles", triangles}, {"textures", textures}};
  if (segments > 0) json["segments of hair"] = segments;
  const auto names = [&](const char* key, const auto& items, auto name_of) {
    json[key] = Json::array();
    std::set<std::string> told;
    for (const auto& item : items) {
      if (told.insert(name_of(item)).second) json[key].push_back(name_of(item));
    }
  };
  names("objects", scene.instances, [](const Instance& i) { return i.object; });
  for (const Instance& instance : scene.instances) {
    if (!instance.style.empty()) json["styles"][instance.object] = instance.style;
    if (instance.pass_index != 0) json["pass_indices"][instance.object] = instance.pass_index;
  }
  names("materials", scene.materials, [](const Material& m) { return m.name; });
  for (const Material& material : scene.materials) {
    if (!material.style.empty()) json["material styles"][material.name] = material.style;
  }
  names("cameras", scene.cameras, [](const Camera& c) { return c.name; });
  names("lights", scene.lights, [](const Light& light) {
    constexpr const char* kTypes[] = {"point", "spot", "sun", "area"};
    return light.name + " (" + kTypes[static_cast<int>(light.type)] + ")";
  });
  return json;
}

Expected<Json> DescribeSceneFile(const std::string& path) {
  Expected<AnimatedScene> animated = AnimatedScene::Load(path);
  // If the animation is invalid, the scene at rest is shown all the same.
  SCUMBLE_ASSIGN(const Scene scene, animated ? Expected<Scene>(animated->rest()) : LoadScene(path));
  Json json = DescribeScene(scene);
  if (animated && !animated->animations().empty()) {
    json["animations"] = animated->animations();
    json["seconds"] = animated->duration_seconds();
  }
  json["warnings"] = scene.warnings;
  if (!animated) json["warnings"].push_back(animated.error().message);
  return json;
}

Expected<Json> DescribeBlenderScene(const std::string& path, const BlenderRequest& blender, const Globals& globals) {
  SCUMBLE_ASSIGN(Scene scene, LoadBlenderScene(path, blender, globals));
  SCUMBLE_RETURN_IF_ERROR(DecodeAllTextures(scene));
  Json json = DescribeScene(scene);
  json["warnings"] = scene.warnings;
  return json;
}

struct InfoVerb {
  std::string path;
  BlenderRequest blender;
};

Json ToJson(const KeyValue& value) {
  if (const auto* color = std::get_if<Rgb16>(&value)) return ColorText(*color);
  return std::visit([](const auto& held) { return Json(held); }, value);
}

// The effect, the keys that differ from its defaults, its name where it has another one, and what it is for.
std::string Describe(const FinishPass& pass) {
  std::string text = EffectOf(pass).name;
  const FinishPass plain{"", EffectOf(pass).defaults, FinishPass::Stage::kPaint, 1.0, {}, {}};
  for (const auto keys : {CommonFinishKeys(), std::span<const FinishKey>(EffectOf(pass).keys)}) {
    for (const FinishKey& key : keys) {
      const KeyValue value = key.get(pass);
      if (value != key.get(plain)) text += fmt::format(" {}={}", key.name, ToText(value));
    }
  }
  if (pass.name != EffectOf(pass).name) text += fmt::format(" name=\"{}\"", pass.name);
  const auto lists = [&](const char* key, const std::vector<std::string>& names) {
    if (!names.empty()) text += fmt::format(" {}=[\"{}\"]", key, fmt::join(names, "\", \""));
  };
  lists("objects", pass.objects);
  lists("materials", pass.materials);
  return text;
}

Expected<Json> DescribeStyle(const std::string& path, const Globals& globals) {
  SCUMBLE_ASSIGN(const Style style, OpenStyle({path, {}, {}}, globals));
  constexpr const char* kMethods[] = {"litsphere", "styleblit", "bruteforce"};
  SCUMBLE_ASSIGN(const std::filesystem::path file, FindStyle(path, globals));
  SCUMBLE_ASSIGN(const auto values, StyleValues(file));
  const bool is_painted = style.unpainted.empty();
  Json json{{"kind", "style"}, {"name", style.name}, {"licence", style.licence}};
  json["method"] = is_painted ? kMethods[static_cast<int>(style.transfer.method)] : style.unpainted;
  json["settings"] = Json::object();
  for (const StyleKey& key : StyleKeys()) {
    const KeyValue& value = values.at(key.name);
    if (key.name.starts_with("transfer.") && key.name != "transfer.method" && value != key.Default())
      json["settings"][key.name] = ToJson(value);
  }
  for (const StyleTrack& track : style.tracks) {
    Json& keys = json["settings"][track.name] = Json::array();
    for (const StyleTrack::Key& key : track.keys) keys.push_back({key.frame, ToJson(key.value)});
  }
  json["finish"] = Json::array();
  for (const FinishPass& pass : style.finish) json["finish"].push_back(Describe(pass));
  json["exemplars"] = Json::array();
  if (!is_painted) return json;
  for (const Exemplar& exemplar : style.exemplars) {
    std::string text = fmt::format("{} {}×{}", exemplar.name, exemplar.picture.width, exemplar.picture.height);
    if (style.exemplars.size() > 1) text += ", " + DescribeLuminance(exemplar, style.transfer.rim);
    json["exemplars"].push_back(std::move(text));
  }
  return json;
}

// Names with commas between, the first ones of many: a meadow has thousands.
std::string FirstNames(const Json& names) {
  constexpr std::size_t kShown = 40;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kShown); ++i) {
    text += (i == 0 ? "" : ", ") + OneLine(names[i].get<std::string>());
  }
  if (names.size() > kShown) text += fmt::format(" and {} more: --json lists them all", names.size() - kShown);
  return text.empty() ? "none" : text;
}

std::string ToText(const Json& json) {
  std::size_t widest = 0;
  for (const auto& [key, value] : json.items()) widest = std::max(widest, key.size());
  std::string text;
  for (const auto& [key, value] : json.items()) {
    std::string shown;
    if (key == "exemplars" || key == "finish" || key == "warnings") {  // sentences, one a line
      const std::string between = "\n" + std::string(widest + 2, ' ');
      for (const Json& item : value) shown += (shown.empty() ? "" : between) + OneLine(item.get<std::string>());
      if (shown.empty()) shown = "none";
    } else if (value.is_array()) {
      shown = FirstNames(value);
    } else if (value.is_object()) {
      for (const auto& [name, item] : value.items()) {
        shown += (shown.empty() ? "" : ", ") + OneLine(name) + ": " +
                 (item.is_string() ? OneLine(item.get<std::string>()) : item.dump());
      }
      if (shown.empty()) shown = "the defaults";
    } else {
      shown = value.is_string() ? OneLine(value.get<std::string>()) : value.dump();
    }
    text += fmt::format("{:<{}}  {}\n", key, widest, shown);
  }
  return text;
}

Expected<Json> Describe(const InfoVerb& verb, const Globals& globals) {
  const std::string& path = verb.path;
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending == ".blend") return DescribeBlenderScene(path, verb.blender, globals);
  SCUMBLE_RETURN_IF_ERROR(CheckWithoutBlender(path, verb.blender));
  if (ending == ".exr") return DescribeGuides(path);
  if (ending == ".glb" || ending == ".gltf" || ending == ".obj" || ending == ".ply") return DescribeSceneFile(path);
  return DescribeStyle(path, globals);
}

}  // namespace

void AddInfoVerb(CLI::App& app, Globals& globals, Action& chosen) {
  CLI::App* sub = app.add_subcommand("info", "what is in a guide file, a scene or a style");
  auto verb = std::make_shared<InfoVerb>();
  sub->add_option("file", verb->path,
                  "guide file (.exr), scene (.glb, .gltf, .obj, .ply, or .blend, which Blender exports first), style, "
                  "or picture of a painted sphere")
      ->type_name("FILE")
      ->required();
  AddBlenderOptions(*sub, verb->blender);
  AddGlobalOptions(*sub, globals);
  sub->callback([=, &globals, &chosen] {
    chosen = [=, &globals]() -> Expected<ExitCode> {
      SCUMBLE_ASSIGN(const Json json, Describe(*verb, globals));
      Print(globals.json ? JsonText(json) : ToText(json));
      return ExitCode::kOk;
    };
  });
}

}  // namespace scumble
