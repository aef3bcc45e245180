// What --set says: one key of a style, and the value or the key frames that it gets. Its text is parsed once, here,
// where it comes in; what applies overrides reads no text again.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "core/image/status.h"
#include "core/style/style_keys.h"

namespace scumble {

struct StyleOverride {
  using Frames = std::vector<StyleTrack::Key>;
  std::string style;                     // that it is for, as --style or --assign names it; empty: all
  std::string key;                       // "transfer.scale", "exemplar.1.luminance", "finish.ink.width", "dial.lines"
  std::variant<KeyValue, Frames> value;  // frames are empty where a list of lists was given that is none
  std::string text;                      // "KEY=VALUE" as it was written, for messages and commands

  bool operator==(const StyleOverride&) const = default;
};

// Parses "KEY=VALUE". Values are TOML's; quotes may be left off, and the zero of .5 or 5. too. Of the objects and
// materials of a finish they are lists, which may be names with commas between. kUsage where there is no '='.
Expected<StyleOverride> ParseOverride(const std::string& text);

// Parses "[NAME:]KEY=VALUE". A name may hold colons and '='. kUsage where name, key or value is missing.
Expected<StyleOverride> ParseStyleOverride(const std::string& text);
Expected<std::vector<StyleOverride>> ParseStyleOverrides(const std::vector<std::string>& texts);

// Those of a program's own. Their texts are such as ParseOverride takes: with words as they are and numbers of six
// digits; or exact, with words in quotes.
StyleOverride MakeOverride(const std::string& key, KeyValue value);
StyleOverride MakeExactOverride(const std::string& key, KeyValue value);
// The value as MakeOverride writes it.
std::string BareText(const KeyValue& value);

// "[NAME:]KEY=VALUE"
std::string ToText(const StyleOverride& one);

// Whether the key is that of a finishing effect or a dial.
bool IsOfFinish(const std::string& key);

}  // namespace scumble
