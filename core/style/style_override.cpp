#include "core/style/style_override.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "core/style/finish_keys.h"
#include "core/style/style_edit.h"
#include "core/style/toml_values.h"

namespace scumble {
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

bool TakesNames(const std::string& key) {
  return key.starts_with(kFinishKeys) && (key.ends_with(".objects") || key.ends_with(".materials"));
}

// A list of names, or names with commas between. Any other value stays as it is, and is refused where it is applied.
KeyValue NamesOf(const toml::array* list, KeyValue value) {
  if (list) {
    auto names = internal::NamesOf(*list);
    return names ? KeyValue(*std::move(names)) : value;
  }
  std::vector<std::string> names;
  const auto* text = std::get_if<std::string>(&value);
  if (!text || text->starts_with('[')) return value;
  for (std::size_t begin = 0; begin <= text->size() && !text->empty();) {
    const std::size_t end = std::min(text->find(',', begin), text->size());
    names.push_back(text->substr(begin, end - begin));
    begin = end + 1;
  }
  return names;
}

// A bare word is text.
std::variant<KeyValue, StyleOverride::Frames> ValueIn(const std::string& key, const std::string& text) {
  const auto parsed = internal::ParseToml("value = " + WithBothDigits(text), "--set");
  const toml::node* const node = parsed && parsed->size() == 1 ? parsed->get("value") : nullptr;
  const toml::array* const list = node ? node->as_array() : nullptr;
  if (list && !list->empty() && list->is_homogeneous(toml::node_type::array)) {
    return internal::FramesOf(*list).value_or(StyleOverride::Frames());
  }
  KeyValue value = (node ? internal::ValueOf(*node) : std::nullopt).value_or(KeyValue(text));
  return TakesNames(key) ? NamesOf(list, std::move(value)) : value;
}

// Whether a known key and '=' begin there.
bool HasKeyAt(const std::string& text, std::size_t begin) {
  const std::size_t equals = text.find('=', begin);
  if (equals == std::string::npos) return false;
  const std::string key = text.substr(begin, equals - begin);
  const bool is_of_list = key.starts_with("exemplar.") || IsOfFinish(key);
  return FindStyleKey(key) || (is_of_list && key.find(':') == std::string::npos);
}

// The colon between name and key; none: npos. No key holds a colon; names may, and '=' too.
std::size_t ColonOf(const std::string& text) {
  if (HasKeyAt(text, 0)) return std::string::npos;
  for (std::size_t colon = text.find(':'); colon != std::string::npos; colon = text.find(':', colon + 1)) {
    if (HasKeyAt(text, colon + 1)) return colon;
  }
  return text.substr(0, text.find('=')).rfind(':');
}

}  // namespace

Expected<StyleOverride> ParseOverride(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return UsageError("--set " + text + ": expected KEY=VALUE");
  const std::string key = text.substr(0, equals);
  return StyleOverride{"", key, ValueIn(key, text.substr(equals + 1)), text};
}

Expected<StyleOverride> ParseStyleOverride(const std::string& text) {
  const std::size_t colon = ColonOf(text);
  if (colon == 0) return UsageError("--set " + text + ": expected a style's name before the colon");
  const std::string setting = colon == std::string::npos ? text : text.substr(colon + 1);
  if (const std::size_t equals = setting.find('=');
      !IsOfFinish(setting) && (equals == std::string::npos || equals == 0))
    return UsageError("--set " + text + ": expected KEY=VALUE, as in transfer.blend_radius=0");
  SCUMBLE_ASSIGN(StyleOverride one, ParseOverride(setting));
  if (colon != std::string::npos) one.style = text.substr(0, colon);
  return one;
}

Expected<std::vector<StyleOverride>> ParseStyleOverrides(const std::vector<std::string>& texts) {
  std::vector<StyleOverride> all;
  for (const std::string& text : texts) {
    SCUMBLE_ASSIGN(StyleOverride one, ParseStyleOverride(text));
    all.push_back(std::move(one));
  }
  return all;
}

std::string BareText(const KeyValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text ? *text : ToText(value);
}

StyleOverride MakeOverride(const std::string& key, KeyValue value) {
  const std::string text = key + "=" + BareText(value);
  return {"", key, std::move(value), text};
}

StyleOverride MakeExactOverride(const std::string& key, KeyValue value) {
  const std::string text = key + "=" + TomlText(value);
  return {"", key, std::move(value), text};
}

std::string ToText(const StyleOverride& one) { return (one.style.empty() ? "" : one.style + ":") + one.text; }

bool IsOfFinish(const std::string& key) { return key.starts_with(kFinishKeys) || key.starts_with(kDialKeys); }

}  // namespace scumble
