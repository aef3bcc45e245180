// The styles of one run: a default one, and those that --assign gives to objects and materials.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "cli/options.h"
#include "guidegen/scene.h"
#include "image/guides.h"
#include "image/style.h"
#include "transfer/style_map.h"

namespace scumble {

struct StyleSet {
  struct Assigned {
    std::string pattern;  // name of an object or material; * stands for any text
    std::uint16_t style = 0;
  };
  std::vector<Style> styles;  // the default first, never empty
  std::vector<Assigned> assigned;
  std::map<std::string, std::uint16_t> wanted;  // by what the scene says; below `assigned`
  StyleOptions options;                         // that it was opened with
  std::size_t chosen = 1;                       // so many of `styles` are the user's, the others the scene's
  std::map<std::string, std::uint16_t> opened;  // by path

  const Style& first() const { return styles.front(); }
  // Whether any of these guides' pixels may have another style than the default.
  bool NeedsMap(const GuideSet& guides) const;
};

// What a scene's author wants painted otherwise, by name. From a scene: of the instances, and of materials in use.
struct StyleWishes {
  std::map<std::string, std::string> objects;
  std::map<std::string, std::string> materials;
};
StyleWishes WishesOf(std::span<const Instance> instances, const Scene& scene);
StyleWishes WishesOf(const GuideSet& guides);

// Opens what is wished for and not opened yet, except for what --assign settles and under --no-scene-styles, and returns
// everything that the user's styles and these read, in any frame. Paths are relative to the folder of `file`, the scene
// or guide file that the wishes are from. A kInput error names the object.
Expected<LayerSet> RequiredLayers(StyleSet& set, const StyleWishes& wishes, const std::string& file);

// Opens the default style and every assigned one, each once. "rendered" leaves objects as they are,
// "catcher" shows nothing of them but the shadows on them.
Expected<StyleSet> OpenStyles(const StyleOptions& options);

// Which style paints which pixel, by the names in the guides; the last assignment that fits a name wins, an object's
// before its material's, and both before what the scene says. Warns of patterns that fit nothing.
Expected<StyleMap> MapStyles(const StyleSet& set, const GuideSet& guides);

// Whether the name fits a pattern in which * stands for any text.
bool FitsPattern(const std::string& name, const std::string& pattern);

}  // namespace scumble
