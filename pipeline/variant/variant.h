// A variant of a style: what it changes of the style's own settings and of the guides. The grid that `tradeoff`
// measures is a list of variants, and so is the ladder that --quality and --budget-ms choose from.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/io/guide_precision.h"
#include "core/style/style_override.h"
#include "transfer/lookup_table.h"

namespace scumble {

struct Variant {
  std::string name;                     // unique in its list, "levels 3"; "the style" changes nothing
  std::string axis;                     // what it changes, "levels"
  std::string value;                    // to what, "3"
  std::vector<StyleOverride> settings;  // of all styles, in this order
  GuidePrecision precision = GuidePrecision::kFloat;
  double guide_scale = 1.0;  // width and height of the guides against the picture's: 0.5 is upsampled, 2 is thinned out
  bool upscale = false;      // with guide_scale < 1: painted at the guides' size and scaled up
  int samples = 0;           // of a pixel, for guides of light; 0: as many as --samples
  bool robust = true;        // Embree's robust mode, GuidegenOptions::robust
  int more_seed = 0;         // added to --seed
  int table_resolution = LookUpTable::kResolution;  // cells a side, where nearest neighbours come from a table
};

// The guides' size against the picture's in whole steps: smaller guides are upsampled so many times, larger ones
// painted as they are and averaged.
inline int UpsampleOf(const Variant& variant) {
  return variant.guide_scale < 1.0 ? static_cast<int>(std::lround(1.0 / variant.guide_scale)) : 1;
}
// The same, of the guides and of the painted picture.
inline int GuideFactorOf(const Variant& variant) { return variant.upscale ? 1 : UpsampleOf(variant); }
inline int PictureFactorOf(const Variant& variant) { return variant.upscale ? UpsampleOf(variant) : 1; }
inline int SupersampleOf(const Variant& variant) {
  return variant.guide_scale > 1.0 ? static_cast<int>(std::lround(variant.guide_scale)) : 1;
}

}  // namespace scumble
