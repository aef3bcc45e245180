// A chain of finishing passes with the keys of them that change over time: what a run adds to its styles' own passes,
// by presets and --set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/image/layers.h"
#include "core/image/status.h"
#include "core/image/style.h"
#include "core/style/style_override.h"

namespace scumble {

struct FinishChain {
  // A key of one pass. Presets may use one name twice, so a pass is known by its place.
  struct Track {
    std::size_t pass = 0;
    StyleTrack keys;  // its name is "finish.NAME.KEY"
  };
  std::vector<FinishPass> passes;  // in order, with the values of the frame that was set last; at first of frame 0
  std::vector<Track> tracks;
};

// As AddTrack of style_keyframes.h, for one pass of a chain.
Status AddFinishTrack(FinishChain& chain, std::size_t pass, StyleTrack track);

// The chain with another one after it.
void Append(FinishChain more, FinishChain& chain);

// Puts the values of that frame into the passes.
Status SetFinishFrame(FinishChain& chain, std::int64_t frame);

// A style's passes with their keys.
FinishChain FinishOf(const Style& style);

// The pass as it is now and at each of its key frames. They tell what it reads and takes at any frame: a key that moves
// between two values is on only if one of them is.
std::vector<FinishPass> MomentsOf(const FinishChain& chain, std::size_t pass);

// The layers that the passes read at one frame or another.
LayerSet LayersOverTime(const FinishChain& chain);

// Of a key IsOfFinish: sets a "finish.NAME.KEY" in every pass of that name, or its key frames; returns how many there
// are. A "dial.NAME" turns a dial of all passes, and returns how many they are; it is refused where a key changes over
// time. Mistakes are kUsage.
Expected<std::size_t> OverrideFinish(FinishChain& chain, const StyleOverride& set);
Expected<std::size_t> OverrideFinish(Style& style, const StyleOverride& set);

// The error where OverrideFinish sets nothing: which names there are. `style`: that it is named by before the key.
Error NoSuchFinish(const StyleOverride& set, std::span<const FinishPass> passes, const std::string& style = {});

// "[[1, 0], [12, 4]]"
std::string ToText(const StyleTrack& track);

}  // namespace scumble
