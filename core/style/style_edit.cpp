#include "core/style/style_edit.h"

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "core/image/check.h"
#include "core/style/toml_values.h"

namespace scumble {
namespace {

std::optional<toml::table> Parse(const std::string& text) {
  if (!internal::CheckTomlText(text, "")) return std::nullopt;
  try {
    return toml::parse(text);
  } catch (const toml::parse_error&) {
    return std::nullopt;
  }
}

std::size_t PlaceOf(const std::string& text, const toml::source_position& at) {
  std::size_t begin = 0;
  for (toml::source_index line = 1; line < at.line; ++line) begin = text.find('\n', begin) + 1;
  // Columns count characters, of which some have several bytes.
  for (toml::source_index column = 1; column < at.column && begin < text.size(); ++column) {
    ++begin;
    while (begin < text.size() && (static_cast<unsigned char>(text[begin]) & 0xc0u) == 0x80u) ++begin;
  }
  return begin;
}

// The place after the line on which something stands. The text gets its last line's end, if that lacks one.
std::size_t AfterLine(std::string& text, std::size_t place) {
  const std::size_t end = text.find('\n', place);
  if (end != std::string::npos) return end + 1;
  text += '\n';
  return text.size();
}

// The value of "transfer.guide_weights.lpe.LDE", however the file divides the name into tables and keys; null: none.
const toml::node* Find(const toml::table& table, const std::string& name) {
  for (const auto& [key, node] : table) {
    const std::string begin(key.str());
    if (name == begin) return &node;
    if (const auto* inner = node.as_table(); inner && name.starts_with(begin + ".")) {
      if (const toml::node* found = Find(*inner, name.substr(begin.size() + 1))) return found;
    }
  }
  return nullptr;
}

// Whole numbers as any others: a file may write either.
KeyValue WithoutKind(const KeyValue& value) {
  const auto number = AsNumber(value);
  return number ? KeyValue(*number) : value;
}

bool Holds(const toml::table& table, const std::string& name, const KeyValue& value) {
  const toml::node* const node = Find(table, name);
  const auto held = node ? internal::ValueOf(*node) : std::nullopt;
  return held && WithoutKind(*held) == WithoutKind(value);
}

// Below the last of the keys that stand before all tables, or at the beginning.
std::string AddToRoot(const toml::table& all, const std::string& line, std::string text) {
  std::size_t place = 0;
  for (const auto& [key, node] : all) {
    if (node.is_table() || node.is_array_of_tables()) continue;
    const std::size_t end = PlaceOf(text, node.source().end);
    place = std::max(place, AfterLine(text, end > 0 ? end - 1 : 0));
  }
  return text.insert(place, line);
}

// Below the line of the table.
std::string AddToTable(const toml::table& table, const std::string& line, std::string text) {
  const std::size_t place = AfterLine(text, PlaceOf(text, table.source().begin));
  return text.insert(place, line);
}

std::string AddTable(const std::string& name, const std::string& line, std::string text) {
  if (!text.empty() && text.back() != '\n') text += '\n';
  return text + "\n[" + name + "]\n" + line;
}

// The texts that may have the new key in its place, the best first.
std::vector<std::string> WaysToAdd(const toml::table& all, const std::string& name, const std::string& value,
                                   const std::string& text) {
  const std::string weights = kGuideWeights;
  const std::size_t begin = name.starts_with(weights) ? weights.size() : name.find('.') + 1;
  const std::string line = name.substr(begin) + " = " + value + "\n";
  if (begin == 0) return {AddToRoot(all, line, text)};
  const std::string section = name.substr(0, begin - 1);
  std::vector<std::string> ways;
  if (const toml::node* table = Find(all, section); table && table->is_table()) {
    ways.push_back(AddToTable(*table->as_table(), line, text));
  }
  ways.push_back(AddTable(section, line, text));
  return ways;
}

}  // namespace

std::string TomlText(const KeyValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    std::string quoted = "\"";
    for (const char c : *text) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(static_cast<unsigned char>(c)));
      if (c == '"' || c == '\\') quoted += '\\';
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
        quoted += code;
      } else {
        quoted += c;
      }
    }
    return quoted + '"';
  }
  const auto* number = std::get_if<double>(&value);
  if (!number || !std::isfinite(*number)) return ToText(value);
  char text[40];
  return std::string(text, std::to_chars(text, text + sizeof text, *number).ptr);
}

Expected<std::string> WithSettings(std::string text, const std::vector<StyleOverride>& settings,
                                   const std::string& file) {
  for (const StyleOverride& setting : settings) {
    const std::string& name = setting.key;
    if (!FindStyleKey(name)) return UsageError(name + " is no key of a style");
    const auto* const wanted = std::get_if<KeyValue>(&setting.value);
    if (!wanted) return UsageError(setting.text + ": expected a number, true, false or a text in quotes");
    const std::string value = TomlText(*wanted);
    const auto all = Parse(text);
    if (!all) return InputError(file + " is no TOML: fix it first, `scumble styles check` says where");
    std::vector<std::string> ways;
    if (const toml::node* const there = Find(*all, name)) {
      const std::size_t begin = PlaceOf(text, there->source().begin), end = PlaceOf(text, there->source().end);
      ways.push_back(text.substr(0, begin) + value + text.substr(end));
    } else {
      ways = WaysToAdd(*all, name, value, text);
    }
    const auto fits = std::find_if(ways.begin(), ways.end(), [&](const std::string& way) {
      const auto made = Parse(way);
      return made && Holds(*made, name, *wanted);
    });
    if (fits == ways.end()) {
      return InputError(file + " is written in a form that cannot be changed here; set " + setting.text + " by hand");
    }
    text = *fits;
  }
  return text;
}

}  // namespace scumble
