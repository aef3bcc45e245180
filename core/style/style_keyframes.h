// Keys of style.toml that change over time: threshold = [[1, 0.1], [24, 0.3]] is 0.1 up to frame 1, 0.3 from frame 24
// on, and in between on the straight line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/image/layers.h"
#include "core/image/status.h"
#include "core/image/style.h"
#include "core/style/style_keys.h"
#include "core/style/style_override.h"

namespace scumble {

// Frames are numbered from minus this to this, those of tracks as those of pictures (kMaxFrame of
// pipeline/frame_range.h).
inline constexpr std::int64_t kMaxTrackFrame = 999'999'999;

// The key that a track changes: of StyleKeys(), or "finish.NAME.KEY" of the style's finishing passes of that name. None
// where there is no such key.
std::optional<StyleKey> KeyOfTrack(const Style& style, const std::string& name);

// Ok, or a kUsage error where a dial (finish_keys.h) turns keys of the style that change over time.
Status CheckDial(const Style& style, const StyleOverride& set);

// Checks the track's keys and adds it to the style, replacing an earlier one of that name. The style gets the values of
// frame 0. Frames must rise and lie within kMaxTrackFrame, and the key must accept every value: kUsage names the one
// that fails. Keys of [transfer] and of [[finish]] only, without the weights of guides and what may name a file of a
// finishing pass.
Status AddTrack(Style& style, const StyleKey& key, StyleTrack track);

// Removes the track of that name, if there is one.
void RemoveTrack(Style& style, const std::string& name);

// The value at a frame. Keys that take fractions move on a straight line, except jitter_fps, whose every change renews
// the whole pattern; so do colours of finishing passes, in Oklab. All others, and infinities, hold their value until
// the next keyframe.
KeyValue ValueAt(const StyleTrack& track, std::int64_t frame);

// Puts the values of that frame into the style. Returns the names of the keys whose values changed. Fails where a value
// names a file that cannot be read.
Expected<std::vector<std::string>> SetStyleFrame(Style& style, std::int64_t frame);

// The layers that the style reads at one frame or another. Reads no file.
Expected<LayerSet> LayersOverTime(const Style& style);

}  // namespace scumble
