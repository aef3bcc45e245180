// The ladder of --quality and --budget-ms: steps from the style itself down to the quickest variant.
//
// A step lowers the accuracy of a style, never its look. Guides are cast smaller or with fewer samples, pictures are
// scaled up, blended less, or their sources found more simply; colours, thresholds, edges and sizes are the artist's.
// The steps are ordered by the guided texture distance (measure/guided_texture.h). bench/ladder_bench measures
// it; docs/budget.md has the table.
#pragma once

#include <string>
#include <vector>

#include "core/image/status.h"
#include "pipeline/style_set.h"
#include "pipeline/variant/variant.h"

namespace scumble {

// What the guides leave to choose.
struct LadderFrame {
  bool casts = false;  // guides are made, so they may be smaller than the picture
  // Of the picture. Guides are 2 or 4 times smaller where that divides both, else not as small as a step asks.
  int width = 0, height = 0;
  bool fixed_guides = false;  // the user gave their size
  int samples = 0;  // of a pixel of light; 0: no choice, because no layer takes samples or the user gave their number
  bool full_size = false;  // something lies underneath, or pixels are explained: no picture is scaled up
};

// The most accurate first: the style as it is. What a --set of the user decides stays so. Steps that change nothing, or
// that equal another one then, are left out. Never empty.
std::vector<Variant> QualityLadder(const StyleSet& styles, const LadderFrame& frame);

// Named steps.
enum class Quality {
  // To find a camera: a picture of half the size, scaled up, of light with few samples. Where no picture may be scaled
  // up, nothing is blended or split.
  kDraft,
  // To judge a style: guides that hold light, which are slow, are half the size, with few samples. Where guides keep
  // their size, nothing is blended. A picture without light in its guides is quick enough as it is.
  kPreview,
  kFinal,  // the style as it is
};
Variant VariantOf(Quality quality, const StyleSet& styles, const LadderFrame& frame);

// The options of stylize and transfer that repeat a variant: "--upsample 2 --upscale --samples
// 4"; empty for the style as it is.
std::string OptionsOf(const Variant& variant);

// Puts the variant's settings into all styles, and into those that the scene asks for later. Pictures are those that
// --set options before the user's would make.
Status ApplyVariant(const Variant& variant, StyleSet& styles);

}  // namespace scumble
