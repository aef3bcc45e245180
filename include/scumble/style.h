// Which style paints, and what is changed of it.
#pragma once

#include <string>
#include <vector>

namespace scumble {

struct StyleSettings {
  std::string style;  // a folder, a style.toml, a picture of a painted sphere, or a bundled style's name
  // "transfer.scale=0.5" in all styles of the picture, "oil:transfer.scale=0.5" in one; the later wins.
  std::vector<std::string> overrides = {};
  // "Tree*=charcoal": another style for objects or materials whose name fits.
  std::vector<std::string> assignments = {};
  // Finishing effects and presets after the styles' own, "comic"; "none" drops those of the styles.
  std::vector<std::string> finishes = {};
  bool follow_scene = true;  // the styles that the scene gives its objects (property scumble_style)
};

}  // namespace scumble
