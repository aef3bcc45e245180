// The ladder of --quality and --budget-ms: ways to do it with less, from the style itself down to the quickest.
//
// A step takes from the style what makes accuracy, never what makes its look: guides may be cast with fewer samples and
// smaller, and the paint's places be found more simply; colours, thresholds, edges and sizes are the artist's. The
// order is that of the measured energy (measure/energy/energy.h); bench/ladder_bench measures it, and docs/budget.md
// has the table.
#pragma once

#include <string>
#include <vector>

#include "core/image/status.h"
#include "pipeline/style/style_set.h"
#include "pipeline/variant/variant.h"

namespace scumble {

// What the guides leave to choose.
struct LadderFrame {
  bool casts = false;  // guides are made, so they may be smaller than the picture
  // Of the picture. Guides are 2, 4 or 8 times smaller where that divides both, else not as small as a step asks.
  int width = 0, height = 0;
  bool fixed_guides = false;  // the user has said how large they are
  int samples = 0;  // that a pixel of light gets; 0: no choice, as no light is cast, by no chance, or the user has said
};

// The most accurate first: the style as it is. What a --set of the user decides stays so, and ways that then come to
// the same, or that change nothing of any of the styles, are left out. Never empty.
std::vector<Variant> QualityLadder(const StyleSet& styles, const LadderFrame& frame);

// Whether which of two steps is nearer differs by style, so that their order in the ladder is little more than chance:
// one without blending, the other by the Lit Sphere, with guides of one size.
bool AreContenders(const Variant& a, const Variant& b);

// Named points of it.
enum class Quality {
  // For finding a camera: the Lit Sphere, and guides of a quarter of the size where they may be smaller and hold light
  // or
  // are weighed, with few samples. Of guides of normals alone smaller ones save less than it takes to upsample them.
  kDraft,
  // For judging a style: guides of half the size and with few samples where they hold light, which is what makes them
  // slow, or no blending where the guides are as they are. What casts normals alone is quick enough as it is, but for
  // the split.
  kPreview,
  kFinal,  // the style as it is
};
Variant VariantOf(Quality quality, const StyleSet& styles, const LadderFrame& frame);

// The options of stylize and transfer that repeat it: "--upsample 4 --samples 4 --set transfer.method=litsphere"; empty
// for the style as it is.
std::string OptionsOf(const Variant& variant);

// Puts the variant's settings into all styles, and into those that the scene asks for later, as --set options before
// the user's would: the same bytes.
Status ApplyVariant(const Variant& variant, StyleSet& styles);

}  // namespace scumble
