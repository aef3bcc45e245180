#include "core/style/finish_chain.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "core/image/check.h"
#include "core/style/finish_keys.h"
#include "core/style/style_keyframes.h"
#include "core/style/toml/toml_values.h"

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

// The key frames of a text KEY=[[FRAME, VALUE], …]; none of any other text.
Expected<std::optional<StyleTrack>> FramesIn(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return std::optional<StyleTrack>();
  const auto parsed = internal::ParseSetValue(text.substr(equals + 1));
  const auto* pairs = parsed && parsed->size() == 1 ? parsed->get("value")->as_array() : nullptr;
  if (!pairs || pairs->empty() || !pairs->is_homogeneous(toml::node_type::array)) return std::optional<StyleTrack>();
  StyleTrack track;
  track.name = text.substr(0, equals);
  std::optional<std::vector<StyleTrack::Key>> keys = internal::FramesOf(*pairs);
  if (!keys) return UsageError("--set " + text + ": expected frames with their values, as [[1, 0.1], [24, 0.3]]");
  track.keys = *std::move(keys);
  return std::optional(std::move(track));
}

// What the user sets himself is refused where it has no effect.
void NoteGiven(const std::string& text, std::span<FinishPass> passes) {
  const std::string key = text.substr(0, text.find('='));
  for (FinishPass& pass : passes) {
    auto* const outline = std::get_if<OutlinePass>(&pass.effect);
    if (outline && IsOfPass(key, pass) && LastOf(key) == "thin") outline->thin_is_given = true;
  }
}

Error AtSet(const std::string& text, const Error& error) {
  return Error{error.kind, "--set " + text + ": " + error.message};
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

bool IsOfFinish(const std::string& set) { return set.rfind(kFinishKeys, 0) == 0 || set.rfind(kDialKeys, 0) == 0; }

Expected<std::size_t> OverrideFinish(std::span<FinishPass> passes, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return UsageError("--set " + text + ": expected KEY=VALUE");
  const std::string value_text = text.substr(equals + 1);
  const auto parsed = internal::ParseSetValue(value_text);
  const auto value = parsed && parsed->size() == 1 ? internal::ValueOf(*parsed->get("value")) : std::nullopt;
  const std::string key = text.substr(0, equals);
  if (key.rfind(kDialKeys, 0) == 0) {
    const Status turned = TurnFinishDial(passes, key, value ? *value : KeyValue(value_text));
    return turned ? Expected<std::size_t>(passes.size()) : UsageError("--set " + text + ": " + turned.error().message);
  }
  Expected<std::size_t> count = SetFinishKeys(passes, key, value ? *value : KeyValue(value_text));
  if (!count) return UsageError("--set " + text + ": " + count.error().message);
  return count;
}

Expected<std::size_t> OverrideFinish(FinishChain& chain, const std::string& text) {
  NoteGiven(text, chain.passes);
  SCUMBLE_ASSIGN(const std::optional<StyleTrack> frames, FramesIn(text));
  if (!frames) {
    if (text.rfind(kDialKeys, 0) == 0 && !chain.tracks.empty()) {
      return UsageError("--set " + text + ": " + chain.tracks.front().keys.name +
                        " changes over time, which a dial would undo: change its key frames");
    }
    const std::string key = text.substr(0, text.find('='));
    std::erase_if(chain.tracks, [&](const FinishChain::Track& track) { return track.keys.name == key; });
    return OverrideFinish(std::span<FinishPass>(chain.passes), text);
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < chain.passes.size(); ++i) {
    if (!IsOfPass(frames->name, chain.passes[i])) continue;
    if (const Status added = AddFinishTrack(chain, i, *frames); !added) return AtSet(text, added.error());
    ++count;
  }
  if (count == 0 && text.rfind(kDialKeys, 0) == 0) return UsageError("--set " + text + ": expected a number, 0 to 1");
  return count;
}

Expected<std::size_t> OverrideFinish(Style& style, const std::string& text) {
  NoteGiven(text, style.finish);
  SCUMBLE_ASSIGN(const std::optional<StyleTrack> frames, FramesIn(text));
  if (!frames) {
    SCUMBLE_RETURN_IF_ERROR(CheckDial(style, text));
    SCUMBLE_ASSIGN(const std::size_t count, OverrideFinish(std::span<FinishPass>(style.finish), text));
    RemoveTrack(style, text.substr(0, text.find('=')));
    return count;
  }
  // All passes of one name share a style's track.
  FinishChain trial{style.finish, {}};
  SCUMBLE_ASSIGN(const std::size_t count, OverrideFinish(trial, text));
  if (count == 0) return count;
  const auto added = AddTrack(style, *KeyOfTrack(style, frames->name), *frames);
  return added ? Expected<std::size_t>(count) : AtSet(text, added.error());
}

Error NoSuchFinish(const std::string& text, std::span<const FinishPass> passes, const std::string& style) {
  std::string names;
  for (const FinishPass& pass : passes) names += (names.empty() ? "" : ", ") + pass.name;
  return UsageError("--set " + (style.empty() ? "" : style + ":") + text + ": no finish " +
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
