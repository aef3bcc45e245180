#include "core/style/finish_chain.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "core/image/check.h"
#include "core/style/finish_keys.h"
#include "core/style/style_keyframes.h"

namespace scumble {
namespace {

// The key's name within its pass.
std::string LastOf(const std::string& key) { return key.substr(key.rfind('.') + 1); }

bool IsOfPass(const std::string& key, const FinishPass& pass) {
  const std::string begin = kFinishKeys + pass.name + ".";
  return key.rfind(begin, 0) == 0 && key.find('.', begin.size()) == std::string::npos;
}

Status SetAt(const StyleTrack& keys, std::int64_t frame, FinishPass& pass) {
  const KeyValue value = ValueAt(keys, frame);
  auto done = SetFinishKey(pass, LastOf(keys.name), value);
  if (done) return Ok();
  return Error{done.error().kind, keys.name + " = " + ToText(value) + ": " + done.error().message};
}

Error AtSet(const StyleOverride& set, const Error& error) {
  return Error{error.kind, "--set " + set.text + ": " + error.message};
}

// The key frames of an override; none where it is a value.
Expected<std::optional<StyleTrack>> FramesIn(const StyleOverride& set) {
  const auto* frames = std::get_if<StyleOverride::Frames>(&set.value);
  if (!frames) return std::optional<StyleTrack>();
  if (frames->empty()) return AtSet(set, UsageError("expected frames with their values, as [[1, 0.1], [24, 0.3]]"));
  StyleTrack track;
  track.name = set.key, track.keys = *frames;
  return std::optional(std::move(track));
}

// What the user sets himself is refused where it has no effect.
void NoteGiven(const std::string& key, std::span<FinishPass> passes) {
  for (FinishPass& pass : passes) {
    auto* const outline = std::get_if<OutlinePass>(&pass.effect);
    if (outline && IsOfPass(key, pass) && LastOf(key) == "thin") outline->thin_is_given = true;
  }
}

// Sets a value in passes.
Expected<std::size_t> SetInPasses(std::span<FinishPass> passes, const StyleOverride& set) {
  const KeyValue& value = std::get<KeyValue>(set.value);
  if (set.key.rfind(kDialKeys, 0) == 0) {
    const Status turned = TurnFinishDial(passes, set.key, value);
    return turned ? Expected<std::size_t>(passes.size()) : AtSet(set, turned.error());
  }
  Expected<std::size_t> count = SetFinishKeys(passes, set.key, value);
  return count ? count : AtSet(set, UsageError(count.error().message));
}

}  // namespace

Status AddFinishTrack(FinishChain& chain, std::size_t pass, StyleTrack track) {
  Style one;
  one.finish = {chain.passes[pass]};
  const std::optional<StyleKey> key = KeyOfTrack(one, track.name);
  if (!key) {
    const std::string last = LastOf(track.name);
    if (last == "objects" || last == "materials") return UsageError(track.name + " cannot change over time");
    SCUMBLE_RETURN_IF_ERROR(SetFinishKey(one.finish[0], last, track.keys.front().value));  // says which there are
  }
  SCUMBLE_RETURN_IF_ERROR(AddTrack(one, *key, std::move(track)));
  chain.passes[pass] = std::move(one.finish[0]);
  std::erase_if(chain.tracks, [&](const auto& old) { return old.pass == pass && old.keys.name == key->name; });
  chain.tracks.push_back({pass, std::move(one.tracks[0])});
  return Ok();
}

void Append(FinishChain more, FinishChain& chain) {
  for (FinishChain::Track& track : more.tracks) {
    track.pass += chain.passes.size();
    chain.tracks.push_back(std::move(track));
  }
  chain.passes.insert(chain.passes.end(), std::make_move_iterator(more.passes.begin()),
                      std::make_move_iterator(more.passes.end()));
}

Status SetFinishFrame(FinishChain& chain, std::int64_t frame) {
  for (FinishChain::Track& track : chain.tracks) {
    const KeyValue value = ValueAt(track.keys, frame);
    if (value == track.keys.current) continue;
    SCUMBLE_RETURN_IF_ERROR(SetAt(track.keys, frame, chain.passes[track.pass]));
    track.keys.current = value;
  }
  return Ok();
}

FinishChain FinishOf(const Style& style) {
  FinishChain chain{style.finish, {}};
  for (const StyleTrack& track : style.tracks) {
    for (std::size_t i = 0; i < chain.passes.size(); ++i) {
      if (IsOfPass(track.name, chain.passes[i])) chain.tracks.push_back({i, track});
    }
  }
  return chain;
}

std::vector<FinishPass> MomentsOf(const FinishChain& chain, std::size_t pass) {
  std::vector<FinishPass> moments{chain.passes[pass]};
  std::set<std::int64_t> frames;
  for (const FinishChain::Track& track : chain.tracks) {
    if (track.pass != pass) continue;
    for (const StyleTrack::Key& key : track.keys.keys) frames.insert({key.frame, key.frame + 1});
  }
  for (const std::int64_t frame : frames) {
    FinishPass moment = chain.passes[pass];
    for (const FinishChain::Track& track : chain.tracks) {
      if (track.pass != pass) continue;
      SCUMBLE_CHECK(SetAt(track.keys, frame, moment).ok());  // AddTrack has tried the values
    }
    moments.push_back(std::move(moment));
  }
  return moments;
}

LayerSet LayersOverTime(const FinishChain& chain) {
  LayerSet layers;
  for (std::size_t i = 0; i < chain.passes.size(); ++i) {
    for (const FinishPass& moment : MomentsOf(chain, i)) layers.Add(RequiredLayers(moment));
  }
  return layers;
}

Expected<std::size_t> OverrideFinish(FinishChain& chain, const StyleOverride& set) {
  NoteGiven(set.key, chain.passes);
  SCUMBLE_ASSIGN(const std::optional<StyleTrack> frames, FramesIn(set));
  const bool is_dial = set.key.rfind(kDialKeys, 0) == 0;
  if (!frames) {
    if (is_dial && !chain.tracks.empty()) {
      return AtSet(set, UsageError(chain.tracks.front().keys.name +
                                   " changes over time, which a dial would undo: change its key frames"));
    }
    std::erase_if(chain.tracks, [&](const FinishChain::Track& track) { return track.keys.name == set.key; });
    return SetInPasses(chain.passes, set);
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < chain.passes.size(); ++i) {
    if (!IsOfPass(frames->name, chain.passes[i])) continue;
    if (const Status added = AddFinishTrack(chain, i, *frames); !added) return AtSet(set, added.error());
    ++count;
  }
  if (count == 0 && is_dial) return AtSet(set, UsageError("expected a number, 0 to 1"));
  return count;
}

Expected<std::size_t> OverrideFinish(Style& style, const StyleOverride& set) {
  NoteGiven(set.key, style.finish);
  SCUMBLE_ASSIGN(const std::optional<StyleTrack> frames, FramesIn(set));
  if (!frames) {
    SCUMBLE_RETURN_IF_ERROR(CheckDial(style, set));
    SCUMBLE_ASSIGN(const std::size_t count, SetInPasses(style.finish, set));
    RemoveTrack(style, set.key);
    return count;
  }
  // All passes of one name share a style's track.
  FinishChain trial{style.finish, {}};
  SCUMBLE_ASSIGN(const std::size_t count, OverrideFinish(trial, set));
  if (count == 0) return count;
  const auto added = AddTrack(style, *KeyOfTrack(style, frames->name), *frames);
  return added ? Expected<std::size_t>(count) : AtSet(set, added.error());
}

Error NoSuchFinish(const StyleOverride& set, std::span<const FinishPass> passes, const std::string& style) {
  std::string names;
  for (const FinishPass& pass : passes) names += (names.empty() ? "" : ", ") + pass.name;
  return UsageError("--set " + (style.empty() ? "" : style + ":") + set.text + ": no finish " +
                    (style.empty() ? "" : "of that style ") + "has that name; " +
                    (!names.empty()  ? "there are " + names
                     : style.empty() ? "there is none, give --finish or [[finish]] of style.toml"
                                     : "there is none in its style.toml; those of --finish go without a style's name"));
}

std::string ToText(const StyleTrack& track) {
  std::string text;
  for (const StyleTrack::Key& key : track.keys) {
    text += (text.empty() ? "[[" : ", [") + std::to_string(key.frame) + ", " + ToText(key.value) + "]";
  }
  return text + "]";
}

}  // namespace scumble
