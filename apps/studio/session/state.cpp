#include "apps/studio/session/state.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/style/finish_keys.h"

namespace scumble {
namespace {

using nlohmann::json;

Error WrongField(const std::string& field, const std::string& expected) {
  return UsageError(field + ": expected " + expected);
}

Expected<double> NumberOf(const json& value, const std::string& field, double least, double most) {
  const double number = value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (!(number >= least && number <= most)) {
    return WrongField(field, "a number, " + json(least).dump() + " to " + json(most).dump());
  }
  return number;
}

Expected<std::string> TextOf(const json& value, const std::string& field) {
  if (!value.is_string()) return WrongField(field, "a text");
  std::string text = value.get<std::string>();
  if (text.find('\0') != std::string::npos) return WrongField(field, "a text without the byte 0");  // no file has it
  return text;
}

// A member of an object; `otherwise` where it is left out.
Expected<double> MemberOf(const json& object, const std::string& field, const char* name, double least, double most,
                          std::optional<double> otherwise = std::nullopt) {
  if (!object.is_object()) return WrongField(field, "an object or null");
  if (!object.contains(name)) {
    if (otherwise) return *otherwise;
    return WrongField(field + "." + name, "a number");
  }
  return NumberOf(object[name], field + "." + name, least, most);
}

Expected<KeyValue> KeyValueOf(const StyleKey& key, const json& value) {
  if (value.is_boolean()) return KeyValue(value.get<bool>());
  if (value.is_string()) {
    SCUMBLE_ASSIGN(std::string text, TextOf(value, "keys." + key.name));
    return KeyValue(std::move(text));
  }
  if (value.is_number_integer() && key.kind == KeyKind::kWhole) return KeyValue(value.get<std::int64_t>());
  if (value.is_number()) return KeyValue(value.get<double>());
  return WrongField("keys." + key.name, "a number, a text, true, false or null");
}

// A page names files below the style's folder alone.
bool StaysInFolder(const std::filesystem::path& name) {
  return name.is_relative() && std::find(name.begin(), name.end(), "..") == name.end();
}

// As --set takes it: files count from the folder of the style's own.
KeyValue ForCommand(const std::string& key, const KeyValue& value, const StyleEntry* style) {
  const auto* text = std::get_if<std::string>(&value);
  const bool is_file = FindStyleKey(key)->kind == KeyKind::kFile && text && !text->empty() && text->front() != '#';
  return is_file && style ? KeyValue((style->toml().parent_path() / *text).string()) : value;
}

Status PatchKeys(StudioState& state, const json& value, const Catalogue& catalogue) {
  if (!value.is_object()) return WrongField("keys", "an object of keys and values");
  const StyleEntry* const entry = catalogue.FindStyle(state.style);
  for (const auto& [name, given] : value.items()) {
    const StyleKey* const key = FindStyleKey(name);
    if (!key) return WrongField("keys", "keys of style.toml; there is none called '" + name + "'");
    if (given.is_null()) {
      state.keys.erase(name);
      continue;
    }
    SCUMBLE_ASSIGN(const KeyValue wanted, KeyValueOf(*key, given));
    if (key->kind == KeyKind::kFile) {
      const auto* text = std::get_if<std::string>(&wanted);
      const bool names_file = text && !text->empty() && text->front() != '#';
      const bool has_file = entry && !entry->toml().empty();
      if (!text || (names_file && !(has_file && StaysInFolder(*text)))) {
        return WrongField("keys." + name, "a colour, as \"#f4efe6\", or a picture in the folder of the style's file");
      }
    }
    Style trial;
    const Status set = key->set(trial, wanted, entry ? entry->toml().parent_path() : std::filesystem::path());
    if (!set) return Error{set.error().kind, name + ": " + set.error().message};
    state.keys[name] = wanted;
  }
  return Ok();
}

Status PatchAssignments(StudioState& state, const json& value, const Catalogue& catalogue) {
  constexpr std::size_t kMost = 256;
  if (!value.is_array() || value.size() > kMost)
    return WrongField("assignments", "a list of name and style, 256 at most");
  state.assignments.clear();
  for (const json& one : value) {
    if (!one.is_object() || !one.contains("name") || !one.contains("style")) {
      return WrongField("assignments", "objects with name and style");
    }
    SCUMBLE_ASSIGN(const std::string name, TextOf(one["name"], "assignments.name"));
    SCUMBLE_ASSIGN(const std::string style, TextOf(one["style"], "assignments.style"));
    if (name.empty() || name.front() == '@' || name.find_first_of("=\n") != std::string::npos) {
      return WrongField("assignments.name", "the name of an object or material, without '='");
    }
    if (!catalogue.FindStyle(style)) return InputError("there is no style '" + style + "' in the list of styles");
    state.assignments.push_back({name, style});
  }
  return Ok();
}

Status PatchScene(StudioState& state, const json& value, const Catalogue& catalogue) {
  SCUMBLE_ASSIGN(const std::string id, TextOf(value, "scene"));
  if (!catalogue.FindScene(id)) return InputError("there is no scene '" + id + "' in the list of scenes");
  if (id == state.scene) return Ok();
  state.scene = id, state.camera.clear(), state.view.reset(), state.light.reset(), state.frame.reset();
  state.assignments.clear();
  return Ok();
}

Status PatchStyle(StudioState& state, const json& value, const Catalogue& catalogue) {
  SCUMBLE_ASSIGN(const std::string id, TextOf(value, "style"));
  if (!catalogue.FindStyle(id)) return InputError("there is no style '" + id + "' in the list of styles");
  if (id != state.style) state.style = id, state.keys.clear();
  return Ok();
}

Status PatchView(StudioState& state, const json& value, const Catalogue&) {
  if (value.is_null()) return state.view.reset(), Ok();
  constexpr double kFar = 1e12;
  ViewAngles view;
  SCUMBLE_ASSIGN(view.azimuth, MemberOf(value, "view", "azimuth", -1e6, 1e6));
  SCUMBLE_ASSIGN(view.elevation, MemberOf(value, "view", "elevation", -90, 90));
  SCUMBLE_ASSIGN(view.distance, MemberOf(value, "view", "distance", 0, kFar, 0.0));
  SCUMBLE_ASSIGN(view.right, MemberOf(value, "view", "right", -kFar, kFar, 0.0));
  SCUMBLE_ASSIGN(view.up, MemberOf(value, "view", "up", -kFar, kFar, 0.0));
  SCUMBLE_ASSIGN(view.fov, MemberOf(value, "view", "fov", 0, 180, 0.0));
  SCUMBLE_RETURN_IF_ERROR(CheckView(view));
  state.view = view;
  return Ok();
}

Status PatchLight(StudioState& state, const json& value, const Catalogue&) {
  if (value.is_null()) return state.light.reset(), Ok();
  LightAngles light;
  SCUMBLE_ASSIGN(light.azimuth, MemberOf(value, "light", "azimuth", -1e6, 1e6));
  SCUMBLE_ASSIGN(light.elevation, MemberOf(value, "light", "elevation", -90, 90));
  state.light = light;
  return Ok();
}

Status PatchFinish(StudioState& state, const json& value, const Catalogue& catalogue) {
  if (value.is_null()) return state.finish.reset(), Ok();
  if (!value.is_object() || !value.contains("name")) return WrongField("finish", "an object with name, or null");
  StudioFinish finish;
  SCUMBLE_ASSIGN(finish.name, TextOf(value["name"], "finish.name"));
  const auto is_it = [&](const FinishEntry& entry) { return entry.name == finish.name; };
  if (std::none_of(catalogue.finishes.begin(), catalogue.finishes.end(), is_it))
    return InputError("there is no finish '" + finish.name + "' in the list of finishes");
  for (const char* dial : kDials) {
    SCUMBLE_ASSIGN(const double turned, MemberOf(value, "finish", dial, 0.0, 1.0, 0.5));
    if (turned != 0.5) finish.dials[dial] = turned;
  }
  state.finish = std::move(finish);
  return Ok();
}

Status PatchSize(StudioState& state, const json& value, const Catalogue&) {
  if (!value.is_array() || value.size() != 2 || !value[0].is_number_integer() || !value[1].is_number_integer()) {
    return WrongField("size", "[width, height] in pixels");
  }
  SCUMBLE_ASSIGN(const double width, NumberOf(value[0], "size", 1, 16384));
  SCUMBLE_ASSIGN(const double height, NumberOf(value[1], "size", 1, 16384));
  const Size size{int(width), int(height)};
  SCUMBLE_RETURN_IF_ERROR(CheckSize(size, SizeToText(size)));
  state.size = size;
  return Ok();
}

Status PatchNumbers(StudioState& state, const std::string& field, const json& value) {
  if (field == "frame") {
    if (value.is_null()) return state.frame.reset(), Ok();
    SCUMBLE_ASSIGN(const double frame, NumberOf(value, field, -1e6, 1e6));
    if (frame != std::floor(frame)) return WrongField(field, "a whole number");
    state.frame = int(frame);
  } else if (field == "seed") {
    if (!value.is_number_unsigned()) return WrongField(field, "a whole number, 0 or more");
    state.seed = value.get<std::uint64_t>();
  } else {
    SCUMBLE_ASSIGN(state.budget_ms, NumberOf(value, field, 0, 1e6));
    if (state.budget_ms > 0) state.quality.reset();
  }
  return Ok();
}

Status PatchQuality(StudioState& state, const json& value, const Catalogue&) {
  SCUMBLE_ASSIGN(const std::string name, TextOf(value, "quality"));
  const std::optional<Quality> quality = FindQuality(name);
  if (!quality) return WrongField("quality", "draft, preview or final");
  state.quality = *quality == Quality::kFinal ? std::nullopt : quality;
  state.budget_ms = 0;
  return Ok();
}

Status PatchCamera(StudioState& state, const json& value, const Catalogue&) {
  SCUMBLE_ASSIGN(state.camera, TextOf(value.is_null() ? json("") : value, "camera"));
  state.view.reset();
  return Ok();
}

using PatchField = Status (*)(StudioState&, const json&, const Catalogue&);
// In this order: a scene and a style reset what depends on them before the rest is set.
constexpr std::pair<const char*, PatchField> kFields[] = {
    {"scene", PatchScene},   {"style", PatchStyle},     {"keys", PatchKeys},   {"assignments", PatchAssignments},
    {"camera", PatchCamera}, {"view", PatchView},       {"light", PatchLight}, {"finish", PatchFinish},
    {"size", PatchSize},     {"quality", PatchQuality},
};
constexpr const char* kNumberFields[] = {"frame", "seed", "budget_ms"};

}  // namespace

Expected<StudioState> Patched(StudioState state, const json& changes, const Catalogue& catalogue) {
  if (!changes.is_object()) return UsageError("expected an object of the fields to change");
  std::size_t known = 0;
  for (const auto& [field, patch] : kFields) {
    if (!changes.contains(field)) continue;
    SCUMBLE_RETURN_IF_ERROR(patch(state, changes[field], catalogue));
    ++known;
  }
  for (const char* field : kNumberFields) {
    if (!changes.contains(field)) continue;
    SCUMBLE_RETURN_IF_ERROR(PatchNumbers(state, field, changes[field]));
    ++known;
  }
  if (known == changes.size()) return state;
  return UsageError(
      "expected the fields scene, style, keys, assignments, camera, view, light, finish, frame, size, seed, quality, "
      "budget_ms "
      "alone");
}

json ToJson(const ViewAngles& view) {
  return {{"azimuth", view.azimuth},
          {"elevation", view.elevation},
          {"distance", view.distance},
          {"right", view.right},
          {"up", view.up},
          {"fov", view.fov}};
}

json ToJson(const StudioState& state) {
  json assignments = json::array(), keys = json::object();
  for (const auto& [name, style] : state.assignments) assignments.push_back({{"name", name}, {"style", style}});
  for (const auto& [name, value] : state.keys) {
    keys[name] = std::visit([](const auto& held) { return json(held); }, value);
  }
  json light = nullptr;
  if (state.light) light = {{"azimuth", state.light->azimuth}, {"elevation", state.light->elevation}};
  json finish = nullptr;
  if (state.finish) {
    finish = {{"name", state.finish->name}};
    for (const char* dial : kDials) {
      const auto turned = state.finish->dials.find(dial);
      finish[dial] = turned != state.finish->dials.end() ? turned->second : 0.5;
    }
  }
  return {{"scene", state.scene},
          {"style", state.style},
          {"keys", keys},
          {"assignments", assignments},
          {"camera", state.camera},
          {"view", state.view ? ToJson(*state.view) : json()},
          {"light", light},
          {"finish", finish},
          {"frame", state.frame ? json(*state.frame) : json()},
          {"size", {state.size.width, state.size.height}},
          {"seed", state.seed},
          {"quality", QualityNames()[std::size_t(state.quality.value_or(Quality::kFinal))]},
          {"budget_ms", state.budget_ms}};
}

PictureJob JobOf(const StudioState& state, const Catalogue& catalogue, const SceneRequest& scene, bool is_alone) {
  PictureJob job;
  job.state = ToJson(state).dump(-1, ' ', false, json::error_handler_t::replace);  // a file's name may be no UTF-8
  job.scene = scene;
  if (const SceneEntry* entry = catalogue.FindScene(state.scene)) job.scene.scene = entry->file;
  job.scene.camera = state.view ? "" : state.camera;  // the pipeline refuses both
  job.scene.view = state.view, job.scene.light = state.light;
  job.scene.size = state.size;
  const StyleEntry* const style = catalogue.FindStyle(state.style);
  if (style) job.style.style = style->given;
  for (const auto& [key, value] : state.keys) {
    job.style.sets.push_back(MakeExactOverride(key, ForCommand(key, value, style)));
    if (!is_alone) job.style.sets.back().style = job.style.style;
  }
  for (const StudioAssignment& one : state.assignments) {
    if (const StyleEntry* entry = catalogue.FindStyle(one.style)) {
      job.style.assigned.push_back(one.name + "=" + entry->given);
    }
  }
  if (state.finish) {
    job.style.finishes.push_back(state.finish->name);
    for (const auto& [dial, turned] : state.finish->dials)
      job.style.sets.push_back(MakeExactOverride(kDialKeys + dial, turned));
  }
  job.picture.frame = state.frame, job.picture.seed = state.seed, job.picture.fps = scene.fps;
  job.budget.quality = state.quality, job.budget.budget_ms = state.budget_ms;
  return job;
}

}  // namespace scumble
