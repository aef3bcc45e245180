#include "core/style/toml/toml_values.h"

#include <algorithm>

#include "core/style/toml/toml_keys.h"

namespace scumble::internal {
namespace {

// A number with a digit on either side of its point; any other text as it is.
std::string WithBothDigits(std::string_view text) {
  std::string number(text);
  const auto is_digit = [&](std::size_t at) { return at < number.size() && number[at] >= '0' && number[at] <= '9'; };
  const std::size_t point = number.find('.'), end = std::min(number.find_first_of("eE"), number.size());
  const std::size_t begin = number.find_first_not_of("+-") == 1 ? 1 : 0;
  if (point == std::string::npos || point > end || end - begin < 2) return number;
  for (std::size_t at = begin; at < end; ++at) {
    if (at != point && !is_digit(at)) return number;
  }
  if (!is_digit(point + 1)) number.insert(point + 1, 1, '0');
  if (point == begin) number.insert(point, 1, '0');
  return number;
}

}  // namespace

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

Expected<toml::table> ParseSetValue(std::string_view text) {
  return ParseToml("value = " + WithBothDigits(text), "--set");
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
