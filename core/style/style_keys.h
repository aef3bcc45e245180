// The keys of style.toml: one table for the reader, for --set and for `scumble styles --keys`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/image/status.h"
#include "core/image/style.h"

namespace scumble {

// The prefix of the keys that weigh guide layers; the layer's name follows.
inline constexpr const char* kGuideWeights = "transfer.guide_weights.";

using KeyValue = StyleTrack::Value;

// Of a number, whole or not; of others none.
std::optional<double> AsNumber(const KeyValue& value);

enum class KeyKind { kNumber, kWhole, kFlag, kChoice, kText, kFile };

// "number", "whole", "flag", "choice", "text", "file".
std::string KindName(KeyKind kind);

// What a key's values are, for controls. `set` checks by the same numbers and choices.
struct KeyForm {
  KeyKind kind = KeyKind::kText;
  double least = 0.0, most = 0.0;    // of numbers; where they are unlimited, `most` is what a slider ends at
  bool unlimited = false;            // there is no upper limit
  double step = 0.0;                 // of numbers: a sensible one for a control
  std::vector<std::string> choices;  // of kChoice
  // Puts the value into the style; relative paths are under `folder`. If a value does not fit, the error is kUsage and
  // gives the expected form. If a file cannot be read, the error is kInput.
  std::function<Status(Style&, const KeyValue&, const std::filesystem::path& folder)> set;
};

struct StyleKey : KeyForm {
  std::string name;             // "transfer.threshold"
  std::string default_value;    // as TOML text
  std::string help;             // one line: meaning, unit, range
  std::string group;            // of keys that belong together: "Matching"
  bool needs_preparing = true;  // false: a change prepares no exemplar again

  KeyValue Default() const;  // default_value by its kind
};

// Whether a method makes pictures without an exemplar: "toon", "render". See Style::unpainted.
bool IsUnpainted(const std::string& method);

// All keys but those of [[exemplar]], in the order of the documentation.
std::span<const StyleKey> StyleKeys();

// The key of that name, or null.
const StyleKey* FindStyleKey(const std::string& name);

// The value as TOML text.
std::string ToText(const KeyValue& value);

}  // namespace scumble
