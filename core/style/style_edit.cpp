#include "core/style/style_edit.h"

#include <toml++/toml.h>

#include <optional>
#include <utility>

#include "core/image/check.h"

namespace scumble {
namespace {

constexpr const char* kTable = "transfer";

std::optional<toml::table> Parse(const std::string& text) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error&) {
    return std::nullopt;
  }
}

std::size_t PlaceOf(const std::string& text, const toml::source_position& at) {
  std::size_t begin = 0;
  for (toml::source_index line = 1; line < at.line; ++line) begin = text.find('\n', begin) + 1;
  return begin + at.column - 1;
}

// Puts `key = value` below the line of the table, or in a new table at the end.
void Add(const toml::table& all, const std::string& line, std::string& text) {
  const toml::table* const table = all[kTable].as_table();
  if (!table) {
    if (!text.empty() && text.back() != '\n') text += '\n';
    text += "\n[" + std::string(kTable) + "]\n" + line;
    return;
  }
  std::size_t end = text.find('\n', PlaceOf(text, table->source().begin));
  if (end == std::string::npos) text += '\n', end = text.size() - 1;
  text.insert(end + 1, line);
}

}  // namespace

Expected<std::string> WithSettings(std::string text, const std::vector<std::string>& settings,
                                   const std::string& file) {
  for (const std::string& setting : settings) {
    const std::size_t dot = setting.find('.'), equals = setting.find('=');
    SCUMBLE_CHECK(dot != std::string::npos && equals != std::string::npos && dot < equals);
    const std::string key = setting.substr(dot + 1, equals - dot - 1), value = setting.substr(equals + 1);
    const auto all = Parse(text);
    if (!all) return InputError(file + " is no TOML: mend it first, `scumble styles check` says where");
    if (const toml::node* const there = (*all)[kTable][key].node()) {
      const std::size_t begin = PlaceOf(text, there->source().begin), end = PlaceOf(text, there->source().end);
      text.replace(begin, end - begin, value);
    } else {
      Add(*all, key + " = " + value + "\n", text);
    }
    const auto made = Parse(text), wanted = Parse("value = " + value);
    SCUMBLE_CHECK(wanted.has_value());
    if (!made || (*made)[kTable][key].value<double>() != (*wanted)["value"].value<double>()) {
      return InputError(file + ": [transfer] is written in a form that cannot be changed here; set " + setting +
                        " by hand");
    }
  }
  return text;
}

}  // namespace scumble
