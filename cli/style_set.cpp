#include "cli/style_set.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include "cli/command.h"
#include "style/style_file.h"
#include "style/style_keyframes.h"

namespace scumble {
namespace {

constexpr const char *kRendered = "rendered", *kCatcher = "catcher";

std::map<std::uint32_t, std::uint16_t> Assign(const std::vector<StyleSet::Assigned>& assigned,
                                              const std::map<std::uint32_t, std::string>& names,
                                              std::vector<bool>& used) {
  std::map<std::uint32_t, std::uint16_t> styles;
  for (std::size_t a = 0; a < assigned.size(); ++a) {
    for (const auto& [id, name] : names) {
      if (!FitsPattern(name, assigned[a].pattern)) continue;
      styles[id] = assigned[a].style;
      used[a] = true;
    }
  }
  return styles;
}

std::string SomeNames(const GuideSet& guides) {
  std::string list;
  int named = 0;
  for (const auto& [id, name] : guides.object_names) {
    if (++named > 12) return list + ", …";
    list += (list.empty() ? "" : ", ") + name;
  }
  return list.empty() ? "none" : list;
}

}  // namespace

bool FitsPattern(const std::string& name, const std::string& pattern) {
  std::size_t n = 0, p = 0, star = std::string::npos, resume = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++, resume = n;
    } else if (p < pattern.size() && pattern[p] == name[n]) {
      ++p, ++n;
    } else if (star != std::string::npos) {
      p = star + 1, n = ++resume;
    } else {
      return false;
    }
  }
  return std::all_of(pattern.begin() + std::ptrdiff_t(p), pattern.end(), [](char c) { return c == '*'; });
}

namespace {

// The place of a style in the set, which is opened if it is new.
Expected<std::uint16_t> PlaceOf(StyleSet& set, const std::string& name, const std::filesystem::path& base) {
  SCUMBLE_ASSIGN(const std::filesystem::path found, FindStyle(name, base));
  std::error_code failed;
  const std::string path = std::filesystem::weakly_canonical(found, failed).string();
  if (const auto known = set.opened.find(path); known != set.opened.end()) return known->second;
  if (set.styles.size() >= std::size_t(StyleMap::kMaxStyles)) return UsageError("too many styles in one picture");
  SCUMBLE_ASSIGN(Style style, LoadStyle(found, set.options.sets));
  set.styles.push_back(std::move(style));
  return set.opened[path] = static_cast<std::uint16_t>(set.styles.size() - 1);
}

// The same, or what the reserved words mean.
Expected<std::uint16_t> PlaceOrWord(StyleSet& set, const std::string& name, const std::filesystem::path& base) {
  if (name == kRendered) return StyleMap::kLeave;
  if (name == kCatcher) return StyleMap::kCatch;
  return PlaceOf(set, name, base);
}

bool IsAssigned(const StyleSet& set, const std::string& name) {
  return std::any_of(set.assigned.begin(), set.assigned.end(),
                     [&](const StyleSet::Assigned& one) { return FitsPattern(name, one.pattern); });
}

// Opens them, and adds the places of their styles to `read`.
Status AddWishes(StyleSet& set, const std::map<std::string, std::string>& wishes, const std::string& kind,
                 const std::string& file, std::set<std::size_t>& read) {
  for (const auto& [name, wish] : wishes) {
    if (IsAssigned(set, name)) continue;
    if (const auto known = set.wanted.find(wish); known != set.wanted.end()) {
      read.insert(known->second);
      continue;
    }
    const std::string who = file + ": " + kind + " '" + name + "' wants the style '" + wish +
                            "' (property scumble_style)";
    const std::string mend = "; mend the property, give --assign '" + name + "=STYLE', or --no-scene-styles";
    const Expected<std::uint16_t> place = PlaceOrWord(set, wish, std::filesystem::path(file).parent_path());
    if (!place) return Error{place.error().kind, who + ": " + place.error().message + mend};
    if (*place == StyleMap::kCatch && set.first().transfer.shadow == ShadowMode::kNone) {
      return InputError(who + ", and the style of the picture paints no shadows that it could catch: give --set " +
                        "transfer.shadow=paint" + mend);
    }
    set.wanted[wish] = *place;
    read.insert(*place);
  }
  return Ok();
}

std::map<std::uint32_t, std::uint16_t> Granted(const StyleSet& set, const std::map<std::uint32_t, std::string>& wishes) {
  std::map<std::uint32_t, std::uint16_t> styles;
  for (const auto& [id, wish] : wishes) {
    if (const auto found = set.wanted.find(wish); found != set.wanted.end()) styles[id] = found->second;
  }
  return styles;
}

void NameWishes(const std::map<std::uint32_t, std::string>& styles, const std::map<std::uint32_t, std::string>& names,
                std::map<std::string, std::string>& wishes) {
  for (const auto& [id, style] : styles) {
    const auto name = names.find(id);
    wishes[name != names.end() ? name->second : "id " + std::to_string(id)] = style;
  }
}

}  // namespace

bool StyleSet::NeedsMap(const GuideSet& guides) const {
  const auto any = [this](const auto& wishes) {
    return std::any_of(wishes.begin(), wishes.end(), [this](const auto& wish) { return wanted.count(wish.second) > 0; });
  };
  return !assigned.empty() || any(guides.object_styles) || any(guides.material_styles);
}

StyleWishes WishesOf(std::span<const Instance> instances, const Scene& scene) {
  StyleWishes wishes;
  for (const Instance& instance : instances) {
    if (!instance.style.empty()) wishes.objects[instance.object] = instance.style;
    const Material& material = scene.materials[scene.meshes[instance.mesh].material];
    if (!material.style.empty()) wishes.materials[material.name] = material.style;
  }
  return wishes;
}

StyleWishes WishesOf(const GuideSet& guides) {
  StyleWishes wishes;
  NameWishes(guides.object_styles, guides.object_names, wishes.objects);
  NameWishes(guides.material_styles, guides.material_names, wishes.materials);
  return wishes;
}

Expected<LayerSet> RequiredLayers(StyleSet& set, const StyleWishes& wishes, const std::string& file) {
  std::set<std::size_t> read;
  for (std::size_t i = 0; i < set.chosen; ++i) read.insert(i);
  bool needs_map = !set.assigned.empty();
  if (set.options.scene_styles) {
    SCUMBLE_RETURN_IF_ERROR(AddWishes(set, wishes.objects, "object", file, read));
    SCUMBLE_RETURN_IF_ERROR(AddWishes(set, wishes.materials, "material", file, read));
    needs_map = needs_map || !wishes.objects.empty() || !wishes.materials.empty();
  }
  LayerSet layers;
  for (const std::size_t i : read) {
    if (i >= set.styles.size()) continue;  // words that are no style
    SCUMBLE_ASSIGN(const LayerSet of_style, LayersOverTime(set.styles[i]));
    layers.Add(of_style);
  }
  if (needs_map) layers.Add(Layer::kObject).Add(Layer::kMaterial);
  return layers;
}

Expected<StyleSet> OpenStyles(const StyleOptions& options) {
  StyleSet set;
  set.options = options;
  SCUMBLE_RETURN_IF_ERROR(PlaceOf(set, options.style, {}));
  std::map<std::string, std::uint16_t> by_name;  // thousands of options name few styles
  for (const std::string& text : options.assigned) {
    // The last '=': names of objects are anyone's, names of styles rarely hold one.
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      return UsageError("--assign " + text + ": expected NAME=STYLE, as in 'Tree*=charcoal' or Glass=rendered");
    }
    const std::string pattern = text.substr(0, equals), name = text.substr(equals + 1);
    if (!by_name.count(name)) {
      SCUMBLE_ASSIGN(by_name[name], PlaceOrWord(set, name, {}));
    }
    const std::uint16_t place = by_name[name];
    set.assigned.push_back({pattern, place});
    if (place == StyleMap::kCatch && set.first().transfer.shadow == ShadowMode::kNone) {
      return UsageError("--assign " + text + ": the style paints no shadows that it could catch; give --set " +
                        "transfer.shadow=paint, or " + pattern + "=rendered to leave it out");
    }
  }
  set.chosen = set.styles.size();
  return set;
}

Expected<StyleMap> MapStyles(const StyleSet& set, const GuideSet& guides) {
  std::vector<bool> used(set.assigned.size());
  StyleAssignment assignment;
  assignment.of_material = Assign(set.assigned, guides.material_names, used);
  assignment.of_object = Assign(set.assigned, guides.object_names, used);
  for (std::size_t a = 0; a < used.size(); ++a) {
    if (used[a]) continue;
    Warn("--assign " + set.assigned[a].pattern + ": the scene has no such object or material; its objects are " +
         SomeNames(guides));
  }
  StyleMap map = MapStyles(guides, {Granted(set, guides.object_styles), Granted(set, guides.material_styles), 0});
  AssignStyles(guides, assignment, map);
  return map;
}

}  // namespace scumble
