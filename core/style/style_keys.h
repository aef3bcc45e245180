// The keys of style.toml: one table for the reader, for --set and for `scumble styles --keys`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "core/image/status.h"
#include "core/image/style.h"

namespace scumble {

// The prefix of the keys that weigh guide layers; the layer's name follows.
inline constexpr const char* kGuideWeights = "transfer.guide_weights.";

// A value as TOML has it.
using KeyValue = std::variant<bool, std::int64_t, double, std::string>;

// Of a number, whole or not; of others none.
std::optional<double> AsNumber(const KeyValue& value);

struct StyleKey {
  std::string name;           // "transfer.threshold"
  std::string default_value;  // as TOML text
  std::string help;           // one line: meaning, unit, range
  bool built_in = true;       // false: the feature does not exist yet, and only the default is accepted
  // Puts the value into the style; relative paths are under `folder`. If a value does not fit, the error is kUsage and
  // gives the expected form. If a file cannot be read, the error is kInput.
  std::function<Status(Style&, const KeyValue&, const std::filesystem::path& folder)> set;
};

// All keys but those of [[exemplar]], in the order of the documentation.
std::span<const StyleKey> StyleKeys();

// The key of that name, or null.
const StyleKey* FindStyleKey(const std::string& name);

// The value as TOML text.
std::string ToText(const KeyValue& value);

}  // namespace scumble
