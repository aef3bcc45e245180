// What `scumble styles tune` does: looks for keys of a style by which its paint looks more like the exemplar's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "scumble/picture.h"

namespace scumble {

struct TuneRequest {
  StyleRequest style;               // keys that its `sets` give stay as they are
  std::vector<std::string> scenes;  // files; at least one
  Size size{640, 360};              // of the pictures
  std::uint64_t seed = 0;
};

struct TunedStyle {
  std::vector<StyleOverride> settings;  // empty: the style as it is
  double texture = 1.0;                 // guided texture distance, of the style's own: geometric mean over the scenes
  double time = 1.0;                    // of the transfer and its finishing effects, likewise
  std::vector<Picture> pictures;        // by scene, as stylize paints them
};

struct TuneReport {
  std::string style;                // its name
  std::vector<std::string> scenes;  // their names
  int tried = 0;                    // settings that were painted
  double chance = 0.0;              // what `texture` differs by with other random seeds
  TunedStyle own;
  std::vector<TunedStyle> proposals;  // nearest first, at most kMostProposals
};
inline constexpr std::size_t kMostProposals = 5;

// Tries values of threshold and hybrid together, then those of variety, of blend_radius, and of each of the four once
// more, each time going on from the best. Keys that change over time stay, and so do scale and levels: strokes of
// another size are another paint. A proposal is nearer to the exemplar than the style by more than chance, and differs
// from each better one by more than that, or in two keys at least. Textures are those of bare paint, without paper,
// without the scene's base colours and without finishing effects; times and pictures are those with them. The
// proposals and their textures depend on no clock and no threads; their times do. Errors: kUsage where there is
// nothing to tune, as for a Lit Sphere; kInput where a scene shows too little to be measured; those of opening styles
// and scenes.
Expected<TuneReport> TuneStyle(const TuneRequest& request, const RunContext& context);

}  // namespace scumble
