// The styles of one run: a default one, and those that --assign gives to objects and materials.
#pragma once

#include <string>
#include <vector>

#include "cli/options.h"
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

  const Style& first() const { return styles.front(); }
  // Everything that any of the styles reads, in any frame.
  Expected<LayerSet> Required() const;
  bool NeedsMap() const { return !assigned.empty(); }
};

// Opens the default style and every assigned one, each once. "rendered" leaves objects as they are,
// "catcher" shows nothing of them but the shadows on them.
Expected<StyleSet> OpenStyles(const StyleOptions& options);

// Which style paints which pixel, by the names in the guides; the last assignment that fits a name wins, an object's
// before its material's. Warns of patterns that fit nothing.
Expected<StyleMap> MapStyles(const StyleSet& set, const GuideSet& guides);

// Whether the name fits a pattern in which * stands for any text.
bool FitsPattern(const std::string& name, const std::string& pattern);

}  // namespace scumble
