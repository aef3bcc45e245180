#include "cli/style_set.h"

#include <algorithm>
#include <map>

#include "cli/command.h"
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

Expected<LayerSet> StyleSet::Required() const {
  LayerSet layers;
  for (const Style& style : styles) {
    SCUMBLE_ASSIGN(const LayerSet read, LayersOverTime(style));
    layers.Add(read);
  }
  if (NeedsMap()) layers.Add(Layer::kObject).Add(Layer::kMaterial);
  return layers;
}

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

Expected<StyleSet> OpenStyles(const StyleOptions& options) {
  StyleSet set;
  SCUMBLE_ASSIGN(Style first, OpenStyle(options));
  set.styles.push_back(std::move(first));
  std::map<std::string, std::uint16_t> opened{{options.style, 0}, {kRendered, StyleMap::kLeave},
                                               {kCatcher, StyleMap::kCatch}};
  for (const std::string& text : options.assigned) {
    // The last '=': names of objects are anyone's, names of styles rarely hold one.
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      return UsageError("--assign " + text + ": expected NAME=STYLE, as in 'Tree*=charcoal' or Glass=rendered");
    }
    const std::string pattern = text.substr(0, equals), name = text.substr(equals + 1);
    if (!opened.count(name)) {
      if (set.styles.size() >= std::size_t(StyleMap::kMaxStyles)) return UsageError("--assign: too many styles");
      StyleOptions one = options;
      one.style = name;
      SCUMBLE_ASSIGN(Style style, OpenStyle(one));
      opened[name] = static_cast<std::uint16_t>(set.styles.size());
      set.styles.push_back(std::move(style));
    }
    set.assigned.push_back({pattern, opened[name]});
    if (name == kCatcher && set.first().transfer.shadow == ShadowMode::kNone) {
      return UsageError("--assign " + text + ": the style paints no shadows that it could catch; give --set " +
                        "transfer.shadow=paint, or " + pattern + "=rendered to leave it out");
    }
  }
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
  return MapStyles(guides, assignment);
}

}  // namespace scumble
