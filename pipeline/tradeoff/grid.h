// The grid that `scumble tradeoff` measures: variants around a style's own settings.
#pragma once

#include <string>
#include <vector>

#include "core/image/style.h"
#include "pipeline/variant/variant.h"

namespace scumble {

struct TradeGridOptions {
  int width = 0, height = 0;  // of the picture
  bool quick = false;         // the small grid
  bool chance = false;        // the guides need samples: lights with extent, or light paths
  int samples = 0;            // the style's own, where they were given
};

struct TradeGrid {
  std::vector<Variant> variants;      // "the style" first, then "the exact variant", then axis by axis
  std::vector<std::string> left_out;  // each with its reason
};

// Names of axes for what changes nothing and for what the others are measured against.
inline constexpr const char* kStyleAxis = "style";
inline constexpr const char* kExactAxis = "exact";

// One axis at a time around the style; without --quick also every combination of method, blend_radius, levels and
// resolution of a few values, and the style itself with other seeds. What the style has anyway is left out of its axis,
// and so is what would change nothing: levels of the Lit Sphere, tables where guides of light are weighed.
TradeGrid MakeTradeGrid(const Style& style, const TradeGridOptions& options);

// The axes in the grid's order, each once.
std::vector<std::string> AxesOf(const std::vector<Variant>& variants);

// The variants that --only names, "levels,nearest*": those of an axis of that name, and those whose own name fits; with
// the style in any case. A kUsage error lists the axes where a part names nothing.
Expected<std::vector<Variant>> ChooseVariants(const std::vector<Variant>& variants, const std::string& only);

}  // namespace scumble
