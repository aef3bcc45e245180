#include "core/style/toml_values.h"

#include "core/style/toml_keys.h"

namespace scumble::internal {

// Debian's toml++ throws; nothing else here does.
Expected<toml::table> ParseToml(std::string_view text, const std::string& file) {
  SCUMBLE_RETURN_IF_ERROR(CheckTomlText(text, file));
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    return InputError(file + ":" + std::to_string(error.source().begin.line) +
                      ": not valid TOML: " + std::string(error.description()));
  }
}

std::optional<KeyValue> ValueOf(const toml::node& node) {
  if (const auto* flag = node.as_boolean()) return KeyValue(flag->get());
  if (const auto* whole = node.as_integer()) return KeyValue(whole->get());
  if (const auto* number = node.as_floating_point()) return KeyValue(number->get());
  if (const auto* text = node.as_string()) return KeyValue(text->get());
  return std::nullopt;
}

std::optional<std::vector<StyleTrack::Key>> FramesOf(const toml::array& pairs) {
  std::vector<StyleTrack::Key> keys;
  for (const auto& item : pairs) {
    const auto* pair = item.as_array();
    const auto* frame = pair && pair->size() == 2 ? pair->get(0)->as_integer() : nullptr;
    const auto value = frame ? ValueOf(*pair->get(1)) : std::nullopt;
    if (!value) return std::nullopt;
    keys.push_back({frame->get(), *value});
  }
  return keys;
}

std::string Where(const std::string& file, const toml::node& node) {
  const auto line = node.source().begin.line;
  return line > 0 ? file + ":" + std::to_string(line) : file;
}

}  // namespace scumble::internal
