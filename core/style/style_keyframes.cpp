#include "core/style/style_keyframes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "core/style/finish/finish_mask_keys.h"
#include "core/style/finish_keys.h"

namespace scumble {
namespace {

constexpr const char* kPaperKey = "transfer.paper";

// Keys of finishing passes that may name files, which are read once.
constexpr std::string_view kFileKeys[] = {kMaskKey, "strokes", "like", "from", "ramp"};

bool MayNameFile(const std::string& finish_key) {
  const std::string last = finish_key.substr(finish_key.rfind('.') + 1);
  return std::find(std::begin(kFileKeys), std::end(kFileKeys), last) != std::end(kFileKeys);
}

// The colour at a share of the way from one to the other, straight in Oklab.
Rgb16 MixOfColors(const Rgb16& from, const Rgb16& to, double share) {
  const auto lab_of = [](const Rgb16& color) {
    return OklabFromLinear({Srgb16ToLinear(color[0]), Srgb16ToLinear(color[1]), Srgb16ToLinear(color[2])});
  };
  const glm::vec3 begin = lab_of(from), end = lab_of(to);
  const glm::vec3 linear = LinearFromOklab(begin + (end - begin) * static_cast<float>(share));
  return {Srgb16FromLinear(linear[0]), Srgb16FromLinear(linear[1]), Srgb16FromLinear(linear[2])};
}

// Makes colours of texts where the key is a colour of a finishing pass: all its values are, and nothing else is taken.
// Returns whether it is.
bool MakeColors(const Style& style, const StyleKey& key, StyleTrack& track) {
  Style scratch;
  scratch.finish = style.finish;
  if (key.name.rfind(kFinishKeys, 0) != 0 || key.set(scratch, KeyValue(std::string("none")), {})) return false;
  std::vector<StyleTrack::Key> keys = track.keys;
  for (StyleTrack::Key& one : keys) {
    const std::optional<Rgb16> color = AsColor(one.value);
    if (!color) return false;
    one.value = *color;
  }
  track.keys = std::move(keys);
  return true;
}

// Whether the key takes all values between two of the track's: whole numbers, flags and words have none.
bool TakesFractions(const Style& style, const StyleKey& key, const StyleTrack& track) {
  if (key.name.ends_with(".jitter_fps")) return false;  // each change would redraw
  Style scratch;
  scratch.finish = style.finish;
  for (const auto& [frame, value] : track.keys) {
    const auto number = AsNumber(value);
    if (!number || !key.set(scratch, KeyValue(*number), {})) return false;
  }
  return true;
}

Status Set(Style& style, const StyleKey& key, StyleTrack& track, const KeyValue& value) {
  if (auto done = key.set(style, value, track.folder); !done) {
    return Error{done.error().kind, key.name + " = " + ToText(value) + ": " + done.error().message};
  }
  track.current = value;
  return Ok();
}

}  // namespace

std::optional<StyleKey> KeyOfTrack(const Style& style, const std::string& name) {
  if (name.rfind(kFinishKeys, 0) != 0) {
    const StyleKey* const key = FindStyleKey(name);
    return key ? std::optional(*key) : std::nullopt;
  }
  const std::size_t begin = std::string_view(kFinishKeys).size(), dot = name.find('.', begin);
  const std::string pass = name.substr(begin, dot - begin), last = dot == std::string::npos ? "" : name.substr(dot + 1);
  const auto found =
      std::find_if(style.finish.begin(), style.finish.end(), [&](const FinishPass& one) { return one.name == pass; });
  const FinishKey* const of_pass = found == style.finish.end() ? nullptr : FindFinishKey(*found, last);
  if (!of_pass) return std::nullopt;
  StyleKey key;
  key.kind = of_pass->kind, key.least = of_pass->least, key.most = of_pass->most, key.choices = of_pass->choices;
  key.name = name, key.default_value = of_pass->default_value, key.help = of_pass->help;
  key.needs_preparing = false;
  key.set = [name](Style& changed, const KeyValue& value, const std::filesystem::path&) -> Status {
    SCUMBLE_RETURN_IF_ERROR(SetFinishKeys(changed.finish, name, value));
    return Ok();
  };
  return key;
}

Status CheckDial(const Style& style, const StyleOverride& set) {
  if (set.key.rfind(kDialKeys, 0) != 0) return Ok();
  for (const StyleTrack& track : style.tracks) {
    if (track.name.rfind(kFinishKeys, 0) != 0) continue;
    return UsageError("--set " + set.text + ": " + track.name + " of style " + style.name +
                      " changes over time, which a dial would undo: change its key frames");
  }
  return Ok();
}

Status AddTrack(Style& style, const StyleKey& key, StyleTrack track) {
  const bool is_of_finish = key.name.rfind(kFinishKeys, 0) == 0;
  if (key.name.rfind("transfer.", 0) != 0 && !is_of_finish) {
    return UsageError(key.name + " cannot change over time");
  }
  if (is_of_finish && MayNameFile(key.name)) {
    return UsageError(key.name +
                      " cannot change over time: it may name a file, which is read once; let the strength of two "
                      "passes change");
  }
  if (key.name.rfind(kGuideWeights, 0) == 0) {
    return UsageError(key.name +
                      " cannot change over time: the exposure of a sequence is measured once, for one set of "
                      "guides");
  }
  if (track.keys.empty()) return UsageError(key.name + " = []: expected a value, or pairs of frame and value");
  Style scratch;
  scratch.finish = style.finish;
  std::set<std::string> read;  // words may name pictures, and come back in thousands of frames
  const std::int64_t* before = nullptr;
  for (const auto& [frame, value] : track.keys) {
    if (frame < -kMaxTrackFrame || frame > kMaxTrackFrame) {
      return UsageError(key.name + ": there is no frame " + std::to_string(frame) + ": expected " +
                        std::to_string(-kMaxTrackFrame) + " to " + std::to_string(kMaxTrackFrame));
    }
    if (before && *before >= frame) {
      return UsageError(key.name + ": frame " + std::to_string(frame) + " comes after frame " +
                        std::to_string(*before) + ": name each frame once, in rising order");
    }
    before = &frame;
    if (const auto* text = std::get_if<std::string>(&value); text && !read.insert(*text).second) continue;
    if (auto done = key.set(scratch, value, track.folder); !done) {
      return Error{done.error().kind, key.name + " at frame " + std::to_string(frame) + " = " + ToText(value) + ": " +
                                          done.error().message};
    }
  }
  track.name = key.name;
  track.straight = MakeColors(style, key, track) || TakesFractions(style, key, track);
  SCUMBLE_RETURN_IF_ERROR(Set(style, key, track, ValueAt(track, 0)));
  RemoveTrack(style, key.name);
  style.tracks.push_back(std::move(track));
  return Ok();
}

void RemoveTrack(Style& style, const std::string& name) {
  std::erase_if(style.tracks, [&](const StyleTrack& track) { return track.name == name; });
}

KeyValue ValueAt(const StyleTrack& track, std::int64_t frame) {
  const auto next =
      std::partition_point(track.keys.begin(), track.keys.end(), [&](const auto& key) { return key.frame <= frame; });
  if (next == track.keys.begin()) return next->value;
  const auto& [from, value] = *std::prev(next);
  if (next == track.keys.end() || from == frame || !track.straight) return value;
  const double share = static_cast<double>(frame - from) / static_cast<double>(next->frame - from);
  if (const auto* color = std::get_if<Rgb16>(&value)) return MixOfColors(*color, std::get<Rgb16>(next->value), share);
  const double low = *AsNumber(value), high = *AsNumber(next->value);
  if (std::isinf(low) || std::isinf(high)) return value;
  // Rounding must not lead out of the range that both ends keep.
  return std::clamp(low + share * (high - low), std::min(low, high), std::max(low, high));
}

Expected<std::vector<std::string>> SetStyleFrame(Style& style, std::int64_t frame) {
  std::vector<std::string> changed;
  for (std::size_t i = 0; i < style.tracks.size(); ++i) {
    const KeyValue value = ValueAt(style.tracks[i], frame);
    if (value == style.tracks[i].current) continue;
    const std::optional<StyleKey> key = KeyOfTrack(style, style.tracks[i].name);
    if (!key) continue;  // its pass was dropped
    SCUMBLE_RETURN_IF_ERROR(Set(style, *key, style.tracks[i], value));
    changed.push_back(style.tracks[i].name);
  }
  return changed;
}

Expected<LayerSet> LayersOverTime(const Style& style) {
  // Layers depend on no picture, and this runs every frame: paper is not read again, exemplars are not copied.
  Style moving;
  moving.transfer = style.transfer, moving.finish = style.finish;
  moving.exemplars.resize(style.exemplars.size());
  std::vector<std::int64_t> frames;
  for (const StyleTrack& track : style.tracks) {
    if (track.name == kPaperKey) continue;
    moving.tracks.push_back(track);
    // Between two keyframes a key is on only if it is on at one of them.
    for (const auto& key : track.keys) frames.insert(frames.end(), {key.frame, key.frame + 1});
  }
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  LayerSet layers = RequiredLayers(style);
  for (const std::int64_t frame : frames) {
    if (auto set = SetStyleFrame(moving, frame); !set) return set.error();
    layers.Add(RequiredLayers(moving));
  }
  return layers;
}

}  // namespace scumble
