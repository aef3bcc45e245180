// The guide layers, and the channels that stand for them in files.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scumble/layers.h"

namespace scumble {

// The meaning of an EXR file's channel.
struct ChannelMeaning {
  Layer layer;
  int component;       // 0 … ChannelCount(layer) - 1
  std::string prefix;  // the text before the known suffix: a view layer's name, or empty
};

// Matches by the longest known suffix that starts at the beginning of the name or after a dot, upper and lower case
// alike: "ViewLayer.Normal.X", "N.X" and "normal.X" are the same channel. Unknown names return nothing.
std::optional<ChannelMeaning> ParseChannelName(std::string_view name);

// The suffixes that ParseChannelName takes for a channel of a layer: our own name, then those of other programs.
std::vector<std::string> ChannelNames(Layer layer, int component);

}  // namespace scumble
