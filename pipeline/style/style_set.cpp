#include "pipeline/style_set.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include "core/style/finish_chain.h"
#include "core/style/finish_keys.h"
#include "core/style/style_file.h"
#include "core/style/style_keyframes.h"
#include "core/style/style_keys.h"
#include "pipeline/finish_files.h"
#include "pipeline/finish_set.h"
#include "pipeline/style/assignments.h"
#include "pipeline/style_locations.h"

namespace scumble {
namespace {

constexpr const char *kRendered = "rendered", *kCatcher = "catcher";
// What a box ticked in Blender asks for: no slip where the style paints no shadows.
constexpr const char* kCatcherOrRendered = "catcher-or-rendered";

bool IsWord(const std::string& style) { return style == kRendered || style == kCatcher || style == kCatcherOrRendered; }

std::string PathOf(const std::filesystem::path& found) {
  std::error_code failed;
  return std::filesystem::weakly_canonical(found, failed).string();
}

// Whether the style paints shadows in some frame.
bool PaintsShadows(const Style& style) {
  const Expected<LayerSet> layers = LayersOverTime(style);
  return layers && layers->Has(Layer::kShadow);
}

// The place of a style in the set, which is opened if it is new.
Expected<std::uint16_t> PlaceOf(StyleSet& set, const std::string& name, const std::filesystem::path& base) {
  SCUMBLE_ASSIGN(const std::filesystem::path found, FindStyle(name, set.context, base));
  const std::string path = PathOf(found);
  if (const auto known = set.opened.find(path); known != set.opened.end()) return known->second;
  if (set.styles.size() >= std::size_t(StyleMap::kMaxStyles)) return UsageError("too many styles in one picture");
  SCUMBLE_RETURN_IF_ERROR(set.context.CheckNotCancelled());
  std::vector<StyleOverride> overrides;
  for (const StyleSet::Override& one : set.overrides) {
    if ((one.style.empty() && !IsOfFinish(one.key)) || one.path == path) overrides.push_back(one);
  }
  SCUMBLE_ASSIGN(Style style, LoadStyle(found, overrides, set.options.reading));
  for (const StyleSet::Override& one : set.overrides) {
    if (!one.style.empty() || !IsOfFinish(one.key)) continue;
    SCUMBLE_RETURN_IF_ERROR(OverrideFinish(style, one));
  }
  const auto& finishes = set.options.finishes;
  if (std::find(finishes.begin(), finishes.end(), kNoFinish) != finishes.end()) {
    // What makes the picture of toon and render stays.
    std::erase_if(style.finish, [&](const FinishPass& pass) { return EffectOf(pass).name != style.unpainted; });
  }
  set.styles.push_back(std::move(style));
  set.given.push_back(name);
  return set.opened[path] = static_cast<std::uint16_t>(set.styles.size() - 1);
}

// The place of a style, or what the reserved words mean.
Expected<std::uint16_t> PlaceOrWord(StyleSet& set, const std::string& name, const std::filesystem::path& base) {
  if (name == kRendered) return StyleMap::kPassThrough;
  if (name == kCatcher) return StyleMap::kShadowCatcher;
  if (name == kCatcherOrRendered) {
    return PaintsShadows(set.first()) ? StyleMap::kShadowCatcher : StyleMap::kPassThrough;
  }
  return PlaceOf(set, name, base);
}

bool IsAssigned(const StyleSet& set, const std::string& name) {
  return std::any_of(set.assigned.begin(), set.assigned.end(),
                     [&](const StyleSet::Assigned& one) { return one.pattern.Fits(name); });
}

// What a request means depends on the folder of the file that it is from.
std::string KeyOf(const std::string& style, const std::string& file) {
  return std::filesystem::path(file).parent_path().string() + "\n" + style;
}

// Opens the styles that are asked for, and adds their places to `read`.
Status OpenStyleRequests(StyleSet& set, const std::map<std::string, std::string>& requests, const std::string& kind,
                         const std::string& file, std::set<std::size_t>& read) {
  for (const auto& [name, style] : requests) {
    if (IsAssigned(set, name)) continue;
    const std::string key = KeyOf(style, file);
    if (const auto known = set.wanted.find(key); known != set.wanted.end()) {
      read.insert(known->second);
      continue;
    }
    const std::string who =
        file + ": " + kind + " '" + name + "' wants the style '" + style + "' (property scumble_style)";
    const std::string fix = "; fix the property, give --assign '" + name + "=STYLE', or --no-scene-styles";
    const Expected<std::uint16_t> place = PlaceOrWord(set, style, std::filesystem::path(file).parent_path());
    if (!place) {
      if (place.error().kind == ErrorKind::kCancelled) return place.error();
      return Error{place.error().kind, who + ": " + place.error().message + fix};
    }
    if (*place == StyleMap::kShadowCatcher && !PaintsShadows(set.first())) {
      return InputError(who + ", and the style of the picture paints no shadows that it could catch: give --set " +
                        "transfer.shadow=paint" + fix);
    }
    set.wanted[key] = *place;
    read.insert(*place);
  }
  return Ok();
}

// The styles of those whose request was granted, by id.
std::map<std::uint32_t, std::uint16_t> Granted(const StyleSet& set,
                                               const std::map<std::uint32_t, std::string>& requests,
                                               const std::string& file) {
  std::map<std::uint32_t, std::uint16_t> styles;
  for (const auto& [id, style] : requests) {
    if (const auto found = set.wanted.find(KeyOf(style, file)); found != set.wanted.end()) styles[id] = found->second;
  }
  return styles;
}

void NameStyleRequests(const std::map<std::uint32_t, std::string>& styles,
                       const std::map<std::uint32_t, std::string>& names,
                       std::map<std::string, std::string>& requests) {
  for (const auto& [id, style] : styles) {
    const auto name = names.find(id);
    requests[name != names.end() ? name->second : "id " + std::to_string(id)] = style;
  }
}

}  // namespace

bool StyleSet::NeedsMap(const GuideSet& guides, const std::string& file) const {
  return !assigned.empty() || !Granted(*this, guides.object_styles, file).empty() ||
         !Granted(*this, guides.material_styles, file).empty();
}

SceneStyleRequests SceneStyleRequestsOf(std::span<const Instance> instances, const Scene& scene) {
  SceneStyleRequests requests;
  for (const Instance& instance : instances) {
    if (!instance.style.empty()) requests.objects[instance.object] = instance.style;
    const Material& material = scene.materials[scene.meshes[instance.mesh].material];
    if (!material.style.empty()) requests.materials[material.name] = material.style;
  }
  return requests;
}

SceneStyleRequests SceneStyleRequestsOf(const GuideSet& guides) {
  SceneStyleRequests requests;
  NameStyleRequests(guides.object_styles, guides.object_names, requests.objects);
  NameStyleRequests(guides.material_styles, guides.material_names, requests.materials);
  return requests;
}

std::vector<std::string> StylesAskedFor(const SceneStyleRequests& requests, std::span<const NamePattern> patterns) {
  std::vector<std::string> styles;
  for (const auto* const list : {&requests.objects, &requests.materials}) {
    for (const auto& [name, style] : *list) {
      const bool is_assigned =
          std::any_of(patterns.begin(), patterns.end(), [&](const NamePattern& pattern) { return pattern.Fits(name); });
      if (!is_assigned && !IsWord(style)) styles.push_back(style);
    }
  }
  return styles;
}

LayerSet StyleSet::LayersOfNames(const SceneStyleRequests& requests) const {
  const bool asked = options.scene_styles && (!requests.objects.empty() || !requests.materials.empty());
  return asked || !assigned.empty() ? LayerSet{Layer::kObject, Layer::kMaterial} : LayerSet();
}

Expected<LayerSet> StyleLayers(StyleSet& set, const SceneStyleRequests& requests, const std::string& file) {
  std::set<std::size_t> read;
  for (std::size_t i = 0; i < set.chosen; ++i) read.insert(i);
  if (set.options.scene_styles) {
    SCUMBLE_RETURN_IF_ERROR(OpenStyleRequests(set, requests.objects, "object", file, read));
    SCUMBLE_RETURN_IF_ERROR(OpenStyleRequests(set, requests.materials, "material", file, read));
  }
  LayerSet layers;
  for (const std::size_t i : read) {
    if (i >= set.styles.size()) continue;  // words that are no style
    SCUMBLE_ASSIGN(const LayerSet of_style, LayersOverTime(set.styles[i]));
    layers.Add(of_style);
  }
  return layers.Add(LayersOverTime(set.finish));
}

Expected<LayerSet> RequiredLayers(StyleSet& set, const SceneStyleRequests& requests, const std::string& file) {
  SCUMBLE_ASSIGN(LayerSet layers, StyleLayers(set, requests, file));
  return layers.Add(set.LayersOfNames(requests));
}

namespace {

// A setting that reads layers, and how to do without.
struct Reader {
  const char* set;
  void (*off)(TransferSettings&);
};
constexpr Reader kReaders[] = {
    {"transfer.edge_aware=false", [](TransferSettings& settings) { settings.edge_aware = false; }},
    {"transfer.variety=0", [](TransferSettings& settings) { settings.variety = 0.0; }},
    {"transfer.coherent=false", [](TransferSettings& settings) { settings.coherent = false; }},
    {"transfer.edge=exact", [](TransferSettings& settings) { settings.edge = EdgeMode::kExact; }},
};

// Whether a style, at one frame or another, or a finishing pass reads one of the layers if these readers are off.
bool ReadsWithout(const StyleSet& set, const LayerSet& layers, const std::vector<const Reader*>& off) {
  LayerSet read = LayersOverTime(set.finish);
  for (Style style : set.styles) {
    for (const Reader* reader : off) reader->off(style.transfer);
    const Expected<LayerSet> of_style = LayersOverTime(style);
    read.Add(of_style ? *of_style : layers);
  }
  return std::any_of(AllLayers().begin(), AllLayers().end(),
                     [&](const LayerInfo& info) { return layers.Has(info.layer) && read.Has(info.layer); });
}

}  // namespace

std::string SetsWithout(const StyleSet& set, const LayerSet& layers) {
  std::vector<const Reader*> off;
  for (const Reader& reader : kReaders) off.push_back(&reader);
  if (ReadsWithout(set, layers, off)) return "";
  for (const Reader& reader : kReaders) {  // those that may as well stay on
    std::vector<const Reader*> fewer = off;
    std::erase(fewer, &reader);
    if (!ReadsWithout(set, layers, fewer)) off = fewer;
  }
  std::string sets;
  for (const Reader* reader : off) sets += (sets.empty() ? "--set " : " --set ") + std::string(reader->set);
  return sets;
}

namespace {

// An override of a style that nothing is painted in is a slip.
Status CheckOverrides(const StyleSet& set) {
  for (const StyleSet::Override& one : set.overrides) {
    if (one.style.empty() || set.opened.count(one.path)) continue;
    std::string names;
    for (const std::string& name : set.given) names += (names.empty() ? "" : ", ") + name;
    return UsageError("--set " + ToText(one) + ": --style and --assign give no style '" + one.style + "'; they give " +
                      names);
  }
  return Ok();
}

// The run's own passes, and whether every --set of a finish has found one.
Status SetFinishOfRun(StyleSet& set) {
  SCUMBLE_ASSIGN(set.finish, OpenFinish(set.options.finishes, set.context));
  std::vector<FinishPass> all;
  for (const Style& style : set.styles) all.insert(all.end(), style.finish.begin(), style.finish.end());
  for (const StyleSet::Override& one : set.overrides) {
    if (!one.style.empty() || !IsOfFinish(one.key)) continue;
    SCUMBLE_ASSIGN(std::size_t count, OverrideFinish(set.finish, one));
    FinishChain copy{all, {}};  // they are set already
    SCUMBLE_ASSIGN(const std::size_t of_styles, OverrideFinish(copy, one));
    if (count + of_styles > 0) continue;
    all.insert(all.end(), set.finish.passes.begin(), set.finish.passes.end());
    return NoSuchFinish(one, all);
  }
  return Ok();
}

}  // namespace

Expected<StyleSet> OpenStyles(const StyleRequest& options, const RunContext& context) {
  StyleSet set;
  set.options = options, set.context = context;
  for (const StyleOverride& one : options.sets) {
    const auto found = one.style.empty() ? Expected<std::filesystem::path>("") : FindStyle(one.style, context);
    set.overrides.push_back({one, found && !found->empty() ? PathOf(*found) : ""});
  }
  SCUMBLE_RETURN_IF_ERROR(PlaceOf(set, options.style, {}));
  SCUMBLE_ASSIGN(const std::vector<Assignment> assignments, ReadAssignments(options.assigned));
  std::map<std::string, std::uint16_t> by_name;  // thousands of assignments name few styles
  for (const auto& [pattern, name, where] : assignments) {
    if (!by_name.count(name)) {
      const Expected<std::uint16_t> place = PlaceOrWord(set, name, {});
      if (!place) {
        if (place.error().kind == ErrorKind::kCancelled) return place.error();
        return Error{place.error().kind, where + ": " + place.error().message};
      }
      by_name[name] = *place;
    }
    const std::uint16_t place = by_name[name];
    set.assigned.push_back({NamePattern(pattern), place, where});
    if (place == StyleMap::kShadowCatcher && !PaintsShadows(set.first())) {
      return UsageError(where + ": the style paints no shadows that it could catch; give --set " +
                        "transfer.shadow=paint, or " + pattern + "=rendered to leave it out");
    }
  }
  set.chosen = set.styles.size();
  SCUMBLE_RETURN_IF_ERROR(CheckOverrides(set));
  SCUMBLE_RETURN_IF_ERROR(SetFinishOfRun(set));
  for (Style& style : set.styles) SCUMBLE_RETURN_IF_ERROR(ReadFinishFiles(&style, context, style.finish));
  SCUMBLE_RETURN_IF_ERROR(ReadFinishFiles(&set.first(), context, set.finish.passes));
  return set;
}

void CloseSceneStyles(StyleSet& set) {
  set.styles.erase(set.styles.begin() + std::ptrdiff_t(set.chosen), set.styles.end());
  set.given.resize(set.chosen);
  set.wanted.clear();
  std::erase_if(set.opened, [&](const auto& one) { return one.second >= set.chosen; });
}

Expected<StyleMap> MapStyles(StyleSet& set, const GuideSet& guides, const std::string& file) {
  static const std::map<std::uint32_t, std::string> kNone;
  const bool has_objects = guides.Has(Layer::kObject), has_materials = guides.Has(Layer::kMaterial);
  const auto& objects = has_objects ? guides.object_names : kNone;
  const auto& materials = has_materials ? guides.material_names : kNone;
  RankedAssignment assignment;
  for (std::size_t rank = 0; rank < set.assigned.size(); ++rank) {
    StyleSet::Assigned& one = set.assigned[rank];
    bool fits = false;
    for (const auto& [names, styles] :
         {std::pair(&objects, &assignment.of_object), {&materials, &assignment.of_material}}) {
      for (const auto& [id, name] : *names) {
        if (!one.pattern.Fits(name)) continue;
        (*styles)[id] = {rank, one.style};
        fits = true;
      }
    }
    if (!fits && (!has_objects || !has_materials)) {
      const std::string lacks = has_objects     ? "layer material"
                                : has_materials ? "layer object"
                                                : "layers object and material";
      return InputError(one.where + ": " + file + " names no such object or material: " +
                        DescribeNames(one.pattern.text(), objects, materials) + "; it lacks the " + lacks +
                        ", which may know more: make guides with scumble guidegen, or render with that Cryptomatte");
    }
    if (!fits && !one.named && !one.warned) {
      one.warned = true;
      set.context.Warn(one.where + ": the scene has no such object or material; " +
                       DescribeNames(one.pattern.text(), objects, materials));
    }
    one.named = one.named || fits;
  }
  const auto granted = [&](bool has, const auto& requests) {
    return has ? Granted(set, requests, file) : std::map<std::uint32_t, std::uint16_t>();
  };
  StyleMap map = MapStyles(
      guides, {granted(has_objects, guides.object_styles), granted(has_materials, guides.material_styles), 0});
  std::vector<std::size_t> pixels(set.assigned.size());
  AssignStyles(guides, assignment, map, pixels);
  for (std::size_t rank = 0; rank < pixels.size(); ++rank) set.assigned[rank].pixels += pixels[rank];
  return map;
}

void WarnOfIdleAssignments(const StyleSet& set) {
  std::vector<std::string> idle;
  for (const StyleSet::Assigned& one : set.assigned) {
    if (one.named && one.pixels == 0) idle.push_back(one.where);
  }
  if (idle.empty()) return;
  set.context.Warn(SomeOf(idle) + (idle.size() == 1 ? " paints" : " paint") +
                   " no pixel: what is named there is not seen, or a later assignment names it too");
}

}  // namespace scumble
