#include "core/style/toml_values.h"

#include <algorithm>

namespace scumble::internal {
namespace {

// The place after the string that begins at `begin` with a quote of either kind, by TOML 1.0's rules; empty if it is
// not closed.
std::optional<std::size_t> EndOfString(std::string_view text, std::size_t begin) {
  const char quote = text[begin];
  const std::string three(3, quote);
  const bool has_escapes = quote == '"', is_long = text.substr(begin, 3) == three;
  for (std::size_t i = begin + (is_long ? 3 : 1); i < text.size(); ++i) {
    if (has_escapes && text[i] == '\\') {
      ++i;
    } else if (is_long && text.substr(i, 3) == three) {
      i += 3;
      for (int more = 0; more < 2 && i < text.size() && text[i] == quote; ++more) ++i;  // up to two belong to the text
      return i;
    } else if (!is_long && text[i] == quote) {
      return i + 1;
    } else if (!is_long && text[i] == '\n') {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace

Status CheckTomlText(std::string_view text, const std::string& file) {
  constexpr std::string_view kAround = "=[]{},\n";  // the characters around a key
  const auto at_line = [&](std::size_t i) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(i), '\n');
    return file + ":" + std::to_string(line) + ": ";
  };
  std::size_t parts = 1;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '"' || text[i] == '\'') {
      const std::optional<std::size_t> end = EndOfString(text, i);
      if (!end) return InputError(at_line(i) + "not valid TOML: the string that begins here is not closed");
      i = *end;
      continue;
    }
    if (text[i] == '#') {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    if (kAround.find(text[i]) != std::string_view::npos) parts = 1;
    if (text[i] == '.' && ++parts > kMostKeyParts) {
      return InputError(at_line(i) + "a key of more than " + std::to_string(kMostKeyParts) +
                        " parts; a style's have up to four, as transfer.guide_weights.lpe.LDE");
    }
    ++i;
  }
  return Ok();
}

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

std::optional<std::vector<std::string>> NamesOf(const toml::node& node) {
  if (const auto* one = node.as_string()) return std::vector{one->get()};
  const auto* list = node.as_array();
  if (!list) return std::nullopt;
  std::vector<std::string> names;
  for (const auto& item : *list) {
    const auto* name = item.as_string();
    if (!name) return std::nullopt;
    names.push_back(name->get());
  }
  return names;
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
