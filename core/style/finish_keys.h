// The keys of finishing effects: one table for [[finish]], for --set finish.NAME.KEY and for `scumble finish --list`.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/image/status.h"
#include "core/style/style_keys.h"

namespace scumble {

// What the keys begin with in --set.
inline constexpr const char* kFinishKeys = "finish.";

inline constexpr const char* kColorForm =
    "a colour is # and six hexadecimal digits, two each of red, green and blue: \"#f4efe6\"";
// "#f4efe6"; none for any other text.
std::optional<Rgb16> ParseColor(const std::string& text);
// "#f4efe6"; where 8 bits a channel do not hold it, four digits each.
std::string ColorText(const Rgb16& color);
// Of a colour, or of a text that is one; of others none.
std::optional<Rgb16> AsColor(const KeyValue& value);

// A key of one effect.
struct FinishKey {
  std::string name;  // "width"
  KeyKind kind = KeyKind::kNumber;
  double least = 0.0, most = 0.0;    // of numbers
  std::vector<std::string> choices;  // of kChoice
  std::string default_value;         // as TOML text
  std::string help;                  // one line: meaning, unit, range
  // Puts a value into a pass of this effect. A kUsage error gives the expected form.
  std::function<Status(FinishPass&, const KeyValue&)> set;
  std::function<KeyValue(const FinishPass&)> get;  // the value in a pass of this effect
};

struct FinishEffect {
  std::string name;  // "outline"
  std::string help;
  FinishPass::Effect defaults;
  std::vector<FinishKey> keys;
};

// All effects, in the order in which they are best applied.
std::span<const FinishEffect> FinishEffects();

// Keys that every effect has, besides the lists `objects` and `materials`.
std::span<const FinishKey> CommonFinishKeys();

// The effect of that name, or null.
const FinishEffect* FindFinishEffect(const std::string& name);
// The effect that a pass has.
const FinishEffect& EffectOf(const FinishPass& pass);

// The key of a pass, common ones included; null where there is none.
const FinishKey* FindFinishKey(const FinishPass& pass, const std::string& name);

// A pass of that effect with its defaults. A kUsage error lists the effects and names the nearest.
Expected<FinishPass> MakeFinishPass(const std::string& effect);

// Sets a key of the pass, common ones included. A kUsage error lists the keys and names the nearest.
Status SetFinishKey(FinishPass& pass, const std::string& key, const KeyValue& value);

// "finish.NAME.KEY": sets the key in every pass of that name. Returns how many there are; 0 is no error.
Expected<std::size_t> SetFinishKeys(std::span<FinishPass> passes, const std::string& key, const KeyValue& value);

// Dials: four numbers for a whole chain, 0 … 1; at 0.5 the passes are as they are.
//   lines    the width of outlines and edges and how far hatching reaches into the light: none to twice
//   detail   at 1 nothing is smoothed and no tones are in steps; towards 0 more is smoothed, in fewer steps
//   light    at 0 shade looks as light does; towards 1 it is stronger and wider, and bands are further apart
//   depth    what distance does: nothing to twice
inline constexpr const char* kDialKeys = "dial.";
inline constexpr const char* kDials[] = {"lines", "detail", "light", "depth"};

// "dial.NAME": turns a dial of the passes. kUsage where there is no such dial, or the value is not 0 … 1.
Status TurnFinishDial(std::span<FinishPass> passes, const std::string& key, const KeyValue& value);

// The effect and what is not its default, as text: equal texts, equal passes. The name is left out.
std::string FinishText(const FinishPass& pass);

}  // namespace scumble
