#include "core/style/toml/toml_keys.h"

#include <algorithm>
#include <optional>

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

}  // namespace scumble::internal
