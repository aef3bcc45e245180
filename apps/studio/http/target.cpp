#include "apps/studio/http/target.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

namespace scumble {
namespace {

bool IsUtf8(const std::string& text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

// In a query "+" is a space.
std::optional<std::string> Decode(std::string_view text, bool is_query) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      unsigned char byte = 0;
      if (i + 2 >= text.size()) return std::nullopt;
      const char* const end = text.data() + i + 3;
      const auto [read, failure] = std::from_chars(text.data() + i + 1, end, byte, 16);
      if (failure != std::errc() || read != end) return std::nullopt;
      c = static_cast<char>(byte);
      i += 2;
    } else if (c == '+' && is_query) {
      c = ' ';
    }
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return std::nullopt;
    decoded += c;
  }
  if (!IsUtf8(decoded)) return std::nullopt;
  return decoded;
}

}  // namespace

Expected<RequestTarget> ParseTarget(std::string_view text) {
  const Error refused = UsageError("the address is malformed: expected a path and a query as the page sends them");
  const std::size_t question = text.find('?');
  const auto path = Decode(text.substr(0, question), false);
  if (!path || !path->starts_with('/') || path->find("..") != path->npos || path->find("//") != path->npos) {
    return refused;
  }
  RequestTarget target{*path, {}};
  std::string_view rest = question == text.npos ? std::string_view() : text.substr(question + 1);
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    const auto name = Decode(pair.substr(0, equals), true);
    const auto value = Decode(equals == pair.npos ? std::string_view() : pair.substr(equals + 1), true);
    if (!name || !value || !target.query.emplace(*name, *value).second) return refused;
  }
  return target;
}

}  // namespace scumble
